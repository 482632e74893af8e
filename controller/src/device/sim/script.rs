//! The script of a simulated hand: one step after the other, each from the pose where the step before it ended.

use crate::math::{DT, Vec3, length, rotation, sqrt};
use crate::record::Output;
use nalgebra::Vector4;
use sutura_shared::scene::{Motion, Pose, Step, Until};

/// Time for which a hand must feel a tension before it believes it [ticks].
const FELT: u32 = 20;

/// Where the script stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Index of the step under way; the number of steps when all are done.
    pub step: u32,
    /// Ticks since the step began.
    pub elapsed: u32,
    /// Sites of the stitch passed so far, a bit each.
    pub punctured: u32,
    /// Number of the stitch.
    pub stitch: u8,
    /// Ticks that the thread's tension has been as the step waits for, without a break.
    pub felt: u32,
    /// Where the step began, patch frame.
    pub from: Pose,
    /// Where the hand should be now, patch frame.
    pub target: Pose,
}

impl State {
    /// Before the first step, at `start`.
    #[must_use]
    pub const fn new(start: Pose) -> Self {
        Self {
            step: 0,
            elapsed: 0,
            punctured: 0,
            stitch: 1,
            felt: 0,
            from: start,
            target: start,
        }
    }
}

/// The step under way.
#[must_use]
pub fn current<'a>(steps: &'a [Step], state: &State) -> Option<&'a Step> {
    steps.get(state.step as usize)
}

/// Advances the script by one tick, which `seen` has just answered.
pub fn advance(steps: &[Step], state: &mut State, seen: &Output) {
    if state.stitch != seen.stitch {
        (state.stitch, state.punctured) = (seen.stitch, 0);
    }
    if let Some(puncture) = seen.puncture {
        state.punctured |= 1 << puncture.site as u32;
    }
    if let Some(step) = current(steps, state) {
        let enough = matches!(step.until, Until::Tension(tension) if seen.thread >= tension);
        state.felt = if enough { state.felt + 1 } else { 0 };
    }
    if let Some(step) = current(steps, state)
        && ends(step, state, seen)
    {
        state.step += 1;
        state.elapsed = 0;
        state.felt = 0;
        state.from = state.target;
    }
    if let Some(step) = current(steps, state) {
        state.elapsed += 1;
        state.target = along(step, &state.from, state.elapsed);
    }
}

fn ends(step: &Step, state: &State, seen: &Output) -> bool {
    state.elapsed >= step.ticks.max(1)
        || match step.until {
            Until::Elapsed => false,
            Until::Punctured(site) => state.punctured & (1 << site as u32) != 0,
            Until::Tension(_) => state.felt >= FELT,
            Until::Stage(stage) => seen.stage >= stage,
        }
}

/// The pose after `elapsed` ticks of `step`.
fn along(step: &Step, from: &Pose, elapsed: u32) -> Pose {
    let ticks = step.ticks.max(1);
    let t = elapsed.min(ticks) as f32 / ticks as f32;
    match &step.motion {
        // Flash & Hogan 1985: the path of least jerk between two rests.
        Motion::Line { to } => between(from, to, t * t * t * (10.0 + t * (6.0 * t - 15.0))),
        Motion::Steady { to, speed_m_per_s } => {
            let way = length(Vec3::from(to.position_m) - Vec3::from(from.position_m));
            let gone = speed_m_per_s * DT * elapsed as f32;
            between(from, to, if gone < way { gone / way } else { 1.0 })
        }
        Motion::Turn {
            centre_m,
            axis,
            angle_rad,
        } => turned(from, *centre_m, *axis, angle_rad * t),
        Motion::Hold => *from,
    }
}

fn between(from: &Pose, to: &Pose, s: f32) -> Pose {
    let mut position_m = from.position_m;
    for (x, end) in position_m.iter_mut().zip(to.position_m) {
        *x += (end - *x) * s;
    }
    Pose {
        position_m,
        quaternion: arc(from.quaternion.into(), to.quaternion.into(), s),
    }
}

/// The orientation `s` of the way along the shortest arc from `a` to `b` (Shoemake 1985).
fn arc(a: Vector4<f32>, b: Vector4<f32>, s: f32) -> [f32; 4] {
    // Below this the arc and its chord are the same number.
    const CHORD: f32 = 1e-4;
    // A quaternion and its opposite are one orientation; the nearer gives the shorter arc.
    let near = if a.dot(&b) < 0.0 { -b } else { b };
    let across = near - a * a.dot(&near);
    let sin = sqrt(across.dot(&across));
    if sin < CHORD {
        return unit(a + (near - a) * s);
    }
    let angle = libm::atan2f(sin, a.dot(&near));
    let (rise, run) = libm::sincosf(angle * s);
    unit(a * run + across * (rise / sin))
}

fn turned(from: &Pose, centre: [f32; 3], axis: [f32; 3], angle: f32) -> Pose {
    let (centre, axis) = (Vec3::from(centre), Vec3::from(axis));
    let arm = Vec3::from(from.position_m) - centre;
    let (sin, cos) = libm::sincosf(angle / 2.0);
    let [w, x, y, z] = from.quaternion;
    let (vector, turn) = (Vec3::new(x, y, z), axis * sin);
    let product = vector * cos + turn * w + turn.cross(&vector);
    Pose {
        position_m: (centre + rotation(axis, angle) * arm).into(),
        quaternion: unit(Vector4::new(
            cos * w - turn.dot(&vector),
            product.x,
            product.y,
            product.z,
        )),
    }
}

