//! The embedded controller: physics and a simulated device behind frames, in a thread of this process.

use std::thread::JoinHandle;

use crossbeam_channel::Receiver;
use sutura_controller::lanes::Level;
use sutura_controller::lattice::PC_NODES;
use sutura_controller::link::{LoadError, Loaded, Plant};
use sutura_controller::record::Output;
use sutura_controller::rig::Rig;
use sutura_controller::tick::{Controller, Memory};
use sutura_shared::scene::Scene;

use super::watch::{Seen, Watched};
use crate::link::{ChannelTransport, Pace, Ran, channel, run_controller};

/// Most nodes of the embedded controller's patch.
pub const NODES_MAX: usize = 24 * 24 * 12;
/// Pieces on their way between the threads.
const PIECES: usize = 64;

/// A controller of this capacity with a simulated device. The physics is generic over the capacity and would be compiled anew by whoever
/// names it; here it is compiled once.
#[derive(Debug)]
pub struct PcRig<'m>(Rig<'m, PC_NODES>);

impl<'m> PcRig<'m> {
    /// A rig without a scene, in this memory. Its passes run on `level`.
    #[must_use]
    #[inline(never)]
    pub fn new(memory: &'m mut Memory<PC_NODES>, level: Level) -> Self {
        Self(Rig::new(memory, level))
    }

    /// The controller, for reports.
    #[must_use]
    pub const fn controller(&self) -> &Controller<'m, PC_NODES> {
        self.0.controller()
    }
}

impl Plant for PcRig<'_> {
    #[inline(never)]
    fn load(&mut self, scene: &Scene, cells: &[u8]) -> Result<Loaded, LoadError> {
        self.0.load(scene, cells)
    }

    #[inline(never)]
    fn tick(&mut self) -> Output {
        self.0.tick()
    }

    #[inline(never)]
    fn state_hash(&self) -> u64 {
        self.0.state_hash()
    }

    #[inline(never)]
    fn release(&mut self) {
        self.0.release();
    }

    #[inline(never)]
    fn stop(&mut self) {
        self.0.stop();
    }
}

/// The host's side of an embedded controller.
#[derive(Debug)]
pub struct Embedded {
    /// The line to it; the controller's thread ends when this is dropped.
    pub line: ChannelTransport,
    /// What is seen of it: one record a tick, there before the tick's telemetry is.
    pub seen: Receiver<Seen>,
    /// Its thread.
    pub thread: JoinHandle<Ran>,
}

/// Starts a controller, its passes on `level`; it shows the whole patch `every` so many ticks.
///
/// # Errors
/// The system gives no thread.
pub fn start(pace: Pace, level: Level, every: Option<u32>) -> std::io::Result<Embedded> {
    let (line, theirs) = channel(PIECES);
    let (sink, seen) = crossbeam_channel::unbounded();
    let body = move || {
        let mut memory: Box<Memory<PC_NODES>> = bytemuck::zeroed_box();
        let rig = PcRig::new(&mut memory, level);
        run_controller(theirs, Watched { rig, every, sink }, pace)
    };
    let thread = std::thread::Builder::new().name("controller".to_owned()).spawn(body)?;
    Ok(Embedded { line, seen, thread })
}
