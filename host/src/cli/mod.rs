//! The commands' flags, one file each.

pub(crate) mod flags;
pub(crate) mod moduli;
pub(crate) mod poke;
pub(crate) mod score;
pub(crate) mod study;
pub(crate) mod ticks;
