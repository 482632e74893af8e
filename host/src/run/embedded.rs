//! The embedded controller: physics and a simulated device behind frames, in a thread of this process.

use std::thread::JoinHandle;

use sutura_controller::lanes::Level;
use sutura_controller::lattice::PC_NODES;
use sutura_controller::rig::Rig;
use sutura_controller::tick::Memory;

use crate::link::{ChannelTransport, Pace, Ran, channel, run_controller};

/// Most nodes of the embedded controller's patch.
pub const NODES_MAX: usize = 24 * 24 * 12;
/// Pieces on their way between the threads.
const PIECES: usize = 64;

/// Starts a controller, its passes on `level`, and gives the host's end of the line to it. The thread ends when that end is dropped.
///
/// # Errors
/// The system gives no thread.
pub fn start(pace: Pace, level: Level) -> std::io::Result<(ChannelTransport, JoinHandle<Ran>)> {
    let (ours, theirs) = channel(PIECES);
    let body = move || {
        let mut memory: Box<Memory<PC_NODES>> = bytemuck::zeroed_box();
        run_controller(theirs, Rig::new(&mut memory, level), pace)
    };
    let thread = std::thread::Builder::new().name("controller".to_owned()).spawn(body)?;
    Ok((ours, thread))
}
