//! The `sutura` program.
fn main() {}
