//! The controller as a bare-metal image: no operating system, no allocator, one static memory.
//!
//! There is no `#[global_allocator]`, so that the image links is the proof that neither the controller nor the wire allocates.
#![no_std]
#![no_main]
#![deny(unsafe_code)]

mod actuator;
mod halt;

use sutura_controller as _;
use sutura_shared as _;

#[cortex_m_rt::entry]
fn main() -> ! {
    actuator::release();
    loop {
        core::hint::spin_loop();
    }
}
