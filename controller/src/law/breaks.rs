//! Piecewise-linear tension of a spring.
//!
//! T(ε) = k L₀ (ε + Σ r_m max(0, ε − ε_m) − ½ g max(0, −ε − ε_c)²), where a breakpoint ε_m < 0 acts on its other side, r_m min(0, ε − ε_m):
//! convex energy, since the slopes stay positive though some of the rises are falls.
//!
//! Compression keeps the first slope up to the lock ε_c of the body diagonals; edges have none. A lattice of springs alone has no
//! resistance of its own against losing its volume, so a layer under a needle shears off and inverts at a stress of about G.
//! The lock takes its place: uniaxial compression to 30 % shortens the diagonals by 4.5 % only, so their lock there leaves that curve
//! alone and meets a loss of volume. A lock of the edges would do harm: an edge that a blow has turned over is compressed too, and
//! a lock would hold it there. The slope rises gradually: a step of twenty would make one Newton step a tick jump to and fro across it.

use sutura_shared::scene::SEGMENTS_MAX;

/// Breakpoints of a spring: those of the asked curve, two within its segments, one in compression.
pub const BREAKS: usize = SEGMENTS_MAX - 1 + 3;

/// Breakpoints of one spring family. Unused ones have no weight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Breaks {
    /// Strains of the spring at which its slope changes: the first below zero or unused, the others above and in order.
    pub strain: [f32; BREAKS],
    /// Change of the slope there, away from zero strain, over the first slope; the slope stays positive.
    pub rise: [f32; BREAKS],
    /// Compression of the spring beyond which it locks, ≥ 0, and by how much its slope rises a unit of strain from there; 0 for none.
    pub lock: (f32, f32),
}

impl Breaks {
    /// Strain and rise of the breakpoints in use.
    #[inline(always)]
    pub fn used(&self) -> impl Iterator<Item = (f32, f32)> + '_ {
        let all = self.strain.iter().zip(&self.rise).map(|(at, rise)| (*at, *rise));
        all.filter(|(_, rise)| rise.abs() > 0.0)
    }

    /// Normalised tension: T/(k L₀) at `strain`.
    #[inline]
    #[must_use]
    pub fn tension(&self, strain: f32) -> f32 {
        let (at, gain) = self.lock;
        let under = (strain + at).min(0.0);
        let compressed = strain - 0.5 * gain * under * under;
        let pieces = self.strain.iter().zip(&self.rise);
        pieces.fold(compressed, |sum, (at, rise)| {
            let past = strain - at;
            sum + rise * if *at < 0.0 { past.min(0.0) } else { past.max(0.0) }
        })
    }

    /// Steepest slope over the first slope, ≥ 1: what majorises the spring. Without the lock, whose slope has no bound.
    #[must_use]
    pub fn steepest(&self) -> f32 {
        let sides = [|at: f32| at < 0.0, |at: f32| at >= 0.0];
        let steepest = |side: fn(f32) -> bool| {
            let pieces = self.strain.iter().zip(&self.rise).filter(|(at, _)| side(**at));
            let slopes = pieces.scan(1.0_f32, |slope, (_, rise)| {
                *slope += rise;
                Some(*slope)
            });
            slopes.fold(1.0, f32::max)
        };
        sides.map(steepest).into_iter().fold(1.0, f32::max)
    }

    /// Slope over the first slope at the strain −`compression` of a spring that has a lock.
    #[must_use]
    pub fn locked(&self, compression: f32) -> f32 {
        let (at, gain) = self.lock;
        1.0 + gain * (compression - at).max(0.0)
    }

    /// Slope over the first slope beyond the last breakpoint.
    pub(super) fn last_slope(&self) -> f32 {
        let pieces = self.strain.iter().zip(&self.rise).filter(|(at, _)| **at >= 0.0);
        pieces.fold(1.0, |slope, (_, rise)| slope + rise)
    }

    /// Sets one breakpoint.
    pub(super) fn set(&mut self, slot: usize, strain: f32, rise: f32) {
        if let (Some(s), Some(r)) = (self.strain.get_mut(slot), self.rise.get_mut(slot)) {
            (*s, *r) = (strain, rise);
        }
    }
}
