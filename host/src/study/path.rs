//! Where the moved node of a poke is at a time.

use std::f64::consts::TAU;

/// Ways for one node, as displacement from its rest place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Path {
    /// Up, and held there.
    Lift {
        /// How far [m].
        lift_m: f64,
    },
    /// 2 mm to and fro along x at 10 Hz, pressed in by 1 mm.
    Drag,
    /// 1 mm in and out along z at 25 Hz, the positive half waves only.
    Tap,
}

impl Path {
    /// As it is named on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Lift { .. } => "lift",
            Self::Drag => "drag",
            Self::Tap => "tap",
        }
    }
}

/// A path that is blended in over a ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course {
    /// The way.
    pub path: Path,
    /// Time in which the path reaches its full size [s].
    pub ramp_s: f64,
}

impl Course {
    /// Displacement from rest at time `t` [s]: the path times s(t) = min(1, t/ramp) [m].
    #[must_use]
    pub fn place(&self, t: f64) -> [f64; 3] {
        let full = match self.path {
            Path::Lift { lift_m } => [0.0, 0.0, lift_m],
            Path::Drag => [2e-3 * (TAU * 10.0 * t).sin(), 0.0, -1e-3],
            Path::Tap => [0.0, 0.0, -1e-3 * (TAU * 25.0 * t).sin().max(0.0)],
        };
        let ramp = if t < self.ramp_s { t / self.ramp_s } else { 1.0 };
        full.map(|component| component * ramp)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn paths_are_where_their_formulas_say() {
        let course = |path| Course { path, ramp_s: 0.1 };
        let lift = course(Path::Lift { lift_m: 5e-3 });
        assert!(apart(lift.place(0.05), [0.0, 0.0, 2.5e-3]) < 1e-15);
        assert!(apart(lift.place(0.3), [0.0, 0.0, 5e-3]) < 1e-15);
        // A quarter of a period of 10 Hz, a quarter of the ramp; three quarters later.
        let drag = course(Path::Drag);
        assert!(apart(drag.place(0.025), [0.5e-3, 0.0, -0.25e-3]) < 1e-15);
        assert!(apart(drag.place(0.175), [-2e-3, 0.0, -1e-3]) < 1e-15);
        // The positive and the negative peak of 25 Hz.
        let tap = course(Path::Tap);
        assert!(apart(tap.place(0.13), [0.0, 0.0, -1e-3]) < 1e-15);
        assert!(apart(tap.place(0.15), [0.0; 3]) < 1e-15);
        // Without a ramp it begins in full.
        let sudden = Course {
            path: Path::Drag,
            ramp_s: 0.0,
        };
        assert!(apart(sudden.place(0.0), [0.0, 0.0, -1e-3]) < 1e-15);
    }
}
