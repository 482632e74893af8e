//! What the encoders see of the arm and of the passive gimbal.
//!
//! Joints: HEDM-5500, 1024 lines read fourfold, behind the motors' ratios (25, 29, 23 µm at the tip a count).
//! Gimbal: yaw about y, pitch about x, roll about z of the lower link. No data sheet gives the passive gimbal's encoders;
//! assumed is the same encoder directly on each axis, 0.088° a count, coarser than the motorised gimbal's stated 0.0023°.

use super::dynamics::RATIOS;
use super::kinematics::Posture;
use crate::math::{Mat3, Vec3};
use core::f32::consts::TAU;

/// Counts of one turn of the encoder's shaft.
pub const COUNTS: f32 = 4096.0;

/// Joint angles as the encoders give them [rad].
#[must_use]
pub fn joints(angle: Vec3) -> Vec3 {
    angle.zip_map(&Vec3::from(RATIOS), quantised)
}

/// `device_from_stylus` as the encoders give it: `actual` taken apart over the true `arm`, put together over the `measured` one.
#[must_use]
pub fn orientation(actual: Mat3, arm: &Posture, measured: &Posture) -> Mat3 {
    let [yaw, pitch, roll] = gimbal(&(arm.lower_link().transpose() * actual)).map(|angle| quantised(angle, 1.0));
    measured.lower_link() * about_y(yaw) * about_x(pitch) * about_z(roll)
}

/// The count an angle falls on, as an angle [rad]; `ratio` encoder turns to one turn.
fn quantised(angle: f32, ratio: f32) -> f32 {
    let counts = COUNTS * ratio / TAU;
    libm::roundf(angle * counts) / counts
}

/// Yaw, pitch and roll of R = R_y R_x R_z [rad]. Roll is what yaw and pitch leave, so the three always compose to R,
/// also at pitch ±90° where yaw is free.
fn gimbal(r: &Mat3) -> [f32; 3] {
    let yaw = libm::atan2f(r[(0, 2)], r[(2, 2)]);
    let turned = about_y(-yaw) * r;
    let pitch = libm::atan2f(-turned[(1, 2)], turned[(2, 2)]);
    let rest = about_x(-pitch) * turned;
    [yaw, pitch, libm::atan2f(rest[(1, 0)], rest[(0, 0)])]
}

fn about_x(angle: f32) -> Mat3 {
    let (s, c) = libm::sincosf(angle);
    Mat3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
}

fn about_y(angle: f32) -> Mat3 {
    let (s, c) = libm::sincosf(angle);
    Mat3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c)
}

fn about_z(angle: f32) -> Mat3 {
    let (s, c) = libm::sincosf(angle);
    Mat3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{length, rotation};

    #[test]
    fn a_count_moves_the_tip_by_what_the_data_sheet_says() {
        // 0.03 mm nominal; 25, 29 and 23 µm from ratio and lever at the neutral pose.
        for (i, microns) in [24.8, 29.4, 23.3].into_iter().enumerate() {
            let count = TAU / (COUNTS * RATIOS[i]);
            let mut angle = Vec3::zeros();
            angle[i] = 0.6 * count;
            let moved = length(Posture::at(joints(angle)).tip() - Posture::at(Vec3::zeros()).tip());
            assert!((moved * 1e6 - microns).abs() < 0.1, "{moved}");
            angle[i] = 0.4 * count;
            assert_eq!(joints(angle), Vec3::zeros());
        }
    }

    #[test]
    fn the_gimbal_gives_any_orientation_to_half_a_count_an_axis() {
        let half = 0.5 * TAU / COUNTS;
        for i in 0_u16..2000 {
            let f = f32::from(i);
            let axis = Vec3::new(libm::sinf(f), libm::cosf(1.7 * f), libm::sinf(0.3 * f + 1.0));
            let actual = rotation(axis / length(axis), 3.1 * libm::sinf(0.77 * f));
            let arm = Posture::at(Vec3::new(0.5, 0.1, -0.2));
            let seen = orientation(actual, &arm, &arm);
            // Each axis turns the result by at most half a count; an entry moves by no more than the angle.
            assert!((seen - actual).abs().max() < 3.0 * half + 1e-5, "{i}");
            assert!((seen * seen.transpose() - Mat3::identity()).abs().max() < 1e-5);
        }
    }

    #[test]
    fn gimbal_lock_still_composes() {
        for pitch in [90.0_f32, -90.0] {
            let actual = about_y(0.4) * about_x(pitch.to_radians()) * about_z(-0.9);
            let [yaw, tilt, roll] = gimbal(&actual);
            let again = about_y(yaw) * about_x(tilt) * about_z(roll);
            assert!((again - actual).abs().max() < 1e-5);
        }
    }
}
