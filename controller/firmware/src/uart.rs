//! The serial line to the host: the CMSDK UART of the MPS2 boards, polled.

use core::ptr;

/// UART 0.
const BASE: usize = 0x4000_4000;
/// A byte, either way.
const DATA: usize = BASE;
/// What the line can do now.
const STATE: usize = BASE + 0x04;
/// What is switched on.
const CONTROL: usize = BASE + 0x08;
/// Clock ticks of one bit.
const DIVIDER: usize = BASE + 0x10;

/// In [`STATE`]: no room to send.
const SEND_FULL: u32 = 1 << 0;
/// In [`STATE`]: a byte is there.
const RECEIVED: u32 = 1 << 1;
/// In [`CONTROL`]: both ways on.
const BOTH_WAYS: u32 = 0b11;
/// 25 MHz / 217 ≈ 115,200 bits a second.
const CLOCKS_PER_BIT: u32 = 217;

/// The serial line.
pub(crate) struct Uart(());

impl Uart {
    /// Switches the line on.
    pub(crate) fn open() -> Self {
        write(DIVIDER, CLOCKS_PER_BIT);
        write(CONTROL, BOTH_WAYS);
        Self(())
    }

    /// The next byte from the host, if one is there.
    pub(crate) fn receive(&self) -> Option<u8> {
        (read(STATE) & RECEIVED != 0).then(|| read(DATA).to_le_bytes()[0])
    }

    /// Sends bytes to the host; waits for the line.
    pub(crate) fn send(&self, bytes: &[u8]) {
        for byte in bytes {
            while read(STATE) & SEND_FULL != 0 {}
            write(DATA, u32::from(*byte));
        }
    }
}

#[allow(unsafe_code)]
fn read(register: usize) -> u32 {
    // SAFETY: only the constants above come here, each the address of a register of the board that may be read at any time.
    unsafe { ptr::with_exposed_provenance::<u32>(register).read_volatile() }
}

#[allow(unsafe_code)]
fn write(register: usize, value: u32) {
    // SAFETY: only the constants above come here, each the address of a register of the board that may be written at any time.
    unsafe { ptr::with_exposed_provenance_mut::<u32>(register).write_volatile(value) }
}
