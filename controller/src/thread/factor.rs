//! L D Lᵀ of a symmetric positive definite 3 × 3 block: no square root, three divisions, no pivoting.

use crate::math::{Mat3, Vec3};

/// A factored block; only its lower triangle was read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Factor {
    below: [f32; 3],
    inverse: [f32; 3],
}

impl Factor {
    /// Factors `block`.
    pub(super) fn new(block: &Mat3) -> Self {
        // Rounding can leave a pivot at or below zero where a block is all but singular; the floor keeps the step finite.
        let floor = 1e-7 * block.trace() + f32::MIN_POSITIVE;
        let first = 1.0 / block.m11.max(floor);
        let l21 = block.m21 * first;
        let l31 = block.m31 * first;
        let second = 1.0 / (block.m22 - l21 * block.m21).max(floor);
        let rest = block.m32 - l31 * block.m21;
        let l32 = rest * second;
        let third = 1.0 / (block.m33 - l31 * block.m31 - l32 * rest).max(floor);
        Self {
            below: [l21, l31, l32],
            inverse: [first, second, third],
        }
    }

    /// The x with block·x = `b`.
    #[inline]
    pub(super) fn solve(&self, b: Vec3) -> Vec3 {
        let [l21, l31, l32] = self.below;
        let [first, second, third] = self.inverse;
        let y2 = b.y - l21 * b.x;
        let y3 = b.z - l31 * b.x - l32 * y2;
        let z = y3 * third;
        let y = y2 * second - l32 * z;
        let x = b.x * first - l21 * y - l31 * z;
        Vec3::new(x, y, z)
    }

    /// The X with block·X = `b`.
    #[inline]
    pub(super) fn solve_columns(&self, b: &Mat3) -> Mat3 {
        let column = |m1: f32, m2: f32, m3: f32| self.solve(Vec3::new(m1, m2, m3));
        Mat3::from_columns(&[
            column(b.m11, b.m21, b.m31),
            column(b.m12, b.m22, b.m32),
            column(b.m13, b.m23, b.m33),
        ])
    }
}
