//! The force that the device is told, one cell per axis: the only thing in the image that a motor would follow.

use core::sync::atomic::{AtomicU32, Ordering};

/// Rendered force, x y z \[N\] as f32 bits. Zero at reset.
// The reader is outside the program (a converter, a debugger); `used` keeps the compiler from dropping stores that nothing in here reads.
#[used]
static RENDERED_N: [AtomicU32; 3] = [const { AtomicU32::new(0) }; 3];

/// Tells the device a force \[N\].
pub(crate) fn render(force: [f32; 3]) {
    for (cell, newtons) in RENDERED_N.iter().zip(force) {
        cell.store(newtons.to_bits(), Ordering::Relaxed);
    }
}

/// Leaves the hand alone: zero force on every axis.
pub(crate) fn release() {
    render([0.0; 3]);
}
