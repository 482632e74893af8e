//! Scenes as they run: whole, as `sutura run --headless` does it, or tick by tick in this process.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use sutura::run::embedded::NODES_MAX;
use sutura::run::report::Report;
use sutura::run::{self, Error, Request};
use sutura::scene;
use sutura::scene::build::{self, Built};
use sutura_controller::lanes::Level;
use sutura_controller::lattice::PC_NODES;
use sutura_controller::tick::{Controller, Memory};

/// Memory for one rig, on the heap.
#[must_use]
pub fn memory() -> Box<Memory<PC_NODES>> {
    bytemuck::zeroed_box()
}

/// One of the scenes that stand in the repository, `touch` for `host/scenes/touch.toml`.
#[must_use]
pub fn scene_file(name: &str) -> PathBuf {
    crate::root().join("host/scenes").join(name).with_extension("toml")
}

/// A scene as it goes to the controller; none is the built-in one.
///
/// # Errors
/// What is wrong with the scene or its meshes.
pub fn built(scene: Option<&Path>) -> Result<Built, Error> {
    Ok(build::build(&scene::load(scene)?, NODES_MAX)?)
}

/// Runs a scene to its end, through the frames and with files, as `sutura run --headless --json` does; none is the built-in one.
///
/// # Errors
/// As of [`run::run`].
pub fn run(scene: Option<PathBuf>) -> Result<Report, Error> {
    let out = tempfile::tempdir().map_err(build::Error::Folder)?;
    let request = Request {
        scene,
        meshes: Vec::new(),
        seconds: None,
        realtime: false,
        level: Level::best(),
        out: out.path().to_owned(),
    };
    run::run(&request, &AtomicBool::new(false), |_| {})
}

/// Voxels with a corner at which the three edges span no positive volume.
#[must_use]
pub fn inverted<const N: usize>(controller: &Controller<'_, N>, cells: &[u8]) -> usize {
    let (lattice, tissue) = (controller.lattice(), controller.tissue());
    let [cx, cy, _] = lattice.nodes.map(|nodes| nodes - 1);
    let turned = |cell: u32| {
        let low = [cell % cx, cell / cx % cy, cell / (cx * cy)];
        let place = |bits: [u32; 3]| {
            let [i, j, k] = [0, 1, 2].map(|axis| low[axis] + bits[axis]);
            lattice.place(tissue, lattice.index([i, j, k]))
        };
        (0..8_u32).any(|corner| {
            let bits = [corner & 1, corner >> 1 & 1, corner >> 2];
            let here = place(bits);
            let [x, y, z] = [0, 1, 2].map(|axis| {
                let mut other = bits;
                other[axis] = 1 - other[axis];
                place(other) - here
            });
            // At a corner with an odd number of upper sides the three edges are left-handed.
            let handed = if bits.iter().sum::<u32>() % 2 == 0 { 1.0 } else { -1.0 };
            x.cross(&y).dot(&z) * handed <= 0.0
        })
    };
    let voxels = (0..).zip(cells).filter(|(_, tissue)| **tissue != 0);
    voxels.filter(|(cell, _)| turned(*cell)).count()
}
