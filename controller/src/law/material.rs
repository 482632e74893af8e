//! What all springs of a patch follow.

use super::Curve;
use crate::lattice::CURVES;

/// What the springs follow, and the coefficients of inertia and damping with the period folded in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Material {
    /// Curves by slot; unused ones are zero.
    pub curves: [Curve; CURVES],
    /// Whether the curves have breakpoints (effect `stiffening`).
    pub stiffening: bool,
    /// Whether voxels have an energy of their own: that of their volume (law `volume`), or of their barrier alone (effect `barrier`).
    pub volume: bool,
    /// Mass damping α [1/s].
    pub mass_damping: f32,
    /// β of the dashpots [s]; zero without effect `spring-damping`.
    pub spring_damping: f32,
}
