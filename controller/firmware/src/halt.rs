//! How the image ends when it cannot go on: with zero force, and for ever.

use crate::actuator;
use core::{
    panic::PanicInfo,
    ptr,
    sync::atomic::{AtomicUsize, Ordering},
};
use cortex_m_rt::{ExceptionFrame, exception};

/// Address of the panic's `core::panic::Location`, for a debugger; 0 while all is well.
// Also what keeps the panic sites of one function apart: without it the compiler merges them, and the check that counts them would see less.
#[used]
static PANICKED_AT: AtomicUsize = AtomicUsize::new(0);

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    actuator::release();
    if let Some(location) = info.location() {
        PANICKED_AT.store(ptr::from_ref(location).addr(), Ordering::Relaxed);
    }
    halt()
}

// A fault may strike between any two instructions, which is why these two signatures are unsafe; all they touch is atomic.

#[allow(unsafe_code)]
#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    halt()
}

#[allow(unsafe_code)]
#[exception]
unsafe fn DefaultHandler(_: i16) -> ! {
    halt()
}

/// Zero force, for ever.
pub(crate) fn halt() -> ! {
    actuator::release();
    loop {
        core::hint::spin_loop();
    }
}
