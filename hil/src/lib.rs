//! hil.
