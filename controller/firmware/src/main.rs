//! The controller as a bare-metal image: no operating system, no allocator, no stack for what grows.
//!
//! There is no `#[global_allocator]`, so that the image links is the proof that neither the controller nor the wire allocates.
#![no_std]
#![no_main]
#![deny(unsafe_code)]

mod actuator;
mod halt;
mod uart;

use static_cell::ConstStaticCell;
use sutura_controller as _;
use sutura_shared::frame::Decoder;
use sutura_shared::message::ToController;
use uart::Uart;

static DECODER: ConstStaticCell<Decoder> = ConstStaticCell::new(Decoder::new());

#[cortex_m_rt::entry]
fn main() -> ! {
    actuator::release();
    let decoder = DECODER.take();
    let mut uart = Uart::open();
    loop {
        let frame = uart.receive().and_then(|byte| decoder.push(byte)).and_then(Result::ok);
        match frame.map(|frame| ToController::decode(&frame)) {
            Some(Ok(ToController::Stop)) => actuator::release(),
            _ => core::hint::spin_loop(),
        }
    }
}
