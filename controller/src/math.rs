//! Vectors, frames and the few functions beyond + − × ÷.

use sutura_shared::scene;

/// A vector or a point, SI.
pub type Vec3 = nalgebra::Vector3<f32>;
/// A 3 × 3 matrix.
pub type Mat3 = nalgebra::Matrix3<f32>;

/// Ticks a second.
pub const TICK_HZ: u32 = 1000;
/// The period [s]; coefficients carry it, no function takes it.
pub const DT: f32 = 1.0 / TICK_HZ as f32;

/// Square root, correctly rounded on every target; NaN below zero.
#[inline]
#[must_use]
pub fn sqrt(x: f32) -> f32 {
    #[cfg(any(test, feature = "std"))]
    return x.sqrt();
    #[cfg(not(any(test, feature = "std")))]
    return libm::sqrtf(x);
}

/// Euclidean length.
#[inline]
#[must_use]
pub fn length(v: Vec3) -> f32 {
    sqrt(v.dot(&v))
}

/// `v` over its length, or zero where the length is below `floor`.
#[inline]
#[must_use]
pub fn direction(v: Vec3, floor: f32) -> Vec3 {
    let length = length(v);
    if length > floor { v / length } else { Vec3::zeros() }
}

/// Rotation by `angle` [rad] about the unit vector `axis` (Rodrigues).
#[must_use]
pub fn rotation(axis: Vec3, angle: f32) -> Mat3 {
    let (sin, cos) = libm::sincosf(angle);
    Mat3::identity() * cos + axis.cross_matrix() * sin + axis * axis.transpose() * (1.0 - cos)
}

/// Whether every component is finite.
#[inline]
#[must_use]
pub fn finite(v: Vec3) -> bool {
    v.iter().all(|x| x.is_finite())
}

/// A rigid frame: `a_from_b` takes a point of b to a.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Origin of b in a [m].
    pub position: Vec3,
    /// Axes of b in a, by columns; orthonormal.
    pub rotation: Mat3,
}

impl Default for Pose {
    fn default() -> Self {
        Self {
            position: Vec3::zeros(),
            rotation: Mat3::identity(),
        }
    }
}

impl Pose {
    /// `a_from_b.then(b_from_c)` = `a_from_c`.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self {
            position: self.point(next.position),
            rotation: self.rotation * next.rotation,
        }
    }

    /// `b_from_a`.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self {
            position: -(rotation * self.position),
            rotation,
        }
    }

    /// A point of b in a.
    #[must_use]
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.position + self.rotation * p
    }
}

impl From<scene::Pose> for Pose {
    fn from(pose: scene::Pose) -> Self {
        let [w, x, y, z] = pose.quaternion;
        Self {
            position: Vec3::from(pose.position_m),
            rotation: Mat3::new(
                1.0 - 2.0 * (y * y + z * z),
                2.0 * (x * y - w * z),
                2.0 * (x * z + w * y),
                2.0 * (x * y + w * z),
                1.0 - 2.0 * (x * x + z * z),
                2.0 * (y * z - w * x),
                2.0 * (x * z - w * y),
                2.0 * (y * z + w * x),
                1.0 - 2.0 * (x * x + y * y),
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_about_z_takes_x_to_y() {
        let turned = rotation(Vec3::z(), core::f32::consts::FRAC_PI_2) * Vec3::x();
        assert!(length(turned - Vec3::y()) < 1e-7);
    }

    #[test]
    fn a_quaternion_and_rodrigues_agree() {
        let half = 0.35_f32;
        let pose = Pose::from(scene::Pose {
            position_m: [0.0; 3],
            quaternion: [libm::cosf(half), 0.0, libm::sinf(half), 0.0],
        });
        assert!((pose.rotation - rotation(Vec3::y(), 2.0 * half)).abs().max() < 1e-6);
    }

    #[test]
    fn a_frame_and_its_inverse_cancel() {
        let frame = Pose {
            position: Vec3::new(0.1, -0.2, 0.3),
            rotation: rotation(Vec3::x(), 0.7),
        };
        let same = frame.then(&frame.inverse());
        assert!(length(same.position) < 1e-7);
        assert!((same.rotation - Mat3::identity()).abs().max() < 1e-6);
    }
}
