//! The stress–strain curve of a tissue as its springs follow it.

use super::breaks::Breaks;
use super::{Stiffness, fit};
use sutura_shared::scene::Segment;

/// Lock of the body diagonals: uniaxial compression to 30 % shortens them by this much.
const DIAGONAL_LOCK: (f32, f32) = (0.045, 1000.0);

/// A tissue's curve as its springs follow it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Curve {
    /// First slope [Pa].
    pub young: f32,
    /// Breakpoints of the edges.
    pub edge: Breaks,
    /// Breakpoints of the body diagonals.
    pub diagonal: Breaks,
}

impl Curve {
    /// Springs that follow segments of nominal stress against strain (the first begins at zero) with the law's stiffness.
    #[must_use]
    pub fn new(segments: &[Segment], stiffness: Stiffness) -> Self {
        let [edge, diagonal] = fit::fit(segments, stiffness, DIAGONAL_LOCK);
        Self {
            young: segments.first().map_or(0.0, |s| s.slope_pa),
            edge,
            diagonal,
        }
    }
}
