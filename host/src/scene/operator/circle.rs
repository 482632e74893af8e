//! The circle on which a needle goes from puncture to puncture, and how a hand leads it there.
//!
//! The needle's arc lies in its xy-plane, its centre is o, and the grasp is o + R x̂, where the driver holds it: the tip is as far ahead as
//! the arc between them. Sewing from left to right the needle's ẑ is −ŷ of the patch, and ψ, the angle of the grasp from x towards z, grows
//! as the needle advances: grasp(ψ) = o + R (cos ψ, 0, sin ψ). The nominal circle passes both punctures: o is √(R² − d²) above their middle,
//! d half their distance. A person may hold the needle off that circle at the entry, and turn it about another point than o: `Led`.

use std::f64::consts::PI;

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use sutura_shared::scene::Motion;

use super::{Place, single};
use crate::scene::needle::Needle;
use crate::scene::skill::Manner;

/// The needle's nominal circle.
struct Circle {
    centre: Vector3<f64>,
    radius: f64,
    /// From the grasp to the tip [rad].
    tip: f64,
    /// Half the distance of the punctures [m].
    half: f64,
}

impl Circle {
    /// The circle for bites that are longer than the place's by so much; the exit no further from the entry than the needle can.
    fn through(place: &Place, longer_m: [f64; 2]) -> Self {
        let needle = Needle {
            radius_mm: place.radius_m * 1e3,
            ahead_mm: place.ahead_m * 1e3,
        };
        let widest = place.half_m.max(needle.widest_mm() * 1e-3);
        let [entry, exit] = longer_m.map(|longer| place.half_m + longer);
        let half = f64::midpoint(entry, exit).min(widest);
        let height = (place.radius_m * place.radius_m - half * half).max(0.0).sqrt();
        let skin = (place.skin_m[0] + place.skin_m[1]) / 2.0;
        Self {
            centre: Vector3::new(half - entry, place.y_m, skin + height),
            radius: place.radius_m,
            tip: place.ahead_m / place.radius_m,
            half,
        }
    }

    /// Angle of puncture a from x towards z.
    fn a(&self) -> f64 {
        PI + (self.half / self.radius).acos()
    }

    fn with_tip_at_a(&self) -> f64 {
        self.a() - self.tip
    }

    fn tangent_at_a(&self) -> Vector3<f64> {
        direction(self.a() + PI / 2.0)
    }

    /// Pose of the needle with its grasp at `angle`.
    fn grasp(&self, angle: f64) -> Isometry3<f64> {
        let axes = Matrix3::from_columns(&[direction(angle), direction(angle + PI / 2.0), -Vector3::y()]);
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        Isometry3::from_parts(
            Translation3::from(self.centre + self.radius * direction(angle)),
            rotation,
        )
    }
}

/// The needle as a hand leads it: its tip at the entry, and from there about a centre.
pub(super) struct Led {
    /// With the tip at the entry.
    pub(super) entry: Isometry3<f64>,
    /// Direction of the tip there.
    pub(super) tangent: Vector3<f64>,
    /// What it is turned about.
    centre: Vector3<f64>,
}

impl Led {
    pub(super) fn by(manner: &Manner, place: &Place) -> Self {
        let circle = Circle::through(place, manner.bites_m);
        let [x, z] = manner.centre_m;
        let flatter = about(
            circle.centre + circle.radius * direction(circle.a()),
            manner.flatter_rad,
        );
        Self {
            entry: flatter * circle.grasp(circle.with_tip_at_a()),
            tangent: flatter * circle.tangent_at_a(),
            centre: circle.centre + Vector3::new(x, 0.0, z),
        }
    }

    /// Turned by `angle` from the entry.
    pub(super) fn turned(&self, angle: f64) -> Isometry3<f64> {
        about(self.centre, angle) * self.entry
    }

    pub(super) fn turn(&self, angle: f64) -> Motion {
        Motion::Turn {
            centre_m: single(self.centre),
            axis: [0.0, -1.0, 0.0],
            angle_rad: angle as f32,
        }
    }
}

/// A turn about a point in the needle's plane, from x towards z.
fn about(point: Vector3<f64>, angle: f64) -> Isometry3<f64> {
    let turn = Translation3::from(point) * UnitQuaternion::from_axis_angle(&-Vector3::y_axis(), angle);
    turn * Translation3::from(-point)
}

