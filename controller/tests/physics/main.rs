//! The tissue, its solver, the wound and the needle against formulas and against springs computed apart in double precision.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

mod bars;
mod block;
mod curves;
mod descent;
mod halfspace;
mod hard;
mod monolith;
mod motion;
mod needle;
mod patch;
mod reference;
mod solvers;
mod statics;
mod swelling;
mod volume;
mod waves;
mod wound;
