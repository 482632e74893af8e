//! Fixed windows into the node arrays.
//!
//! Passes run over blocks of a constant number of nodes, so every inner loop has a constant length and vectorises. A window may reach
//! past the last node into the guard that [`crate::lattice::Lattice::guard`] asks for: there is no stiffness there.

/// Nodes of one block; a multiple of the widest vector.
pub(super) const BLOCK: usize = 64;
/// One number for each node of a block.
pub(super) type Lane = [f32; BLOCK];

const NOTHING: Lane = [0.0; BLOCK];

/// The block that begins at node `at`.
#[inline]
pub(super) fn window<const N: usize>(values: &[f32; N], at: usize) -> &Lane {
    values.get(at..).and_then(|rest| rest.first_chunk()).unwrap_or(&NOTHING)
}

/// The block that begins at node `at`, to write to; `None` past the guard.
#[inline]
pub(super) fn window_mut<const N: usize>(values: &mut [f32; N], at: usize) -> Option<&mut Lane> {
    values.get_mut(at..)?.first_chunk_mut()
}
