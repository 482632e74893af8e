//! The output edge: the only place that makes a force a device may receive.

use crate::math::Vec3;

/// A force that went through the output edge, device frame [N]. Zero by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LimitedForce(Vec3);

impl LimitedForce {
    /// The force [N].
    #[must_use]
    pub const fn get(self) -> Vec3 {
        self.0
    }
}
