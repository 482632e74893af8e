//! What the simulated hand does: from speeds to the script of one stitch, or of a push with a ball tip.
//!
//! Patch frame: x across the wound from left to right, y along it, z outward. The needle's arc lies in its xy-plane, its centre is o, and the
//! grasp is o + R x̂, where the driver holds it: the tip is as far ahead as the arc between them. Sewing from left to
//! right the needle's ẑ is −ŷ of the patch, and ψ, the angle of the grasp from x towards z, grows as the needle advances:
//! grasp(ψ) = o + R (cos ψ, 0, sin ψ). The nominal circle passes both punctures: o = (0, 0, √(R² − d²)), d half their distance.

use std::f64::consts::PI;

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use sutura_shared::scene::{Hand, Motion, Pose, STEPS_MAX, Site, Stage, Step, Until};

use super::plan;

/// Height of the start above the skin [m].
const START: f64 = 0.040;
/// Height of the start over the thread's length: above 2/π the thread hangs from the needle in less than a half circle, clear of the skin.
const HANGING: f64 = 0.75;
/// Gap between tip and skin before the insertion [m].
const SHORT: f64 = 0.003;
/// Longest push on the skin, the hand's own give included [m].
const PUSH: f64 = 0.016;
/// Arc by which the tip is beyond the entry when the turn begins [m].
const BEYOND: f64 = 0.004;
/// More than the needle ever has to turn [rad].
const TURN: f64 = 320.0 * PI / 180.0;
/// Way of the hand beyond the place where an unstretched thread is taut [m].
const BEYOND_TAUT: f64 = 0.025;
/// Further way for tightening [m].
const TIGHTEN: f64 = 0.020;
/// Way back from there after the knot [m].
const LOOSE: f64 = 0.015;

impl Operator {
    /// The hand and its script for one place.
    #[must_use]
    pub fn hand(&self, hand: plan::Hand, place: &Place) -> Hand {
        let (start, steps) = match self {
            Self::Sew(sew) => sew.script(place),
            Self::Touch(touch) => touch.script(place),
        };
        Hand {
            mass_kg: hand.mass_kg,
            damping_n_s_per_m: hand.damping_n_s_per_m,
            stiffness_n_per_m: hand.stiffness_n_per_m,
            start: record(&start),
            steps,
        }
    }
}

impl Sew {
    /// Start pose and steps of one stitch.
    fn script(&self, place: &Place) -> (Isometry3<f64>, Steps) {
        let circle = Circle::through(place);
        let entry = circle.with_tip_at_a();
        let tangent = circle.tangent_at_a();
        let short = shifted(&circle.grasp(entry), -SHORT * tangent);
        let start = shifted(&short, Vector3::z() * START.max(HANGING * place.thread_m));
        let driven = circle.grasp(entry + BEYOND / circle.radius);
        let out = circle.grasp(entry + TURN);
        let turn = |speed: f64, until| step(circle.turn(TURN), TURN / speed, until);
        let mut steps: Steps = [
            line(&start, &short, self.approach_m_per_s, Until::Elapsed),
            steady(
                &short,
                &shifted(&short, tangent * PUSH),
                self.insert_m_per_s,
                Until::Punctured(Site::A),
            ),
            step(Motion::Line { to: record(&driven) }, 0.4, Until::Elapsed),
            turn(self.drive_rad_per_s, Until::Stage(Stage::Exit)),
            turn(self.exit_rad_per_s, Until::Punctured(Site::D)),
            turn(self.drive_rad_per_s, Until::Stage(Stage::PullThrough)),
        ]
        .into_iter()
        .collect();
        match &self.draw {
            Some(draw) => steps.extend(draw.script(&out, place)),
            None => steps.extend([step(Motion::Hold, 1.0, Until::Elapsed)]),
        }
        (start, steps)
    }
}

impl Draw {
    /// Steps from the needle's exit, at `out`, to the knot.
    fn script(&self, out: &Isometry3<f64>, place: &Place) -> [Step; 6] {
        // The thread goes taut at about its own length from the exit, less the way between the punctures.
        let away = Vector3::new(-0.6, 0.0, 0.8);
        let exit = Vector3::new(place.half_m, 0.0, place.skin_m[1]);
        let at = |beyond: f64| {
            let way = place.thread_m - 2.0 * place.half_m + beyond;
            Isometry3::from_parts(Translation3::from(exit + away * way), out.rotation)
        };
        let (taut, loose) = (at(0.0), at(-LOOSE));
        [
            steady(out, &at(BEYOND_TAUT), self.pull_m_per_s, Until::Stage(Stage::Tension)),
            steady(
                &taut,
                &at(BEYOND_TAUT + TIGHTEN),
                self.tighten_m_per_s,
                Until::Tension(self.tension_n as f32),
            ),
            step(Motion::Hold, 0.4, Until::Elapsed),
            Step {
                button: true,
                ..step(Motion::Hold, 0.3, Until::Elapsed)
            },
            step(Motion::Line { to: record(&loose) }, 0.6, Until::Elapsed),
            step(Motion::Hold, 1.0, Until::Elapsed),
        ]
    }
}

