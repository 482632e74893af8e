//! Piecewise-linear tension of a spring.
//!
//! T(ε) = k L₀ (ε + Σ r_m max(0, ε − ε_m) − ½ g max(0, −ε − ε_c)²) with r, g ≥ 0: convex energy with a continuous slope.
//!
//! Compression keeps the first slope up to the lock ε_c of the body diagonals; edges have none. A lattice of springs alone has no
//! resistance of its own against losing its volume, so a layer under a needle shears off and inverts at a stress of about G.
//! The lock takes its place: uniaxial compression to 30 % shortens the diagonals by 4.5 % only, so their lock there leaves that curve
//! alone and meets a loss of volume. A lock of the edges would do harm: an edge that a blow has turned over is compressed too, and
//! a lock would hold it there. The slope rises gradually: a step of twenty would make one Newton step a tick jump to and fro across it.

use super::Stiffness;
use crate::math::sqrt;
use sutura_shared::scene::{SEGMENTS_MAX, Segment};

/// Breakpoints after the first segment.
const BREAKS: usize = SEGMENTS_MAX - 1;

/// Breakpoints of one spring family. Unused ones have no weight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Breaks {
    /// Strain of the spring at which segment m + 1 begins.
    pub strain: [f32; BREAKS],
    /// Rise of the slope there over the first slope, ≥ 0.
    pub rise: [f32; BREAKS],
    /// Compression of the spring beyond which it locks, ≥ 0, and by how much its slope rises a unit of strain from there; 0 for none.
    pub lock: (f32, f32),
}

/// Lock of the body diagonals.
const DIAGONAL_LOCK: (f32, f32) = (0.045, 1000.0);

impl Breaks {
    /// Normalised tension: T/(k L₀) at `strain`.
    #[inline]
    #[must_use]
    pub fn tension(&self, strain: f32) -> f32 {
        let (at, gain) = self.lock;
        let under = (strain + at).min(0.0);
        let compressed = strain - 0.5 * gain * under * under;
        let pieces = self.strain.iter().zip(&self.rise);
        pieces.fold(compressed, |sum, (at, rise)| sum + rise * (strain - at).max(0.0))
    }
}

/// A tissue's curve as its springs follow it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Curve {
    /// First slope [Pa].
    pub young: f32,
    /// Breakpoints of the edges: those of the stress–strain curve itself.
    pub edge: Breaks,
    /// Breakpoints of the body diagonals: their strain when a voxel in uniaxial stress reaches the edges' breakpoints.
    pub diagonal: Breaks,
}

impl Curve {
    /// From segments of nominal stress against strain (the first begins at zero) and the law's stiffness.
    #[must_use]
    pub fn new(segments: &[Segment], stiffness: Stiffness) -> Self {
        let young = segments.first().map_or(0.0, |s| s.slope_pa);
        let mut curve = Self {
            young,
            ..Self::default()
        };
        curve.diagonal.lock = DIAGONAL_LOCK;
        let rises = segments.windows(2).filter_map(|pair| match pair {
            [before, after] => Some((after.from_strain, (after.slope_pa - before.slope_pa) / young)),
            _ => None,
        });
        for (m, (strain, rise)) in rises.take(BREAKS).enumerate() {
            let diagonal = diagonal_strain(strain, stiffness, &curve.diagonal);
            for (family, at) in [(&mut curve.edge, strain), (&mut curve.diagonal, diagonal)] {
                if let (Some(s), Some(r)) = (family.strain.get_mut(m), family.rise.get_mut(m)) {
                    (*s, *r) = (at, rise);
                }
            }
        }
        curve
    }
}

/// Strain of the body diagonals of one voxel stretched by `strain` along an axis with free sides.
///
/// The sides balance where k_n (λ_t − 1) + 4 T_d λ_t / l_d = 0, found by bisection (bounded: 40 halvings).
fn diagonal_strain(strain: f32, stiffness: Stiffness, breaks: &Breaks) -> f32 {
    let along = 1.0 + strain;
    let root3 = sqrt(3.0);
    let of = |across: f32| sqrt(along * along + 2.0 * across * across) / root3 - 1.0;
    let (mut low, mut high) = (0.1_f32, 1.0_f32);
    for _ in 0..40 {
        let across = 0.5 * (low + high);
        let diagonal = of(across);
        let pull = 4.0 * stiffness.diagonal * breaks.tension(diagonal) * across / (1.0 + diagonal);
        if stiffness.edge * (across - 1.0) + pull > 0.0 {
            high = across;
        } else {
            low = across;
        }
    }
    of(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::stiffness;
    use sutura_shared::scene::Law;

    fn segment(from_strain: f32, slope_pa: f32) -> Segment {
        Segment { from_strain, slope_pa }
    }

    #[test]
    fn tension_follows_the_segments() {
        let skin = [segment(0.0, 281e3), segment(0.3, 1.7e6), segment(0.6, 3.66e6)];
        let curve = Curve::new(&skin, stiffness(Law::Isotropic));
        let stress = |strain: f32| curve.young * curve.edge.tension(strain);
        assert!((stress(0.3) - 84.3e3).abs() < 10.0);
        assert!((stress(0.6) - (84.3e3 + 510e3)).abs() < 100.0);
        assert!((stress(0.7) - (594.3e3 + 366e3)).abs() < 200.0);
        assert!((stress(-0.2) + 56.2e3).abs() < 10.0);
    }

    /// Small strain of the isotropic lattice: ν = 1/4, diagonals take (1 − 2ν)/3 = 1/6 of the axial strain.
    #[test]
    fn diagonals_take_a_sixth_of_a_small_strain() {
        let strain = diagonal_strain(0.01, stiffness(Law::Isotropic), &Breaks::default());
        assert!((strain / 0.01 - 1.0 / 6.0).abs() < 2e-3, "{strain}");
    }

    /// At large strain the share grows to about a quarter.
    #[test]
    fn diagonals_take_about_a_quarter_of_sixty_percent() {
        let strain = diagonal_strain(0.6, stiffness(Law::Isotropic), &Breaks::default());
        assert!((strain / 0.6 - 0.25).abs() < 0.02, "{strain}");
    }
}
