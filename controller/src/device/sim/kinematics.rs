//! Kinematics of the Premium 1.5 in the frame of Çavuşoğlu, Feygin & Tendick (Presence 11(6), 2002).
//!
//! x right, y up, z to the user, origin at the tip's neutral place. Joints q = (turret, upper link above the horizontal,
//! lower link from hanging straight down), the last two as absolute angles:
//!
//! ```text
//! r = l1 cos q2 + l2 sin q3
//! x = r sin q1      y = l2 − l2 cos q3 + l1 sin q2      z = −l1 + r cos q1
//! ```

use crate::math::{Mat3, Vec3, sqrt};
use core::f32::consts::FRAC_PI_2;

/// Length of the upper link l1 [m].
pub const UPPER: f32 = 0.215;
/// Length of the lower link l2 [m].
pub const LOWER: f32 = 0.170;

/// One joint's way between two stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// The angle as a combination of q1, q2, q3.
    pub direction: [f32; 3],
    /// Lowest and highest angle [rad].
    pub range: [f32; 2],
}

/// The stops of one measured arm: q1 ±90°, q2 −124…119°, q3 −29…214°, q2 − q3 −55…65°.
pub const STOPS: [Stop; 4] = [
    stop([1.0, 0.0, 0.0], -90.0, 90.0),
    stop([0.0, 1.0, 0.0], -124.0, 119.0),
    stop([0.0, 0.0, 1.0], -29.0, 214.0),
    stop([0.0, 1.0, -1.0], -55.0, 65.0),
];

const fn stop(direction: [f32; 3], from_deg: f32, to_deg: f32) -> Stop {
    Stop {
        direction,
        range: [from_deg.to_radians(), to_deg.to_radians()],
    }
}

/// Whether the stops allow `q` [rad].
#[must_use]
pub fn within_stops(q: Vec3) -> bool {
    STOPS.iter().all(|stop| {
        let [from, to] = stop.range;
        (from..=to).contains(&q.dot(&Vec3::from(stop.direction)))
    })
}

/// Joint angles [rad] that put the tip at `p` [m], elbow above; none where the links do not reach.
#[must_use]
pub fn inverse(p: Vec3) -> Option<Vec3> {
    // Rounding may put a stretched arm just beyond its reach.
    const REACH: f32 = 1.0 + 1e-6;
    let radius = sqrt(p.x * p.x + (p.z + UPPER) * (p.z + UPPER));
    let height = p.y - LOWER;
    let squared = radius * radius + height * height;
    let cos = (squared - UPPER * UPPER - LOWER * LOWER) / (2.0 * UPPER * LOWER);
    if !(-REACH..=REACH).contains(&cos) {
        return None;
    }
    let sin = sqrt((1.0 - cos * cos).max(0.0));
    let q2 = libm::atan2f(height, radius) + libm::atan2f(LOWER * sin, UPPER + LOWER * cos);
    let q3 = q2 - libm::atan2f(sin, cos) + FRAC_PI_2;
    Some(Vec3::new(libm::atan2f(p.x, p.z + UPPER), q2, q3))
}

/// The arm at one set of joint angles: its sines and cosines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Posture {
    pub(super) s: [f32; 3],
    pub(super) c: [f32; 3],
}

impl Posture {
    /// The arm at joint angles `q` [rad].
    #[must_use]
    pub fn at(q: Vec3) -> Self {
        let [(s1, c1), (s2, c2), (s3, c3)] = [q.x, q.y, q.z].map(libm::sincosf);
        Self {
            s: [s1, s2, s3],
            c: [c1, c2, c3],
        }
    }

    /// Distance of the tip from the turret's axis r [m].
    fn radius(&self) -> f32 {
        UPPER * self.c[1] + LOWER * self.s[2]
    }

    /// The tip (the gimbal's centre) [m].
    #[must_use]
    pub fn tip(&self) -> Vec3 {
        let radius = self.radius();
        Vec3::new(
            radius * self.s[0],
            LOWER - LOWER * self.c[2] + UPPER * self.s[1],
            radius * self.c[0] - UPPER,
        )
    }

