//! The embedded controller: physics and a simulated device behind frames, in a thread of this process.

use std::thread::JoinHandle;

use sutura_controller::device::{Device, sim::Simulated};
use sutura_controller::hash::Hasher;
use sutura_controller::link::{LoadError, Loaded, Plant};
use sutura_controller::record::Output;
use sutura_controller::tick::{ConfigError, Controller, Memory};
use sutura_controller::tissue;
use sutura_shared::scene::Scene;

use crate::geometry::lattice;
use crate::link::{ChannelTransport, Pace, Ran, channel, run_controller};

/// Most nodes of the embedded controller's patch.
pub const NODES_MAX: usize = 24 * 24 * 12;
/// Ticks between two hashes of the whole state.
const WHOLE: u32 = 1000;
/// Pieces on their way between the threads.
const PIECES: usize = 64;

/// Starts a controller and gives the host's end of the line to it. The thread ends when that end is dropped.
///
/// # Errors
/// The system gives no thread.
pub fn start(pace: Pace) -> std::io::Result<(ChannelTransport, JoinHandle<Ran>)> {
    let (ours, theirs) = channel(PIECES);
    let body = move || {
        let mut memory: Box<Memory<NODES_MAX>> = bytemuck::zeroed_box();
        run_controller(theirs, Rig::new(&mut memory), pace)
    };
    let thread = std::thread::Builder::new().name("controller".to_owned()).spawn(body)?;
    Ok((ours, thread))
}

/// The controller, the device it moves, and the hash of what happened.
#[derive(Debug)]
pub struct Rig<'m, const N: usize> {
    controller: Controller<'m, N>,
    device: Option<Simulated>,
    hasher: Hasher,
}

impl<'m, const N: usize> Rig<'m, N> {
    /// A rig without a scene.
    pub fn new(memory: &'m mut Memory<N>) -> Self {
        Self {
            controller: Controller::new(memory),
            device: None,
            hasher: Hasher::default(),
        }
    }

    /// Adds everything that lives now.
    fn hash_whole(&self, hasher: &mut Hasher) {
        self.controller.hash(hasher);
        self.device
            .iter()
            .flat_map(|device| device.state().words())
            .for_each(|word| hasher.word(word));
    }
}

impl<const N: usize> Plant for Rig<'_, N> {
    fn load(&mut self, scene: &Scene, cells: &[u8]) -> Result<Loaded, LoadError> {
        let hand = scene
            .hand
            .as_ref()
            .ok_or(LoadError("hand: a simulated device needs one"))?;
        let device =
            Simulated::new(&scene.device, hand).map_err(|_| LoadError("hand.start: a place within the arm's reach"))?;
        self.controller.load(scene, cells).map_err(refusal)?;
        self.device = Some(device);
        self.hasher = Hasher::default();
        let counts = lattice::count(cells, scene.lattice.cells.map(usize::from));
        Ok(Loaded {
            voxels: counts.voxels as u32,
            nodes: counts.nodes as u32,
        })
    }

    fn tick(&mut self) -> Output {
        let Some(device) = &mut self.device else {
            return Output::idle();
        };
        let output = self.controller.tick(&device.sense());
        device.actuate(&output);
        let hasher = &mut self.hasher;
        hasher.word(output.tick);
        hasher.word(output.stage as u32);
        hasher.word(output.faults.0);
        hasher.vector(output.simulated);
        hasher.vector(output.rendered.get());
        if output.tick % WHOLE == 0 {
            let mut hasher = self.hasher;
            self.hash_whole(&mut hasher);
            self.hasher = hasher;
        }
        output
    }

    fn state_hash(&self) -> u64 {
        let mut hasher = self.hasher;
        self.hash_whole(&mut hasher);
        hasher.get()
    }

    fn stop(&mut self) {
        self.device = None;
    }
}

/// What a scene lacks, in the few bytes that a refusal has.
fn refusal(error: ConfigError) -> LoadError {
    LoadError(match error {
        ConfigError::Tissue(tissue::Error::TooManyNodes { .. }) => "lattice.cells: 24 x 24 x 12 nodes at most",
        ConfigError::Tissue(tissue::Error::CellCount) => "cells: one byte for each cell of the lattice",
        ConfigError::Tissue(tissue::Error::UnknownTissue) => "cells: 0 or 1 + a tissue's index",
        ConfigError::Tissue(tissue::Error::TooManyCurves) => "tissues: fewer soft tissues with curves of their own",
        ConfigError::Tissue(tissue::Error::Empty) => "cells: at least one voxel",
        ConfigError::Thread(_) => "thread: 3 to 64 nodes of positive length and stiffness",
        ConfigError::NoSkinAtSite => "stitch.left_m: a place on the skin",
    })
}
