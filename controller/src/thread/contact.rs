//! The tissue's outer surface as the thread feels it: P_c = k Δx along the normal (Lian & Chen Eq. 8, Fig. 15).

use crate::math::{Mat3, Vec3};

/// A surface on which a thread may lie.
pub trait Ground {
    /// The surface near `p` [m]; none where there is no surface to lie on.
    fn at(&self, p: Vec3) -> Option<Touch>;
}

/// A point against a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Distance from the surface along `normal` [m], negative inside.
    pub gap: f32,
    /// Outward normal, unit length.
    pub normal: Vec3,
}

/// Force of a surface with penalty `k` [N/m] on a point that has `moved` [m] since it was at `touch`, and the force's derivative
/// to motion, negated [N/m].
pub(super) fn press(touch: &Touch, k: f32, moved: Vec3) -> (Vec3, Mat3) {
    let depth = -touch.gap - touch.normal.dot(&moved);
    if depth > 0.0 {
        (touch.normal * (k * depth), touch.normal * touch.normal.transpose() * k)
    } else {
        (Vec3::zeros(), Mat3::zeros())
    }
}
