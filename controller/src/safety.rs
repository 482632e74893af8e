//! The output edge: the only place that makes a force a device may receive.
//!
//! In order: finite → slew → passivity damping → saturation → gate. The declared scale c goes before all of them.
//!
//! Passivity (Hannaford & Ryu 2002) with F the force on the hand and x the tip: the observer E = −Σ F[n−1]·(x[n] − x[n−1])
//! takes the force that was really sent; while E ≥ 0 the rendering has only absorbed. When E < 0, a damping force −α v with
//! α = −E / (T |v|²), capped, takes the excess back.

use crate::event::{Fault, Faults};
use crate::math::{DT, Vec3, finite, length};
use sutura_shared::scene::{self, Effect, Effects, Profile};

/// A force that went through the output edge, device frame [N]. Zero by default.
///
/// Nothing outside this module can make another one:
///
/// ```compile_fail,E0423
/// use sutura_controller::{math::Vec3, safety::LimitedForce};
/// let forged = LimitedForce(Vec3::new(100.0, 0.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LimitedForce(Vec3);

impl LimitedForce {
    /// The force [N].
    #[must_use]
    pub const fn get(self) -> Vec3 {
        self.0
    }
}

/// What a device can give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest force [N].
    pub max: f32,
    /// Force it can hold for longer than about a second [N]; stated for the user, not applied.
    pub continuous: f32,
}

/// Limits from the makers' data sheets.
#[must_use]
pub const fn limits(profile: Profile) -> Limits {
    let (max, continuous) = match profile {
        Profile::Premium15 => (8.5, 1.4),
        Profile::Premium30 => (22.0, 3.0),
        Profile::Touch => (3.3, 0.88),
        Profile::Desktop => (7.9, 1.75),
    };
    Limits { max, continuous }
}

/// What does not change during a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Rendered over simulated force c.
    pub scale: f32,
    /// Largest change a tick [N].
    pub slew: f32,
    /// Cap of the passivity damping α [N·s/m]; nothing is observed or damped without effect `passivity`.
    pub damping: Option<f32>,
    /// Largest force [N].
    pub max: f32,
}

impl Params {
    /// The edge of a scene.
    #[must_use]
    pub const fn new(output: &scene::Output, profile: Profile, effects: Effects) -> Self {
        Self {
            scale: output.scale,
            slew: output.slew_n,
            damping: match effects.has(Effect::Passivity) {
                true => Some(output.passivity_n_s_per_m),
                false => None,
            },
            max: limits(profile).max,
        }
    }
}

/// What the edge remembers from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// The force the device holds [N].
    pub sent: Vec3,
    /// The same without passivity damping [N]: the slew starts from here, so that damping ends with its tick.
    pub undamped: Vec3,
    /// The tip at the last tick, device frame [m]; likewise.
    pub tip: Option<Vec3>,
    /// Energy the rendering has absorbed E [J]; observed with effect `passivity`.
    pub energy: f32,
}

/// Whether the run's state lets a force out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gate {
    /// Zero force.
    #[default]
    Closed,
    /// The limited force.
    Open,
}

/// One tick's inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs {
    /// Force on the hand as the scene says, device frame [N].
    pub simulated: Vec3,
    /// Tip from the encoders, device frame [m].
    pub tip: Vec3,
    /// What is already wrong; any fault means zero force.
    pub faults: Faults,
    /// Whether a force may go out.
    pub gate: Gate,
}

/// What went out, and why it differs from what came in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Record {
    /// Force on the hand for the device.
    pub force: LimitedForce,
    /// The faults that came in, and those found here.
    pub faults: Faults,
    /// Whether the slew limit held the force back.
    pub slewed: bool,
    /// Passivity damping α that acted [N·s/m].
    pub damping: f32,
    /// Whether the device's limit shortened the force.
    pub saturated: bool,
}

/// Takes one tick's force through the edge.
#[must_use]
pub fn limit(params: &Params, state: &mut State, inputs: &Inputs) -> Record {
    let damper = params.damping.map(|most| damper(most, state, inputs.tip));
    let wanted = inputs.simulated * params.scale;
    let faults = inputs
        .faults
        .with(Fault::Pose, !finite(inputs.tip))
        .with(Fault::Force, !finite(wanted));
    if !faults.none() || inputs.gate == Gate::Closed {
        (state.sent, state.undamped) = (Vec3::zeros(), Vec3::zeros());
        return Record {
            faults,
            ..Record::default()
        };
    }
    let (change, slewed) = shortened(wanted - state.undamped, params.slew);
    let steady = state.undamped + change;
    // Damping takes back what the rendering gave: without a force there is nothing to take, and a step of the encoders is no motion.
    let damped = damper.map_or(steady, |damper| steady - shortened(damper.against, length(steady)).0);
    let (sent, saturated) = shortened(damped, params.max);
    (state.sent, state.undamped) = (sent, shortened(steady, params.max).0);
    Record {
        force: LimitedForce(sent),
        faults,
        slewed,
        damping: damper.map_or(0.0, |damper| damper.damping),
        saturated,
    }
}

