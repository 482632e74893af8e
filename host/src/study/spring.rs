//! Tension of one spring in single precision, for the solvers of the studies.

use sutura_controller::lattice::EDGES;
use sutura_controller::law::Material;

/// T/(k L₀) over the strain: the breakpoints that are in use.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spring {
    /// Strain and change of the slope there, away from zero strain.
    breaks: Vec<(f32, f32)>,
    /// Compression from which it locks, and by how much its slope rises a unit of strain from there.
    lock: (f32, f32),
}

impl Spring {
    /// The springs of a direction in a block of one tissue.
    #[must_use]
    pub fn new(material: &Material, direction: usize) -> Self {
        let [curve, ..] = &material.curves;
        let breaks = match (material.stiffening, direction) {
            (false, _) => return Self::default(),
            (true, 0..EDGES) => &curve.edge,
            (true, _) => &curve.diagonal,
        };
        let pairs = breaks.strain.iter().copied().zip(breaks.rise);
        Self {
            breaks: pairs.filter(|(_, rise)| rise.abs() > 0.0).collect(),
            lock: breaks.lock,
        }
    }

    /// Pieces of the curve.
    #[must_use]
    pub fn pieces(&self) -> usize {
        1 + self.breaks.len() + usize::from(self.lock.1 > 0.0)
    }

    /// T/(k L₀) at a strain, and its slope.
    #[inline]
    #[must_use]
    pub fn follow(&self, strain: f32) -> (f32, f32) {
        let (from, gain) = self.lock;
        let under = (-strain - from).max(0.0);
        let start = (strain - 0.5 * gain * under * under, 1.0 + gain * under);
        self.breaks.iter().fold(start, |(tension, slope), (at, rise)| {
            let past = strain - at;
            let beyond = if *at < 0.0 { past < 0.0 } else { past > 0.0 };
            if beyond {
                (tension + rise * past, slope + rise)
            } else {
                (tension, slope)
            }
        })
    }

    /// Steepest slope of any piece over the first; without the lock, whose slope has no bound.
    #[must_use]
    pub fn steepest(&self) -> f32 {
        let unlocked = Self {
            lock: (0.0, 0.0),
            ..self.clone()
        };
        let beyond = self.breaks.iter().map(|(at, _)| unlocked.follow(at * 1.0001).1);
        beyond.fold(1.0, f32::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::block::{Block, Spec};
    use sutura_shared::scene::{Assembly, Law};

    /// The tension is the controller's own, and its slope the difference quotient wherever no breakpoint lies between.
    #[test]
    fn tension_and_slope_belong_together() {
        let spec = Spec {
            nodes: [2, 2, 2],
            pitch_m: 2e-3,
            young_pa: 1e5,
            density_kg_m3: 1000.0,
            law: Law::Isotropic,
            assembly: Assembly::PerVoxel,
            stiffening: true,
            damping_per_s: 0.0,
        };
        let material = Block::new(&spec).unwrap().material;
        for (direction, breaks) in [(0, material.curves[0].edge), (3, material.curves[0].diagonal)] {
            let spring = Spring::new(&material, direction);
            for strain in (-80..400).step_by(7).map(|thousandth| thousandth as f32 * 1e-3) {
                let [low, high] = [strain - 2e-4, strain + 2e-4].map(|strain| spring.follow(strain));
                assert!((breaks.tension(strain) - spring.follow(strain).0).abs() < 1e-6);
                let quotient = (high.0 - low.0) / 4e-4;
                let (least, most) = (low.1.min(high.1), low.1.max(high.1));
                assert!(
                    (0.99 * least..1.01 * most).contains(&quotient),
                    "{direction} {strain}: {quotient}"
                );
            }
        }
    }

    #[test]
    fn the_steepest_slope_is_that_of_some_piece() {
        let spring = Spring {
            breaks: vec![(-0.1, 2.0), (0.03, 3.0), (0.06, 6.0), (0.2, -4.0)],
            lock: (0.05, 1000.0),
        };
        assert!((spring.steepest() - 10.0).abs() < 1e-6);
        assert!((Spring::default().steepest() - 1.0).abs() < 1e-6);
    }
}
