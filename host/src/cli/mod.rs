//! The commands' flags, one file each.

pub(crate) mod poke;
