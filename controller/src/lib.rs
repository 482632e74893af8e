//! Sutura's physics and its 1 kHz tick.
//!
//! No allocation, no clock, no I/O; time is a count of ticks. Arithmetic is + − × ÷ and √ in `f32`, `libm` for the rest,
//! so equal inputs give equal bits on every build and target.
#![cfg_attr(not(any(test, feature = "std")), no_std)]
#![forbid(unsafe_code)]

pub mod coupling;
pub mod device;
pub mod effects;
pub mod event;
pub mod hash;
pub mod lanes;
pub mod lattice;
pub mod law;
pub mod link;
pub mod math;
pub mod needle;
pub mod record;
pub mod rig;
pub mod safety;
pub mod solver;
pub mod stage;
pub mod surface;
pub mod tear;
pub mod thread;
pub mod tick;
pub mod tissue;
pub mod wound;
