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
use sutura_controller::tick::Memory;

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
        frames: None,
    };
    run::run(&request, &AtomicBool::new(false), |_| {})
}
