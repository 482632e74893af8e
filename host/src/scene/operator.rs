//! What the simulated hand does: from speeds to the script of a row of stitches, or of a push with a ball tip.
//!
//! Patch frame: x across the wound from left to right, y along it, z outward.

mod circle;

use std::f64::consts::PI;

use nalgebra::{Isometry3, Translation3, Vector3};
use sutura_shared::scene::{Hand, Motion, Pose, STEPS_MAX, Site, Stage, Step, Tremor, Until};

use self::circle::Led;
use super::plan;
use super::skill::Manner;

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
    /// The hand and its script, for one place a stitch.
    #[must_use]
    pub fn hand(&self, hand: plan::Hand, places: &[Place]) -> Hand {
        let (start, steps) = match self {
            Self::Sew(sew) => sew.script(places),
            Self::Touch(touch) => touch.script(places),
        };
        Hand {
            mass_kg: hand.mass_kg,
            damping_n_s_per_m: hand.damping_n_s_per_m,
            stiffness_n_per_m: hand.stiffness_n_per_m,
            tremor: self.tremor(),
            start: record(&start),
            steps,
        }
    }

    const fn tremor(&self) -> Option<Tremor> {
        match self {
            Self::Sew(sew) => sew.manner.tremor,
            Self::Touch(_) => None,
        }
    }
}

impl Sew {
    /// Start pose and steps of one stitch after the other.
    fn script(&self, places: &[Place]) -> (Isometry3<f64>, Steps) {
        let mut steps = Steps::new();
        let mut begin = None;
        for (stitch, place) in places.iter().enumerate() {
            let led = Led::by(&self.manner, place);
            let short = shifted(&led.entry, -SHORT * led.tangent);
            let start = shifted(&short, Vector3::z() * START.max(HANGING * left(places, stitch)));
            if begin.is_some() {
                // From where the thread was drawn to.
                let (way, speed) = (left(places, stitch), self.approach_m_per_s * self.manner.pace);
                steps.extend([step(Motion::Line { to: record(&start) }, way / speed, Until::Elapsed)]);
            }
            begin.get_or_insert(start);
            steps.extend(self.drive(&led, [&start, &short], place));
            let last = stitch + 1 == places.len();
            match &self.draw {
                Some(draw) => steps.extend(draw.by(&self.manner).script((&led.turned(TURN), stitch, last), places)),
                None => steps.extend([step(Motion::Hold, 1.0, Until::Elapsed)]),
            }
        }
        (begin.unwrap_or_default(), steps)
    }

    /// Steps from above the entry to the needle's exit.
    fn drive(&self, led: &Led, [start, short]: [&Isometry3<f64>; 2], place: &Place) -> [Step; 6] {
        let pace = self.manner.pace;
        let driven = led.turned(BEYOND / place.radius_m);
        let turn = |speed: f64, until| step(led.turn(TURN), TURN / (speed * pace), until);
        [
            line(start, short, self.approach_m_per_s * pace, Until::Elapsed),
            steady(
                short,
                &shifted(short, led.tangent * PUSH),
                self.insert_m_per_s * pace,
                Until::Punctured(Site::A),
            ),
            step(Motion::Line { to: record(&driven) }, 0.4, Until::Elapsed),
            turn(self.drive_rad_per_s, Until::Stage(Stage::Exit)),
            turn(self.exit_rad_per_s, Until::Punctured(Site::D)),
            turn(self.drive_rad_per_s, Until::Stage(Stage::PullThrough)),
        ]
    }
}

impl Draw {
    /// The same as a person draws, whose pace and pull are over these.
    fn by(&self, &Manner { pace, pull, .. }: &Manner) -> Self {
        Self {
            pull_m_per_s: self.pull_m_per_s * pace,
            tighten_m_per_s: self.tighten_m_per_s * pace,
            tension_n: self.tension_n * pull,
        }
    }

    /// Steps from the needle's exit, at `out`, until the thread of `stitch` is tight; after the `last` one to the knot.
    fn script(&self, (out, stitch, last): (&Isometry3<f64>, usize, bool), places: &[Place]) -> Vec<Step> {
        let Some(place) = places.get(stitch) else {
            return Vec::new();
        };
        // The thread goes taut about as far from the exit as there is thread left.
        let away = Vector3::new(-0.6, 0.0, 0.8);
        let exit = Vector3::new(place.half_m, place.y_m, place.skin_m[1]);
        let at = |beyond: f64| {
            let way = left(places, stitch) - 2.0 * place.half_m + beyond;
            Isometry3::from_parts(Translation3::from(exit + away * way), out.rotation)
        };
        let (taut, loose) = (at(0.0), at(-LOOSE));
        let mut steps = vec![
            steady(out, &at(BEYOND_TAUT), self.pull_m_per_s, Until::Stage(Stage::Tension)),
            steady(
                &taut,
                // Every stitch that closes gives thread back.
                &at(BEYOND_TAUT + TIGHTEN * (stitch + 1) as f64),
                self.tighten_m_per_s,
                Until::Tension(self.tension_n as f32),
            ),
            step(Motion::Hold, 0.4, Until::Elapsed),
        ];
        if last {
            steps.extend([
                Step {
                    button: true,
                    ..step(Motion::Hold, 0.3, Until::Elapsed)
                },
                step(Motion::Line { to: record(&loose) }, 0.6, Until::Elapsed),
                step(Motion::Hold, 1.0, Until::Elapsed),
            ]);
        }
        steps
    }
}

/// Thread that is left when a stitch begins: the earlier ones have taken the way from each entry through its exit to the next entry [m].
fn left(places: &[Place], stitch: usize) -> f64 {
    let from_to = places.iter().zip(places.iter().skip(1)).take(stitch);
    let taken = from_to.map(|(from, to)| 2.0 * from.half_m + (from.half_m + to.half_m).hypot(to.y_m - from.y_m));
    places.first().map_or(0.0, |place| place.thread_m) - taken.sum::<f64>()
}

/// Whether the thread is long enough for every stitch but the first to begin without pulling on the one before.
#[must_use]
pub fn leaves_enough(places: &[Place]) -> bool {
    (1..places.len()).all(|stitch| left(places, stitch) * HANGING >= START)
}

impl Touch {
    /// Start pose and steps of push, drag and release.
    fn script(&self, places: &[Place]) -> (Isometry3<f64>, Steps) {
        let place = places.first().copied().unwrap_or_default();
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
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Where along the wound [m].
    pub y_m: f64,
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
    /// What the hand does otherwise.
    pub manner: Manner,
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
        manner: Manner::SCRIPT,
    };
    pub(super) const PLACE: Place = Place {
        y_m: 0.0,
        skin_m: [0.0; 2],
        half_m: 0.006,
        radius_m: 0.026 / PI,
        ahead_m: 2.0 / 3.0 * 0.026,
        thread_m: 0.115,
    };

    #[test]
    fn the_device_reaches_every_place_of_the_script() {
        let operator = Operator::Sew(SEW);
        let hand = operator.hand(
            plan::Hand {
                mass_kg: 0.2,
                damping_n_s_per_m: 8.0,
                stiffness_n_per_m: 400.0,
            },
            &[PLACE],
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