fn unit(q: Vector4<f32>) -> [f32; 4] {
    (q / sqrt(q.dot(&q))).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::length;
    use crate::record::Puncture;
    use sutura_shared::scene::{Site, Stage};

    fn quiet() -> Output {
        Output {
            tick: 1,
            ..Output::idle()
        }
    }

    fn pose(x: f32, about_z: f32) -> Pose {
        let (sin, cos) = libm::sincosf(about_z / 2.0);
        Pose {
            position_m: [x, 0.0, 0.0],
            quaternion: [cos, 0.0, 0.0, sin],
        }
    }

    fn step(motion: Motion, ticks: u32, until: Until) -> Step {
        Step {
            motion,
            ticks,
            until,
            button: false,
        }
    }

    /// Targets of every tick, `seen` being answered at each.
    fn run(steps: &[Step], ticks: usize, seen: impl Fn(usize) -> Output) -> std::vec::Vec<State> {
        let mut state = State::new(pose(0.0, 0.0));
        (0..ticks)
            .map(|tick| {
                advance(steps, &mut state, &seen(tick));
                state
            })
            .collect()
    }

    #[test]
    fn a_line_has_the_peak_speed_of_least_jerk() {
        // x = d (10 s³ − 15 s⁴ + 6 s⁵): half way at half time, peak speed 1.875 d/T, rest at both ends.
        let states = run(
            &[step(Motion::Line { to: pose(0.1, 1.0) }, 1000, Until::Elapsed)],
            1100,
            |_| quiet(),
        );
        let x = |tick: usize| states[tick].target.position_m[0];
        assert!((x(499) - 0.05).abs() < 1e-7);
        let peak = (1..1000).map(|i| x(i) - x(i - 1)).fold(0.0, f32::max);
        assert!((peak * 1000.0 - 0.1875).abs() < 2e-4, "{peak}");
        assert!(x(0) < 1e-8 && (x(1050) - 0.1).abs() < 1e-8);
        let half = pose(0.0, 0.5).quaternion;
        for (a, b) in states[499].target.quaternion.iter().zip(half) {
            assert!((a - b).abs() < 1e-6);
        }
    }

    #[test]
    fn steady_is_steady_and_takes_the_shorter_way_round() {
        let mut to = pose(0.1, 1.0);
        to.quaternion = to.quaternion.map(|x| -x);
        // 0.1 m at 1 m/s: 100 ticks.
        let motion = Motion::Steady { to, speed_m_per_s: 1.0 };
        let states = run(&[step(motion, 100, Until::Elapsed)], 100, |_| quiet());
        for (i, state) in states.iter().enumerate() {
            let part = (i + 1) as f32 / 100.0;
            assert!((state.target.position_m[0] - 0.1 * part).abs() < 1e-7);
            for (a, b) in state.target.quaternion.iter().zip(pose(0.0, part).quaternion) {
                assert!((a - b).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn a_turn_keeps_its_distance_and_turns_the_pose_with_it() {
        let motion = Motion::Turn {
            centre_m: [0.0, 0.02, 0.01],
            axis: [0.0, 0.6, 0.8],
            angle_rad: 2.5,
        };
        let states = run(&[step(motion, 250, Until::Elapsed)], 250, |_| quiet());
        let centre = Vec3::new(0.0, 0.02, 0.01);
        let arm = -centre;
        for (i, state) in states.iter().enumerate() {
            let turn = rotation(Vec3::new(0.0, 0.6, 0.8), 0.01 * (i + 1) as f32);
            let at = Vec3::from(state.target.position_m);
            assert!(length(at - centre - turn * arm) < 1e-7);
            let frame = crate::math::Pose::from(state.target);
            assert!((frame.rotation - turn).abs().max() < 2e-6);
        }
    }

    #[test]
    fn an_event_ends_a_step_where_it_stands() {
        let waits = [
            Until::Punctured(Site::D),
            Until::Tension(0.5),
            Until::Stage(Stage::Drive),
        ];
        for until in waits {
            let steps = [
                step(
                    Motion::Steady {
                        to: pose(0.1, 0.0),
                        speed_m_per_s: 0.1,
                    },
                    1000,
                    until,
                ),
                step(Motion::Hold, 10, Until::Elapsed),
            ];
            let states = run(&steps, 700, |tick| {
                let mut seen = quiet();
                if (401 - FELT as usize..=400).contains(&tick) {
                    seen.thread = 0.6;
                }
                if tick == 400 {
                    seen.stage = Stage::Exit;
                    let puncture = Puncture {
                        site: Site::D,
                        force: 1.0,
                        f0: 1.0,
                        depth: 0.0,
                    };
                    seen.puncture = Some(puncture);
                }
                seen
            });
            assert_eq!((states[399].step, states[400].step), (0, 1));
            assert!((states[690].target.position_m[0] - 0.04).abs() < 1e-7, "{until:?}");
            assert_eq!(states[690].step, 2);
        }
    }

    #[test]
    fn a_puncture_of_the_other_site_is_not_waited_for() {
        let steps = [step(Motion::Hold, 1000, Until::Punctured(Site::D))];
        let states = run(&steps, 10, |_| {
            let puncture = Puncture {
                site: Site::A,
                force: 1.0,
                f0: 1.0,
                depth: 0.0,
            };
            Output {
                puncture: Some(puncture),
                ..quiet()
            }
        });
        assert_eq!(states[9].step, 0);
    }
}
