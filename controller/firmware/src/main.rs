//! The controller as a bare-metal image: no operating system, no allocator.
//!
//! What lives from tick to tick lies in static cells; the stack holds the scratch of one tick or one upload, some tens of kilobytes.
//!
//! There is no `#[global_allocator]`, so that the image links is the proof that neither the controller nor the wire allocates.
#![no_std]
#![no_main]
#![deny(unsafe_code)]

mod actuator;
mod halt;
mod uart;

use static_cell::{ConstStaticCell, StaticCell};
use sutura_controller::lanes::Level;
use sutura_controller::lattice::Lattice;
use sutura_controller::link::Server;
use sutura_controller::rig::Rig;
use sutura_controller::tick::Memory;
use sutura_shared::limits::STAGING_MAX;
use uart::Uart;

/// Array length of a patch that fits the memory of a common Cortex-M7 (512 KiB): holds 10 × 8 × 7 nodes.
const NODES: usize = Lattice::<0>::guard([10, 8, 7]) as usize;

// The first two are all zeros, so they cost no room in the image and are never built on the stack.
static MEMORY: ConstStaticCell<Memory<NODES>> = ConstStaticCell::new(bytemuck::zeroed());
static STAGING: ConstStaticCell<[u8; STAGING_MAX]> = ConstStaticCell::new([0; STAGING_MAX]);
static SERVER: StaticCell<Server<'static, Rig<'static, NODES>>> = StaticCell::new();

#[cortex_m_rt::entry]
fn main() -> ! {
    actuator::release();
    let uart = Uart::open();
    let (Some(memory), Some(staging)) = (MEMORY.try_take(), STAGING.try_take()) else {
        halt::halt();
    };
    let Some(server) = SERVER.try_init_with(|| Server::new(Rig::new(memory, Level::Single), staging)) else {
        halt::halt();
    };
    loop {
        if let Some(byte) = uart.receive() {
            server.receive(&[byte], &mut |frame| uart.send(frame));
        }
        if server.ready() {
            server.step(&mut |frame| uart.send(frame));
        }
        actuator::render(server.plant().force().get().into());
    }
}
