//! Sutura's physics and its 1 kHz tick.
//!
//! No allocation, no clock, no I/O; time is a count of ticks. Arithmetic is + − × ÷ and √ in `f32`, `libm` for the rest,
//! so equal inputs give equal bits on every build and target.
#![cfg_attr(not(any(test, feature = "std")), no_std)]
#![forbid(unsafe_code)]

pub mod device;
pub mod event;
pub mod math;
pub mod record;
pub mod safety;
pub mod thread;