impl Touch {
    /// Start pose and steps of push, drag and release.
    fn script(&self, place: &Place) -> (Isometry3<f64>, Steps) {
        let at = |x: f64, z: f64| Isometry3::translation(x, 0.0, place.skin_m[0] + place.radius_m + z);
        let (start, above) = (at(0.0, START), at(0.0, SHORT));
        let (pushed, dragged) = (at(0.0, -self.push_m), at(self.drag_m, -self.push_m));
        let steps = [
            line(&start, &above, self.approach_m_per_s, Until::Elapsed),
            steady(&above, &pushed, self.push_m_per_s, Until::Elapsed),
            step(Motion::Hold, 0.5, Until::Elapsed),
            line(&pushed, &dragged, self.push_m_per_s, Until::Elapsed),
            step(Motion::Hold, 0.5, Until::Elapsed),
            line(&dragged, &at(self.drag_m, START), self.approach_m_per_s, Until::Elapsed),
            step(Motion::Hold, 1.5, Until::Elapsed),
        ];
        (start, steps.into_iter().collect())
    }
}

/// The device's frame in the patch frame: x across, y up, z to the user, its origin amid the places the hand visits.
#[must_use]
pub fn patch_from_device(hand: &Hand) -> Pose {
    let visited = hand.steps.iter().filter_map(|step| match step.motion {
        Motion::Line { to } | Motion::Steady { to, .. } => Some(to.position_m),
        Motion::Turn { .. } | Motion::Hold => None,
    });
    let (low, high) = visited.fold((hand.start.position_m, hand.start.position_m), |(low, high), at| {
        (
            std::array::from_fn(|i| low[i].min(at[i])),
            std::array::from_fn(|i| high[i].max(at[i])),
        )
    });
    let half = std::f32::consts::FRAC_1_SQRT_2;
    Pose {
        position_m: std::array::from_fn(|i| (low[i] + high[i]) / 2.0),
        quaternion: [half, half, 0.0, 0.0],
    }
}

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
    fn through(place: &Place) -> Self {
        let height = (place.radius_m * place.radius_m - place.half_m * place.half_m)
            .max(0.0)
            .sqrt();
        let skin = (place.skin_m[0] + place.skin_m[1]) / 2.0;
        Self {
            centre: Vector3::new(0.0, 0.0, skin + height),
            radius: place.radius_m,
            tip: place.ahead_m / place.radius_m,
            half: place.half_m,
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

    fn turn(&self, angle: f64) -> Motion {
        Motion::Turn {
            centre_m: single(self.centre),
            axis: [0.0, -1.0, 0.0],
            angle_rad: angle as f32,
        }
    }
}

fn direction(angle: f64) -> Vector3<f64> {
    Vector3::new(angle.cos(), 0.0, angle.sin())
}

fn shifted(pose: &Isometry3<f64>, by: Vector3<f64>) -> Isometry3<f64> {
    Translation3::from(by) * pose
}

/// A path at a mean speed [m/s].
fn line(from: &Isometry3<f64>, to: &Isometry3<f64>, speed: f64, until: Until) -> Step {
    step(Motion::Line { to: record(to) }, distance(from, to) / speed, until)
}

/// A path at a constant speed [m/s]; twice its time, for the hand may begin it elsewhere.
fn steady(from: &Isometry3<f64>, to: &Isometry3<f64>, speed: f64, until: Until) -> Step {
    let motion = Motion::Steady {
        to: record(to),
        speed_m_per_s: speed as f32,
    };
    step(motion, 2.0 * distance(from, to) / speed, until)
}

fn distance(from: &Isometry3<f64>, to: &Isometry3<f64>) -> f64 {
    (to.translation.vector - from.translation.vector).norm()
}

fn step(motion: Motion, seconds: f64, until: Until) -> Step {
    Step {
        motion,
        ticks: (seconds * 1e3).ceil().max(1.0) as u32,
        until,
        button: false,
    }
}

fn record(pose: &Isometry3<f64>) -> Pose {
    let q = pose.rotation.quaternion();
    Pose {
        position_m: single(pose.translation.vector),
        quaternion: [q.w, q.i, q.j, q.k].map(|part| part as f32),
    }
}

fn single(v: Vector3<f64>) -> [f32; 3] {
    v.map(|part| part as f32).into()
}

type Steps = heapless::Vec<Step, STEPS_MAX>;

/// Where the hand works, in the patch frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Height of the skin at the punctures a and d, or twice at the middle [m].
    pub skin_m: [f64; 2],
    /// Half the distance of the punctures [m].
    pub half_m: f64,
    /// Radius of the needle's arc, or of the ball [m].
    pub radius_m: f64,
    /// Arc length from the grasp to the needle's tip [m]; 0 for a ball.
    pub ahead_m: f64,
    /// Length of the thread [m]; 0 without one.
    pub thread_m: f64,
}