fn direction(angle: f64) -> Vector3<f64> {
    Vector3::new(angle.cos(), 0.0, angle.sin())
}

#[cfg(test)]
mod tests {
    use super::super::TURN;
    use super::super::tests::PLACE;
    use super::*;

    /// The tip of a needle held at `pose`, from the arc's definition alone.
    fn tip(pose: &Isometry3<f64>) -> Vector3<f64> {
        let angle = PLACE.ahead_m / PLACE.radius_m;
        let arm = Vector3::new(angle.cos() - 1.0, angle.sin(), 0.0) * PLACE.radius_m;
        pose.translation.vector + pose.rotation * arm
    }

    #[test]
    fn the_nominal_circle_takes_the_tip_from_site_to_site() {
        let circle = Circle::through(&PLACE, [0.0; 2]);
        let entry = circle.with_tip_at_a();
        assert!((tip(&circle.grasp(entry)) - Vector3::new(-0.006, 0.0, 0.0)).norm() < 1e-12);
        // Both sites lie on the circle, so the tip is at the right one after the chord's angle 2·asin(d/R).
        let chord = 2.0 * (PLACE.half_m / PLACE.radius_m).asin();
        assert!((tip(&circle.grasp(entry + chord)) - Vector3::new(0.006, 0.0, 0.0)).norm() < 1e-12);
        // It goes down on the left: below the skin on the way.
        assert!(tip(&circle.grasp(entry + chord / 2.0)).z < -0.002);
    }

    #[test]
    fn turning_about_the_scripts_axis_advances_the_needle() {
        let circle = Circle::through(&PLACE, [0.0; 2]);
        let led = Led::by(&Manner::SCRIPT, &PLACE);
        let Motion::Turn { centre_m, axis, .. } = led.turn(TURN) else {
            panic!("a turn")
        };
        let on = circle.grasp(circle.with_tip_at_a() + 0.7);
        assert!((led.turned(0.7).to_homogeneous() - on.to_homogeneous()).abs().max() < 1e-12);
        let rotation = Rotation3::new(Vector3::from(axis).map(f64::from) * 0.3);
        let turned = circle.centre + rotation * (circle.grasp(1.0).translation.vector - circle.centre);
        assert!((turned - circle.grasp(1.3).translation.vector).norm() < 1e-8);
        assert!((Vector3::from(centre_m).map(f64::from) - circle.centre).norm() < 1e-8);
    }

    /// A person's tip begins at the entry of that person's bite and, turned about the circle's own centre, comes out at the exit, however the needle
    /// is held; it is held flatter by as much as it should be.
    #[test]
    fn a_person_goes_from_bite_to_bite() {
        let manner = Manner {
            flatter_rad: 0.2,
            bites_m: [-0.5e-3, -1.0e-3],
            ..Manner::SCRIPT
        };
        let led = Led::by(&manner, &PLACE);
        assert!((tip(&led.entry) - Vector3::new(-0.0055, 0.0, 0.0)).norm() < 1e-12);
        // Half their distance is 5.25 mm: the chord's angle is 2·asin(5.25/R), the tangent as far below the skin as half of it, less the tilt.
        let half = (0.005_25 / PLACE.radius_m).asin();
        assert!((tip(&led.turned(2.0 * half)) - Vector3::new(0.005, 0.0, 0.0)).norm() < 1e-12);
        assert!((led.tangent.z.asin() + half - 0.2).abs() < 1e-12);
        // Off by 1 mm and 2 mm, the centre of the turn is where it is asked to be: above the middle of both bites.
        let off = Led::by(
            &Manner {
                centre_m: [1e-3, 2e-3],
                ..manner
            },
            &PLACE,
        );
        let above = PLACE.radius_m * half.cos();
        assert!((off.centre - Vector3::new(-0.000_25 + 1e-3, 0.0, above + 2e-3)).norm() < 1e-12);
        // A needle that is held at a third bridges 2 · 6.304 mm and no more.
        let wide = Circle::through(&PLACE, [1e-3; 2]);
        assert!((wide.half - 6.304e-3).abs() < 1e-6, "{}", wide.half);
    }
}
