//! What a run must have been like to pass, the same for every case.
//!
//! 1. Finite at every tick, without a fault.
//! 2. What the device is told stays within the profile's maximum and, but for passivity damping, changes by no more than the slew a tick.
//! 3. From when the input stops, energy above the rest state falls below 1 % of its peak within a second and stays there.
//! 4. It never rises by more than a thousandth of that peak in a tick.
//! 5. At the end every node is within 0.05 mm of rest; where the case has listed another equilibrium, the farthest node is as far as listed.
//! 6. No voxel is inverted then.
//! 7. Where there is a hand on the device: the rendering never gives it more than 1 mJ, and its force above 20 Hz in a hold stays below 0.05 N.
//!
//! The peak is that from when the input stops; where the tool has let go only then, that of the whole run.

use super::case::Equilibrium;
use super::watch::{Moment, Trace};

/// Time for the energy to go [ticks].
pub const SECOND: usize = 1000;
/// What may be left of it then, over its peak.
pub const LEFT: f64 = 0.01;
/// What it may rise by in a tick, over its peak.
pub const RISE: f64 = 1e-3;
/// How far from rest a node may end [m].
pub const NEAR_M: f64 = 5e-5;
/// What the rendering may give the hand [J].
pub const GIVEN_J: f64 = 1e-3;
/// Force above 20 Hz in a hold [N].
pub const BUZZ_N: f64 = 0.05;
/// Stands for a ratio without a bound: what is not finite, or is there where nothing may be.
pub const BOUNDLESS: f64 = 1e9;
/// What rounding may carry a force across its bound by, over the bound.
const ROUNDING: f64 = 1e-5;

/// What comes of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Whether every criterion holds.
    pub passed: bool,
    /// The criterion that fails, or comes nearest to failing, with its number.
    pub why: String,
    /// That number over its bound: above 1 fails. What the output edge keeps to by construction counts only if it fails.
    pub worst: f64,
}

/// One criterion's number over its bound, and how it reads.
struct Measure {
    ratio: f64,
    text: String,
}

/// Judges a run.
#[must_use]
pub fn judge(trace: &Trace, equilibrium: Option<&Equilibrium>) -> Verdict {
    let measures = [
        finite(trace),
        force(trace),
        left(trace, equilibrium),
        rise(trace, equilibrium),
        rest(trace, equilibrium),
        upright(trace),
        felt(trace),
    ];
    // The first of equals: what is not finite explains the rest.
    let worst = measures.into_iter().fold(Measure::default(), Measure::or_worse);
    Verdict {
        passed: worst.ratio <= 1.0,
        why: worst.text,
        worst: worst.ratio,
    }
}

impl Measure {
    fn or_worse(self, other: Self) -> Self {
        if other.ratio > self.ratio { other } else { self }
    }
}

impl Default for Measure {
    fn default() -> Self {
        Self {
            ratio: 0.0,
            text: "nothing is left of it, and the energy never rises".to_owned(),
        }
    }
}

fn finite(trace: &Trace) -> Measure {
    let first = trace
        .moments
        .iter()
        .position(|moment| !(moment.finite && moment.energy_j.is_finite()));
    Measure {
        ratio: first.map_or(0.0, |_| BOUNDLESS),
        text: format!("not finite from tick {}", first.unwrap_or_default()),
    }
}

fn force(trace: &Trace) -> Measure {
    let over = |(tick, moment): (usize, &Moment)| {
        let most = Measure {
            ratio: moment.rendered_n / trace.largest_n,
            text: format!(
                "force of {:.3} N at tick {tick} where {} are the most",
                moment.rendered_n, trace.largest_n
            ),
        };
        let step = Measure {
            ratio: moment.change_n / moment.may_change_n,
            text: format!(
                "force changes by {:.4} N at tick {tick} where {:.4} are the most",
                moment.change_n, moment.may_change_n
            ),
        };
        if most.ratio > step.ratio { most } else { step }
    };
    let all = trace.moments.iter().enumerate().map(over);
    // Both are reached by design: rounding aside, only what lies beyond counts.
    let beyond = all.filter(|measure| measure.ratio > 1.0 + ROUNDING);
    beyond.fold(Measure::default(), Measure::or_worse)
}

/// Energies above the state of rest from when the input stopped [J], and their peak.
fn free(trace: &Trace, equilibrium: Option<&Equilibrium>) -> (Vec<f64>, f64) {
    let rest = equilibrium
        .and_then(|_| trace.moments.last())
        .map_or(0.0, |last| last.energy_j);
    let after = trace.moments.iter().skip(trace.input);
    let energies: Vec<f64> = after.map(|moment| moment.energy_j - rest).collect();
    let peak = energies.iter().copied().fold(trace.peak_j, f64::max);
    (energies, peak)
}

fn left(trace: &Trace, equilibrium: Option<&Equilibrium>) -> Measure {
    let (energies, peak) = free(trace, equilibrium);
    let left = energies.into_iter().skip(SECOND).fold(0.0, f64::max);
    Measure {
        ratio: over(left, LEFT * peak),
        text: format!(
            "{:.2e} of the energy is left after a second, of at most {LEFT}",
            over(left, peak)
        ),
    }
}

fn rise(trace: &Trace, equilibrium: Option<&Equilibrium>) -> Measure {
    let (energies, peak) = free(trace, equilibrium);
    let pairs = energies.iter().zip(energies.iter().skip(1)).enumerate();
    let rises = pairs.map(|(tick, (before, after))| (tick + 1, after - before));
    let (tick, most) = rises.fold((0, 0.0), |most, next| if next.1 > most.1 { next } else { most });
    Measure {
        ratio: over(most, RISE * peak),
        text: format!(
            "energy rises by {:.2e} of its peak {tick} ticks after the input, of at most {RISE}",
            over(most, peak)
        ),
    }
}

fn rest(trace: &Trace, equilibrium: Option<&Equilibrium>) -> Measure {
    let asked = equilibrium.map_or(0.0, |equilibrium| equilibrium.displacement_m);
    let off = (trace.displacement_m - asked).abs();
    let off = if off.is_nan() { f64::INFINITY } else { off };
    Measure {
        ratio: over(off, NEAR_M),
        text: format!(
            "a node ends {:.2e} mm from rest, of at most {} mm",
            off * 1e3,
            NEAR_M * 1e3
        ),
    }
}

fn upright(trace: &Trace) -> Measure {
    Measure {
        ratio: if trace.inverted > 0 { BOUNDLESS } else { 0.0 },
        text: format!(
            "{} voxels end inverted, a node {:.2e} mm from rest",
            trace.inverted,
            trace.displacement_m * 1e3
        ),
    }
}

fn felt(trace: &Trace) -> Measure {
    let Some(felt) = trace.felt else {
        return Measure::default();
    };
    let given = -felt.least_j;
    let work = Measure {
        ratio: over(given, GIVEN_J),
        text: format!("the hand is given {given:.2e} J, of at most {GIVEN_J}"),
    };
    work.or_worse(Measure {
        ratio: over(felt.buzz_n, BUZZ_N),
        text: format!(
            "force above 20 Hz is {:.4} N in a hold, of at most {BUZZ_N}",
            felt.buzz_n
        ),
    })
}

/// `value` over `bound`, within 0 and [`BOUNDLESS`].
fn over(value: f64, bound: f64) -> f64 {
    let ratio = if value > 0.0 { value / bound } else { 0.0 };
    if ratio.is_nan() {
        BOUNDLESS
    } else {
        ratio.min(BOUNDLESS)
    }
}