/// What the hand does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operator {
    /// One stitch with a needle.
    Sew(Sew),
    /// Push, drag and release with a ball tip.
    Touch(Touch),
}

/// How one stitch is sewn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sew {
    /// Mean speed through the air [m/s].
    pub approach_m_per_s: f64,
    /// Speed of the tip against the skin [m/s].
    pub insert_m_per_s: f64,
    /// Turn of the needle in the tissue [rad/s].
    pub drive_rad_per_s: f64,
    /// Turn of the needle while it comes out [rad/s].
    pub exit_rad_per_s: f64,
    /// How the thread is drawn and tied; nothing without one.
    pub draw: Option<Draw>,
}

/// How a thread is drawn through the tissue and tied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// Speed while the thread is slack [m/s].
    pub pull_m_per_s: f64,
    /// Speed while the thread is taut [m/s].
    pub tighten_m_per_s: f64,
    /// Tension at which the knot is laid [N].
    pub tension_n: f64,
}

/// How the tissue is touched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Mean speed through the air [m/s].
    pub approach_m_per_s: f64,
    /// Speed in contact [m/s].
    pub push_m_per_s: f64,
    /// How deep [m].
    pub push_m: f64,
    /// How far sideways [m].
    pub drag_m: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEW: Sew = Sew {
        approach_m_per_s: 0.04,
        insert_m_per_s: 0.008,
        drive_rad_per_s: 1.3,
        exit_rad_per_s: 0.35,
        draw: Some(Draw {
            pull_m_per_s: 0.07,
            tighten_m_per_s: 0.012,
            tension_n: 1.0,
        }),
    };
    const PLACE: Place = Place {
        skin_m: [0.0; 2],
        half_m: 0.006,
        radius_m: 0.026 / PI,
        ahead_m: 2.0 / 3.0 * 0.026,
        thread_m: 0.115,
    };

    /// The tip of a needle held at `pose`, from the arc's definition alone.
    fn tip(pose: &Isometry3<f64>) -> Vector3<f64> {
        let angle = PLACE.ahead_m / PLACE.radius_m;
        let arm = Vector3::new(angle.cos() - 1.0, angle.sin(), 0.0) * PLACE.radius_m;
        pose.translation.vector + pose.rotation * arm
    }

    #[test]
    fn the_nominal_circle_takes_the_tip_from_site_to_site() {
        let circle = Circle::through(&PLACE);
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
        let circle = Circle::through(&PLACE);
        let Motion::Turn { centre_m, axis, .. } = circle.turn(TURN) else {
            panic!("a turn")
        };
        let rotation = Rotation3::new(Vector3::from(axis).map(f64::from) * 0.3);
        let turned = circle.centre + rotation * (circle.grasp(1.0).translation.vector - circle.centre);
        assert!((turned - circle.grasp(1.3).translation.vector).norm() < 1e-8);
        assert!((Vector3::from(centre_m).map(f64::from) - circle.centre).norm() < 1e-8);
    }

    #[test]
    fn the_device_reaches_every_place_of_the_script() {
        let operator = Operator::Sew(SEW);
        let hand = operator.hand(
            plan::Hand {
                mass_kg: 0.2,
                damping_n_s_per_m: 8.0,
                stiffness_n_per_m: 400.0,
            },
            &PLACE,
        );
        let origin = patch_from_device(&hand).position_m;
        for step in &hand.steps {
            if let Motion::Line { to } | Motion::Steady { to, .. } = step.motion {
                // Premium 1.5: 381 × 267 × 191 mm, x, y up, z to the user.
                assert!((to.position_m[0] - origin[0]).abs() < 0.19 && (to.position_m[2] - origin[2]).abs() < 0.133);
            }
        }
    }
}
