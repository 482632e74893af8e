//! Friction of the shaft and the force of the cutting tip, by position alone (Hayward & Armstrong 2000): a spring from where the shaft
//! adheres, which gives way at the limit. Below the limit nothing moves on, so nothing drifts.
//!
//! One limit holds and drags, Fs = Fc. Drawn at v₀ through a spring k, what sticks and slips does so with the period 2 (Fs − Fc)/(k v₀), or
//! half of that overdamped: here it is none. The force rises to the limit and stays there.

use super::{Hole, Params, Passage, State};

/// What rubs at one site.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shaft {
    /// Length in the tissue [m].
    pub length: f32,
    /// The tip is in the tissue beyond the site, and may cut.
    pub cuts: bool,
}

/// Force along the needle on the tissue.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rub {
    /// Towards the tip [N].
    pub force: f32,
    /// Growth with the needle's way while it adheres [N/m], else 0.
    pub stiffness: f32,
}

/// The shaft at every site: from the entry to the exit of each stretch of tissue, or to the needle's end, at the site nearer to its swage
/// that it still passes. The tip cuts until it meets the far surface.
#[must_use]
pub fn shafts(state: &State, length: f32) -> [Shaft; 4] {
    let [a, b, c, d] = &state.sites;
    let stretch = |entry: &Passage, exit: &Passage| match (entry.from_tip(), exit.from_tip()) {
        (Some(entry), Some(exit)) => [(entry - exit).max(0.0), 0.0],
        (Some(entry), None) => [entry, 0.0],
        (None, Some(exit)) => [0.0, length - exit],
        (None, None) => [0.0; 2],
    };
    let lengths = if b.is_through() {
        let ([a, b], [c, d]) = (stretch(a, b), stretch(c, d));
        [a, b, c, d]
    } else {
        let [a, d] = stretch(a, d);
        [a, 0.0, 0.0, d]
    };
    let cuts = [b.is_out() && d.is_out(), false, d.is_out(), false];
    core::array::from_fn(|n| Shaft {
        length: lengths.get(n).copied().unwrap_or_default(),
        cuts: cuts.get(n).copied().unwrap_or_default(),
    })
}

/// The force at `from_tip`, and where the shaft adheres after it.
pub fn rub(params: &Params, hole: &mut Hole, from_tip: f32, shaft: Shaft) -> Rub {
    let [per_length, cutting] = params.friction;
    let strain = from_tip - hole.adhesion;
    // A tip that leans on the end of its track cuts on; behind that end all is cut.
    let leans = shaft.cuts && strain > 0.0 && from_tip > hole.cut - cutting / params.stiffness;
    let limit = per_length * shaft.length + if leans { cutting } else { 0.0 };
    if limit <= 0.0 {
        hole.adhesion = from_tip;
        return Rub::default();
    }
    let reach = limit / params.stiffness;
    let held = strain.max(-reach).min(reach);
    let sticks = held.to_bits() == strain.to_bits();
    if !sticks {
        hole.adhesion = from_tip - held;
    }
    Rub {
        force: params.stiffness * held,
        stiffness: if sticks { params.stiffness } else { 0.0 },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::needle::Point;
    use sutura_shared::scene::Tool;

    const PARAMS: Params = Params {
        tool: Tool::Ball { radius_m: 1e-3 },
        stiffness: 800.0,
        rate: 1000.0,
        kernel: 3e-3,
        f0: None,
        tension_gain: 0.0,
        under: 0.0,
        friction: [20.0, 0.2],
    };
    const SHAFT: Shaft = Shaft {
        length: 10e-3,
        cuts: true,
    };

    fn hole(from_tip: f32) -> Hole {
        Hole {
            point: Point::default(),
            from_tip,
            adhesion: from_tip,
            cut: 20e-3,
        }
    }

    /// The limit f L = 0.2 N is reached 0.25 mm from the adhesion.
    #[test]
    fn a_swing_of_half_the_reach_does_not_drift() {
        let mut hole = hole(10e-3);
        let from = hole.adhesion;
        for cycle in 0..100_000_u32 {
            for quarter in [1.0, 0.0, -1.0, 0.0] {
                let offset = quarter * 0.125e-3 * (1.0 - 1e-6 * cycle as f32);
                let force = rub(&PARAMS, &mut hole, from + offset, SHAFT).force;
                assert!((force - 800.0 * offset).abs() < 2e-6, "{force} N");
            }
        }
        assert_eq!(hole.adhesion.to_bits(), from.to_bits());
    }

    /// Drawn at v₀ through the coupling as the tick does it, a tool without mass: B ṗ + (K + σ₀) p = −σ₀ v₀ t has it trail by
    /// p = −σ₀ v₀/(K + σ₀) (t − τ), τ = B/(K + σ₀), whatever the step of backward Euler. So F = σ₀ v₀ (K t + σ₀ τ)/(K + σ₀) until the limit
    /// f L = 0.2 N, and that from then on.
    #[test]
    fn drawn_at_an_even_speed_it_slips_without_sticking() {
        let Params { stiffness: k, rate, .. } = PARAMS;
        let tau = 1e-3 * rate / (2.0 * k);
        for speed in [1e-3_f32, 4e-3, -4e-3] {
            let mut hole = hole(10e-3);
            let slips = (0.4 / speed.abs() - k * tau) / k;
            let (mut offset, mut slipped) = (0.0_f32, 0);
            for tick in 1..=2000 {
                let time = 1e-3 * tick as f32;
                let rub = rub(&PARAMS, &mut hole, 10e-3 + speed * time + offset, SHAFT);
                let drawn = -(k * offset + rub.force) / (k + rate + rub.stiffness);
                let force = rub.force + rub.stiffness * drawn;
                offset += drawn;
                let (expected, within) = if time > slips + 1e-3 {
                    slipped += 1;
                    (0.2_f32.copysign(speed), 1e-6)
                } else {
                    (0.5 * k * speed * (time + tau), 2e-5)
                };
                // The tool starts at a jerk, which is over within a few ticks; and in the tick in which it begins to slip it may do either.
                let counts = tick > 10 && (time - slips).abs() > 2e-3;
                assert!(
                    !counts || (force - expected).abs() < within,
                    "{speed} m/s at {time} s: {force} N of {expected} N"
                );
            }
            assert!(slipped > 1400, "{slipped}");
        }
    }

    /// Over any closed loop the hand pays: a swing of four reaches dissipates the limit times the way that slips, 2·(2·1 mm − 2·0.25 mm).
    #[test]
    fn a_closed_loop_costs_work() {
        let mut hole = hole(10e-3);
        let at = |step: i32| 10e-3 + 1e-6 * (1000 - (step.rem_euclid(4000) - 2000).abs()) as f32;
        let mut work = 0.0_f64;
        for step in 1..=8000 {
            let before = rub(&PARAMS, &mut hole, at(step - 1), SHAFT).force;
            let force = rub(&PARAMS, &mut hole, at(step), SHAFT).force;
            if step > 4000 {
                work += 0.5 * f64::from(before + force) * f64::from(at(step) - at(step - 1));
            }
        }
        assert!((work / (2.0 * 0.2 * 1.5e-3) - 1.0).abs() < 1e-3, "{work} J");
    }
}