    /// J: tip velocity from joint rates [m/rad]. Singular at q2 − q3 = ±90° and at r = 0; always finite.
    #[must_use]
    pub fn jacobian(&self) -> Mat3 {
        let ([s1, s2, s3], [c1, c2, c3]) = (self.s, self.c);
        let radius = self.radius();
        Mat3::new(
            radius * c1,
            -UPPER * s2 * s1,
            LOWER * c3 * s1,
            0.0,
            UPPER * c2,
            LOWER * s3,
            -radius * s1,
            -UPPER * s2 * c1,
            LOWER * c3 * c1,
        )
    }

    /// J̇ q̇: the tip's acceleration at constant joint rates `rate` [rad/s], in m/s².
    #[must_use]
    pub fn convective(&self, rate: Vec3) -> Vec3 {
        let ([s1, s2, s3], [c1, c2, c3]) = (self.s, self.c);
        let (turret, upper, lower) = (rate.x, rate.y * rate.y, rate.z * rate.z);
        let radial = LOWER * c3 * rate.z - UPPER * s2 * rate.y;
        let outward = -UPPER * c2 * upper - LOWER * s3 * lower - self.radius() * turret * turret;
        let sideways = 2.0 * radial * turret;
        Vec3::new(
            outward * s1 + sideways * c1,
            LOWER * c3 * lower - UPPER * s2 * upper,
            outward * c1 - sideways * s1,
        )
    }

    /// `device_from_link` of the lower link, which carries the gimbal: R_y(q1) R_x(−q3).
    #[must_use]
    pub fn lower_link(&self) -> Mat3 {
        let ([s1, _, s3], [c1, _, c3]) = (self.s, self.c);
        Mat3::new(
            c1,
            -s1 * s3,
            s1 * c3, //
            0.0,
            c3,
            s3, //
            -s1,
            -c1 * s3,
            c1 * c3,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{finite, length, rotation};

    /// The same map in double precision, written from the equations of the module's head.
    fn forward_f64(q: [f64; 3]) -> [f64; 3] {
        let (l1, l2) = (f64::from(UPPER), f64::from(LOWER));
        let r = l1 * q[1].cos() + l2 * q[2].sin();
        [
            r * q[0].sin(),
            l2 - l2 * q[2].cos() + l1 * q[1].sin(),
            -l1 + r * q[0].cos(),
        ]
    }

    fn postures() -> impl Iterator<Item = Vec3> {
        (0..9 * 9 * 9).map(|i| {
            let grid = |n: i32| (n % 9 - 4) as f32;
            let q2 = 0.3 * grid(i / 9);
            Vec3::new(0.35 * grid(i), q2, q2 + 0.22 * grid(i / 81))
        })
    }

    #[test]
    fn the_published_vectors_hold() {
        // Computed from the published equations with l1 = 0.215 m, l2 = 0.170 m: mm and m³.
        let cases = [
            ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], 0.215 * 0.215 * 0.170),
            ([0.3, 0.4, 0.2], [68.5021, 87.1136, 6.4488], 0.008_303),
            ([-0.5, 0.2, 0.6], [-147.0415, 72.4069, 54.1577], 0.010_325),
        ];
        for (q, tip_mm, determinant) in cases {
            let posture = Posture::at(Vec3::from(q));
            assert!(length(posture.tip() * 1e3 - Vec3::from(tip_mm)) < 2e-4, "{q:?}");
            let [x, y, z] = [0, 1, 2].map(|i| Vec3::from(posture.jacobian().column(i)));
            assert!((x.dot(&y.cross(&z)) - determinant).abs() < 1e-6, "{q:?}");
        }
    }