/// Passivity damping in one tick.
#[derive(Clone, Copy)]
struct Damper {
    /// α [N·s/m].
    damping: f32,
    /// α v, what it takes from the force [N].
    against: Vec3,
}

/// Observes the energy and damps with no more than `most` [N·s/m].
fn damper(most: f32, state: &mut State, tip: Vec3) -> Damper {
    let travel = observe(state, tip);
    let damping = damping(most, state.energy, travel);
    Damper {
        damping,
        against: travel * (damping / DT),
    }
}

/// Books the work of the force held since the last tick; gives the tip's way [m].
fn observe(state: &mut State, tip: Vec3) -> Vec3 {
    // 5 m/s: no arm does that; a jump of the encoders is not work.
    const JUMP: f32 = 5e-3;
    if !finite(tip) {
        return Vec3::zeros();
    }
    let way = tip - state.tip.unwrap_or(tip);
    state.tip = Some(tip);
    let (_, jumped) = shortened(way, JUMP);
    if jumped {
        return Vec3::zeros();
    }
    state.energy -= state.sent.dot(&way);
    way
}

/// α = −E / (T |v|²) up to `most`, with v = `travel` / T; nothing at rest, where damping takes nothing back.
fn damping(most: f32, energy: f32, travel: Vec3) -> f32 {
    let squared = travel.dot(&travel);
    if energy < 0.0 && squared > 0.0 {
        (-energy * DT / squared).min(most)
    } else {
        0.0
    }
}

