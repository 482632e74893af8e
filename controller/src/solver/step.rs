//! From a tick's velocity to its displacement and back.

use super::Work;
use crate::lanes::{Lanes, blocks};
use crate::lattice::{Field, Lattice, Tissue};
use crate::math::DT;

/// A displacement within a tick, and one from rest, below which a node is still [m]: a thousandth of an atom. Motion that dies
/// out would otherwise end in subnormal numbers, which cost a hundred times the time.
const STILL: f32 = 1e-15;
const REST: f32 = 1e-13;

/// `work.step` = dt v.
#[inline(always)]
pub(super) fn predict_step<L: Lanes, const N: usize>(lanes: L, n: usize, tissue: &Tissue<N>, work: &mut Work<N>) {
    for (step, velocity) in work.step.iter_mut().zip(&tissue.velocity) {
        for at in blocks::<L, N>(n) {
            lanes.store(lanes.splat(DT) * lanes.load(velocity, at), step, at);
        }
    }
}

/// Way of a node within a tick beyond which x + dt v is no better a place to linearise at than one nearer, over the pitch: springs that a
/// blow has set free pass through rest, and would be met far on the other side at slopes that they never come to.
pub(super) const PREDICTED: f32 = 0.1;
/// Way of a node within a tick beyond which no linearisation holds, over the pitch: 1 m/s of voxels of 2 mm, faster than skin springs back.
pub(super) const TAKEN: f32 = 0.5;

/// Takes this `part` of `work.step`, or less where nodes that move would go further than `most` over the pitch.
#[inline(always)]
pub(super) fn restrain<L: Lanes, const N: usize>(
    lanes: L,
    lattice: &Lattice<N>,
    (part, most): (f32, f32),
    work: &mut Work<N>,
) {
    let far = most * lattice.pitch;
    let (one, least) = (lanes.splat(1.0), lanes.splat(far * far));
    for at in blocks::<L, N>(lattice.len()) {
        let [x, y, z] = lanes.vector(&work.step, at);
        let square = x * x + y * y + z * z;
        let shorter = one - lanes.splat(far) / lanes.root(lanes.larger(square, least));
        let free = lanes.load(&lattice.free, at);
        let keep = one - lanes.where_positive(free, shorter);
        let keep = keep * (one - lanes.where_positive(free, lanes.splat(1.0 - part)));
        for (kept, step) in work.step.iter_mut().zip([x, y, z]) {
            lanes.store(keep * step, kept, at);
        }
    }
}

/// u + `further`.
#[inline(always)]
pub(super) fn add_step<L: Lanes, const N: usize>(lanes: L, n: usize, step: &mut Field<N>, further: &Field<N>) {
    for (step, further) in step.iter_mut().zip(further) {
        for at in blocks::<L, N>(n) {
            lanes.store(lanes.load(step, at) + lanes.load(further, at), step, at);
        }
    }
}

/// x + u, and v = u/dt.
#[inline(always)]
pub(super) fn take_step<L: Lanes, const N: usize>(lanes: L, n: usize, tissue: &mut Tissue<N>, work: &Work<N>) {
    let parts = tissue.displacement.iter_mut().zip(&mut tissue.velocity).zip(&work.step);
    for ((displacement, velocity), step) in parts {
        for at in blocks::<L, N>(n) {
            let step = moving(lanes, lanes.load(step, at), STILL);
            let place = moving(lanes, lanes.load(displacement, at) + step, REST);
            lanes.store(place, displacement, at);
            lanes.store(step / lanes.splat(DT), velocity, at);
        }
    }
}

/// `x`, or zero where it is smaller than `still` either way; what is not a number stays so.
#[inline(always)]
fn moving<L: Lanes>(lanes: L, x: L::F, still: f32) -> L::F {
    x - lanes.where_positive(lanes.splat(still * still) - x * x, x)
}

/// Brings to rest what moves less than a number can hold well.
#[inline(always)]
pub(super) fn still<L: Lanes, const N: usize>(lanes: L, n: usize, tissue: &mut Tissue<N>) {
    for (values, still) in [(&mut tissue.displacement, REST), (&mut tissue.velocity, STILL / DT)] {
        for values in values {
            for at in blocks::<L, N>(n) {
                lanes.store(moving(lanes, lanes.load(values, at), still), values, at);
            }
        }
    }
}