    #[test]
    fn the_jacobian_is_the_slope_of_the_map() {
        // Central differences in f64 are good to 1e-10; J itself to a few roundings of 0.4 m.
        let h = 1e-5;
        for q in postures() {
            let jacobian = Posture::at(q).jacobian();
            for j in 0..3 {
                let mut ends = [[q.x, q.y, q.z].map(f64::from); 2];
                ends[0][j] -= h;
                ends[1][j] += h;
                let [from, to] = ends.map(forward_f64);
                for i in 0..3 {
                    let slope = (to[i] - from[i]) / (2.0 * h);
                    assert!((f64::from(jacobian[(i, j)]) - slope).abs() < 1e-7, "{q:?}");
                }
            }
        }
    }

    #[test]
    fn the_convective_acceleration_is_the_second_difference_along_constant_rates() {
        let rate = [1.5, -0.7, 0.9];
        let h = 1e-4;
        for q in postures() {
            let at = |t: f64| forward_f64([0, 1, 2].map(|i| f64::from(q[i]) + t * rate[i]));
            let (back, mid, ahead) = (at(-h), at(0.0), at(h));
            let computed = Posture::at(q).convective(Vec3::from(rate.map(|r| r as f32)));
            for i in 0..3 {
                let second = (back[i] - 2.0 * mid[i] + ahead[i]) / (h * h);
                assert!((f64::from(computed[i]) - second).abs() < 2e-6, "{q:?}");
            }
        }
    }

    #[test]
    fn inverse_undoes_forward() {
        for q in postures().filter(|q| UPPER * libm::cosf(q.y) + LOWER * libm::sinf(q.z) > 0.02) {
            let back = inverse(Posture::at(q).tip()).unwrap();
            assert!(length(Posture::at(back).tip() - Posture::at(q).tip()) < 2e-7, "{q:?}");
            // Rounding of the tip reaches the angles through J⁻¹, at most 1/(0.02 m) here.
            assert!(length(back - q) < 1e-5, "{q:?} {back:?}");
        }
    }

    #[test]
    fn singular_postures_stay_finite() {
        let stretched = Vec3::new(0.0, 0.3, 0.3 + FRAC_PI_2);
        let folded = Vec3::new(0.0, 0.3, 0.3 - FRAC_PI_2);
        for q in [stretched, folded] {
            let posture = Posture::at(q);
            assert!(posture.jacobian().iter().all(|x| x.is_finite()));
            let back = inverse(posture.tip()).unwrap();
            assert!(length(Posture::at(back).tip() - posture.tip()) < 1e-6);
        }
        let above_the_turret = Vec3::new(0.0, 0.1, -UPPER);
        assert!(finite(inverse(above_the_turret).unwrap()));
        assert_eq!(inverse(Vec3::new(0.0, 0.0, 1.0)), None);
        assert_eq!(inverse(Vec3::new(f32::NAN, 0.0, 0.0)), None);
    }

    #[test]
    fn the_stops_hold_the_neutral_pose_and_refuse_what_lies_behind() {
        assert!(within_stops(Vec3::zeros()));
        assert!(!within_stops(Vec3::new(1.6, 0.0, 0.0)));
        assert!(!within_stops(Vec3::new(0.0, 1.2, 0.0)));
        assert!(!within_stops(Vec3::new(0.0, f32::NAN, 0.0)));
    }

    #[test]
    fn the_lower_link_points_from_elbow_to_tip() {
        let q = Vec3::new(0.4, 0.2, 0.7);
        let posture = Posture::at(q);
        let elbow = rotation(Vec3::y(), q.x) * Vec3::new(0.0, UPPER * libm::sinf(q.y), UPPER * libm::cosf(q.y))
            + Vec3::new(0.0, LOWER, -UPPER);
        let along = posture.lower_link() * Vec3::new(0.0, -LOWER, 0.0);
        assert!(length(elbow + along - posture.tip()) < 1e-7);
        let composed = rotation(Vec3::y(), q.x) * rotation(Vec3::x(), -q.z);
        assert!((composed - posture.lower_link()).abs().max() < 1e-6);
    }
}
