//! The tissue's outer surface as the thread feels it: P_c = k Δx along the normal (Lian & Chen Eq. 8, Fig. 15).

use crate::math::Vec3;

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

impl Touch {
    /// Depth below the surface's tangent plane after the point has moved by `moved` [m]; zero outside.
    pub(super) fn depth(&self, moved: Vec3) -> f32 {
        (-self.gap - self.normal.dot(&moved)).max(0.0)
    }
}
