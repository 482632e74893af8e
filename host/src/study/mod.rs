//! Studies: what a choice of law, pitch and solver costs and gives, measured on plain blocks of tissue.
//!
//! They run the controller's own lattice and solvers, beside an independent model in double precision ([`double`]).

pub mod accuracy;
pub mod band;
pub mod block;
pub mod budget;
pub mod callgrind;
pub mod double;
pub mod effects;
pub mod fem;
pub mod limit;
pub mod method;
pub mod moduli;
mod parallel;
pub mod path;
pub mod pd;
pub mod poke;
pub mod spring;
pub mod stability;
pub mod xpbd;
