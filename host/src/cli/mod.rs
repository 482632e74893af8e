//! The commands' flags, one file each.

mod flags;
pub(crate) mod moduli;
pub(crate) mod poke;
