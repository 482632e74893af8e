//! What the hand feels of a rendering: the work that it gets out of it, and its buzz.

use std::f64::consts::TAU;

use sutura_controller::math::Vec3;

use crate::study::stability::watch::Felt as Seen;

/// Time over which a hold is looked at [ticks].
const SECOND: usize = 1000;

/// Forces on the hand and where the tip really was, millisecond by millisecond; the device's frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Felt {
    /// Force during each [N].
    force: Vec<Vec3>,
    /// Tip at the beginning of each [m].
    tip: Vec<Vec3>,
    seen: Seen,
}

impl Felt {
    /// A millisecond with this force from this place on.
    pub(super) fn note(&mut self, force: Vec3, tip: Vec3) {
        self.force.push(force);
        self.tip.push(tip);
    }

    /// The hand has held still for the last second, or has trembled only.
    pub(super) fn held(&mut self) {
        self.seen.buzz_n = self.seen.buzz_n.max(buzz(last(&self.force)));
    }

    /// All that was felt.
    pub(super) fn seen(self) -> Seen {
        // The force of a millisecond works along the way to the next one's beginning; what the hand gets is negative, as in the observer.
        let ways = self.tip.windows(2).map(|ends| ends[1] - ends[0]);
        let mut absorbed = 0.0_f64;
        let mut least = 0.0_f64;
        for (force, way) in self.force.iter().zip(ways) {
            absorbed -= force.map(f64::from).dot(&way.map(f64::from));
            least = least.min(absorbed);
        }
        Seen {
            least_j: least,
            ..self.seen
        }
    }
}

fn last(all: &[Vec3]) -> &[Vec3] {
    all.get(all.len().saturating_sub(SECOND)..).unwrap_or_default()
}

/// Root mean square of the part above 20 Hz of a second of forces, by its Fourier sums (Parseval) [N].
fn buzz(forces: &[Vec3]) -> f64 {
    let count = forces.len();
    let power = |hertz: usize| {
        let (mut cos, mut sin) = (nalgebra::Vector3::zeros(), nalgebra::Vector3::zeros());
        for (tick, force) in forces.iter().enumerate() {
            let (s, c) = (TAU * (hertz * tick % SECOND) as f64 / SECOND as f64).sin_cos();
            cos += force.map(f64::from) * c;
            sin += force.map(f64::from) * s;
        }
        2.0 * (cos.norm_squared() + sin.norm_squared()) / (count * count) as f64
    };
    (21..SECOND / 2).map(power).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine of amplitude A has the root mean square A/√2, below 20 Hz or above.
    #[test]
    fn buzz_is_what_lies_above_20_hz() {
        let sine = |hertz: f64| {
            let at = |tick: usize| 0.3 * (TAU * hertz * tick as f64 / 1e3).sin() as f32;
            (0..SECOND).map(|tick| Vec3::y() * at(tick)).collect::<Vec<_>>()
        };
        assert!(buzz(&sine(10.0)) < 1e-6);
        assert!((buzz(&sine(60.0)) - 0.3 / 2.0_f64.sqrt()).abs() < 1e-6);
    }

    /// 2 N along the way of 1 mm that the hand goes gives it 2 mJ; the same against it takes them back.
    #[test]
    fn work_that_the_hand_gets_is_negative() {
        let mut felt = Felt::default();
        for (force, x) in [(2.0, 0.0), (-1.0, 1e-3), (0.0, 3e-3)] {
            felt.note(Vec3::x() * force, Vec3::x() * x);
        }
        assert!((felt.seen().least_j + 2e-3).abs() < 1e-9);
    }
}