/// `v` in its own direction, no longer than `limit`; and whether it had to be shortened. Finite for every finite `v`.
fn shortened(v: Vec3, limit: f32) -> (Vec3, bool) {
    // Squares of large components would overflow, and of small ones vanish: measure against the largest.
    let largest = v.amax();
    if largest <= 0.0 {
        return (v, false);
    }
    let shape = v / largest;
    let ratio = length(shape);
    if largest <= limit / ratio {
        return (v, false);
    }
    // Rounding must not carry the result across the limit.
    (shape * (limit / ratio * (1.0 - 4.0 * f32::EPSILON)), true)
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDGE: Params = Params {
        scale: 1.0,
        slew: 0.5,
        damping: None,
        max: 8.5,
    };

    /// Every class of f32: any bits at all, and every other draw a plain number of some newtons.
    struct Draw(u64);

    impl Draw {
        fn bits(&mut self) -> u64 {
            // Knuth's MMIX linear congruence, its upper half.
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            self.0 >> 32
        }

        fn number(&mut self) -> f32 {
            let bits = self.bits() as u32;
            match bits % 4 {
                0 => f32::from_bits(self.bits() as u32),
                1 => [
                    0.0,
                    -0.0,
                    f32::MAX,
                    f32::MIN,
                    f32::MIN_POSITIVE,
                    1e-45,
                    f32::NAN,
                    f32::INFINITY,
                ][(bits >> 8) as usize % 8],
                _ => (self.bits() as f32 / 4e8 - 5.0) * 4.0,
            }
        }

        fn vector(&mut self) -> Vec3 {
            Vec3::new(self.number(), self.number(), self.number())
        }

        fn inputs(&mut self) -> Inputs {
            Inputs {
                simulated: self.vector(),
                tip: if self.bits().is_multiple_of(3) {
                    self.vector()
                } else {
                    self.vector() * 1e-4
                },
                faults: Faults::default().with(Fault::State, self.bits().is_multiple_of(16)),
                gate: if self.bits().is_multiple_of(8) {
                    Gate::Closed
                } else {
                    Gate::Open
                },
            }
        }
    }

    /// Length in double precision, where no f32 overflows.
    fn exact(v: Vec3) -> f64 {
        v.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>().sqrt()
    }

    fn steady(simulated: Vec3) -> Inputs {
        Inputs {
            simulated,
            tip: Vec3::zeros(),
            faults: Faults::default(),
            gate: Gate::Open,
        }
    }

    #[test]
    fn whatever_comes_in_the_force_is_finite_limited_and_zero_when_it_must_be() {
        for damping in [None, Some(5.0)] {
            let params = Params { damping, ..EDGE };
            let (mut draw, mut state) = (Draw(7), State::default());
            for _ in 0..200_000 {
                let inputs = draw.inputs();
                let record = limit(&params, &mut state, &inputs);
                let force = record.force.get();
                assert!(finite(force) && exact(force) <= 8.5, "{inputs:?} {force}");
                assert!(state.energy.is_finite());
                let wrong = !finite(inputs.simulated) || !finite(inputs.tip) || !inputs.faults.none();
                assert_eq!(!record.faults.none(), wrong);
                if wrong || inputs.gate == Gate::Closed {
                    assert_eq!(force, Vec3::zeros());
                }
            }
        }
    }

    #[test]
    fn without_damping_the_force_never_jumps_except_to_zero() {
        let (mut draw, mut state) = (Draw(11), State::default());
        for _ in 0..200_000 {
            let before = state.sent;
            let force = limit(&EDGE, &mut state, &draw.inputs()).force.get();
            // Half a roundings' worth of 8.5 N per component beyond the limit.
            assert!(
                force == Vec3::zeros() || exact(force - before) <= 0.5 + 2e-6,
                "{before} {force}"
            );
        }
    }

    #[test]
    fn a_force_beyond_the_limit_keeps_its_direction() {
        let mut draw = Draw(13);
        let fast = Params { slew: f32::MAX, ..EDGE };
        for _ in 0..100_000 {
            let simulated = draw.vector();
            let force = limit(&fast, &mut State::default(), &steady(simulated)).force.get();
            if !finite(simulated) || exact(simulated) <= 8.4 {
                continue;
            }
            let [a, b] = [simulated, force].map(|v| v.map(f64::from) / exact(v));
            assert!((a - b).dot(&(a - b)) < 1e-12, "{simulated} {force}");
            assert!((exact(force) - exact(simulated).min(8.5)).abs() < 1e-5);
        }
    }

    #[test]
    fn the_scale_comes_first_and_its_overflow_is_a_fault() {
        let half = Params { scale: 0.5, ..EDGE };
        let force = limit(&half, &mut State::default(), &steady(Vec3::new(0.6, 0.0, 0.0)))
            .force
            .get();
        assert_eq!(force, Vec3::new(0.3, 0.0, 0.0));
        let huge = Params { scale: 2.0, ..EDGE };
        let record = limit(&huge, &mut State::default(), &steady(Vec3::new(f32::MAX, 0.0, 0.0)));
        assert!(record.faults.has(Fault::Force) && record.force == LimitedForce::default());
    }

    #[test]
    fn a_saturated_force_leaves_its_limit_at_once() {
        let mut state = State::default();
        for _ in 0..1000 {
            let _ = limit(&EDGE, &mut state, &steady(Vec3::new(1e6, 0.0, 0.0)));
        }
        let record = limit(&EDGE, &mut state, &steady(Vec3::zeros()));
        assert!((record.force.get().x - 8.0).abs() < 1e-5 && !record.saturated);
    }

    #[test]
    fn after_a_fault_the_force_rises_again_by_the_slew() {
        let mut state = State::default();
        let full = steady(Vec3::new(4.0, 0.0, 0.0));
        for _ in 0..20 {
            let _ = limit(&EDGE, &mut state, &full);
        }
        let faulty = Inputs {
            tip: Vec3::new(f32::NAN, 0.0, 0.0),
            ..full
        };
        assert_eq!(limit(&EDGE, &mut state, &faulty).force, LimitedForce::default());
        let record = limit(&EDGE, &mut state, &full);
        assert!((record.force.get().x - 0.5).abs() < 1e-6 && record.slewed);
    }

    #[test]
    fn the_observer_books_what_was_sent_and_damping_takes_back_what_was_given() {
        // 2 N along x held while the hand moves 1 mm along x: the device gave 2 mJ, E = −2 mJ. At 1 m/s the
        // damping that takes 2 mJ back in one tick is α = 2 mJ / (1 ms · 1 m²/s²) = 2 N·s/m.
        let params = Params {
            slew: 10.0,
            damping: Some(5.0),
            ..EDGE
        };
        let mut state = State::default();
        let push = steady(Vec3::new(2.0, 0.0, 0.0));
        let _ = limit(&params, &mut state, &push);
        let moved = Inputs {
            tip: Vec3::new(1e-3, 0.0, 0.0),
            ..push
        };
        let record = limit(&params, &mut state, &moved);
        assert!((state.energy + 2e-3).abs() < 1e-9);
        assert!((record.damping - 2.0).abs() < 1e-5);
        assert!(length(record.force.get()) < 1e-5, "2 N less 2 N·s/m at 1 m/s");
        let capped = Params {
            damping: Some(0.5),
            ..params
        };
        let mut state = State::default();
        let _ = limit(&capped, &mut state, &push);
        assert!((limit(&capped, &mut state, &moved).damping - 0.5).abs() < 1e-7);
    }

    #[test]
    fn damping_is_idle_at_rest_and_while_energy_is_absorbed() {
        let params = Params {
            slew: 10.0,
            damping: Some(5.0),
            ..EDGE
        };
        let mut state = State::default();
        let push = steady(Vec3::new(2.0, 0.0, 0.0));
        let _ = limit(&params, &mut state, &push);
        let pressed = Inputs {
            tip: Vec3::new(-1e-3, 0.0, 0.0),
            ..push
        };
        assert!(limit(&params, &mut state, &pressed).damping <= 0.0);
        assert!(state.energy > 0.0);
        state.energy = -1.0;
        assert!(limit(&params, &mut state, &pressed).damping <= 0.0);
    }
}
