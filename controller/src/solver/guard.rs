//! Keeps a tick from giving tissue energy that nobody put in.
//!
//! Backward Euler loses energy where springs only stiffen, but one linearised step is not backward Euler: a blow that crosses steep slopes
//! overshoots, and what it lands on throws the tissue back harder. So the energy after a step is compared with that before it and the
//! work done on the way: the exact energies of springs, voxels, wound contact and masses. A step that gains is not taken: the tissue
//! stays where it is for that tick, at rest, and goes half as far in the next; steps that keep to their energy double it again. This
//! is a trust region over ticks, so each tick has the same count of operations, and since a solved step leads downhill, a short enough
//! part of it descends.

use super::assembly::advance_place;
use super::spring::{measure, rest_length, stored};
use super::step::{TAKEN, restrain, take_step};
use super::sweep::{Given, Pass, sweep};
use super::{Problem, Work, volume};
use crate::coupling::POINTS;
use crate::lanes::{Lanes, blocks};
use crate::lattice::{Balance, Field, Tissue};
use crate::math::{DT, Vec3};

/// Energy that a step may gain, over what there was: more than rounding and less than anybody feels.
const RISE: f32 = 2e-4;
/// The same over the work done on the tissue: a linear solve that is not run to its end misses the force by less.
const MISSED: f32 = 0.1;
/// The most caution: steps are then a thousandth of what was solved for.
const MOST: f32 = 1023.0;

/// Ends a tick whose solved step `work.step` has the points `moved` from their predicted places: takes what holds of it, and gives how far
/// the points have then moved.
#[inline(always)]
pub(super) fn take<L: Lanes, const N: usize>(
    lanes: L,
    (problem, load): (&Problem<'_, N>, &Field<N>),
    moved: &[Vec3; POINTS],
    tissue: &mut Tissue<N>,
    work: &mut Work<N>,
) -> [Vec3; POINTS] {
    let (lattice, coupling) = (problem.lattice, problem.coupling);
    let whole = coupling.gather(&work.step);
    restrain(lanes, lattice, (1.0 / (1.0 + tissue.balance.caution), TAKEN), work);
    let part = coupling.gather(&work.step);
    let moved: [Vec3; POINTS] = core::array::from_fn(|p| moved[p] + (part[p] - whole[p]));
    tissue.balance = strike(lanes, problem, (load, &coupling.at(&moved)), tissue, work);
    let kept = coupling.gather(&work.step);
    take_step(lanes, lattice.len(), tissue, work);
    core::array::from_fn(|p| moved[p] + (kept[p] - part[p]))
}

/// Makes `work.step` nothing where it gains energy that neither `load` [N] at the nodes nor `force` at the points, both as they are at its
/// end, has put in; gives the balance for the next tick.
///
/// Whoever moves held nodes works on the tissue unseen: such a step is left as it is.
#[inline(always)]
fn strike<L: Lanes, const N: usize>(
    lanes: L,
    problem: &Problem<'_, N>,
    (load, force): (&Field<N>, &[Vec3; POINTS]),
    tissue: &Tissue<N>,
    work: &mut Work<N>,
) -> Balance {
    let n = problem.lattice.len();
    let Balance { known, caution, .. } = tissue.balance;
    let before = match known {
        0 => elastic(lanes, problem, &tissue.displacement, &mut work.given),
        _ => tissue.balance.elastic,
    };
    advance_place(lanes, n, tissue, work);
    let after = elastic(lanes, problem, &work.place, &mut work.given);
    let motion = motion(lanes, problem, load, (tissue, &work.step));
    let [parted, meeting] = [&tissue.displacement, &work.place].map(|place| wound(problem, place));
    let moved = problem.coupling.gather(&work.step);
    let pulled: f32 = moved.iter().zip(force).map(|(moved, force)| moved.dot(force)).sum();
    let had = before + parted + motion.before;
    let gained = (after - before) + (meeting - parted) + (motion.after - motion.before);
    let allowed = RISE * had + MISSED * (motion.work.max(-motion.work) + pulled.max(-pulled));
    if gained - (motion.work + pulled) > allowed && motion.led <= 0.0 {
        for step in &mut work.step {
            step.iter_mut().take(n).for_each(|u| *u = 0.0);
        }
        return Balance {
            elastic: before,
            known: 1,
            caution: (2.0 * caution + 1.0).min(MOST),
        };
    }
    Balance {
        elastic: after,
        known: 1,
        caution: (0.5 * (caution - 1.0)).max(0.0),
    }
}

/// Energy of springs and voxels at displacements `place` [J].
#[inline(always)]
fn elastic<L: Lanes, const N: usize>(
    lanes: L,
    problem: &Problem<'_, N>,
    place: &Field<N>,
    given: &mut Given<N>,
) -> f32 {
    let mut pass = Energy {
        problem,
        place,
        sum: lanes.nothing(),
    };
    sweep(lanes, problem.lattice, given, &mut pass);
    let springs = lanes.total(pass.sum);
    if problem.material.volume {
        springs + volume::energy(lanes, problem.lattice, place, given)
    } else {
        springs
    }
}

struct Energy<'a, L: Lanes, const N: usize> {
    problem: &'a Problem<'a, N>,
    place: &'a Field<N>,
    sum: L::Sum,
}

impl<L: Lanes, const N: usize> Pass<L, 0> for Energy<'_, L, N> {
    type Near = [L::F; 3];

    #[inline(always)]
    fn near(&self, lanes: L, at: usize) -> Self::Near {
        lanes.vector(self.place, at)
    }

    #[inline(always)]
    fn spring<const D: usize>(&mut self, lanes: L, near: Self::Near, at: usize, far: usize) -> [L::F; 0] {
        let Problem { lattice, material, .. } = self.problem;
        let rest = rest_length::<D>(lattice.pitch);
        let spring = measure::<L, D>(lanes, lattice.pitch, near, lanes.vector(self.place, far));
        let strain = spring.square * spring.length / (spring.product * lanes.splat(rest));
        let energy = stored::<L, D, N>(lanes, (lattice, material), at, strain) * lanes.splat(rest * rest);
        self.sum = lanes.add(self.sum, at, energy);
        []
    }

    #[inline(always)]
    fn node(&mut self, _: L, _: usize, _: [L::F; 0], _: [L::F; 0]) {}
}

/// Nodes during a step.
struct Motion {
    /// Kinetic energy before it and after it [J].
    before: f32,
    after: f32,
    /// Work of the load [J].
    work: f32,
    /// Square of the way of held nodes [m²].
    led: f32,
}

#[inline(always)]
fn motion<L: Lanes, const N: usize>(
    lanes: L,
    problem: &Problem<'_, N>,
    load: &Field<N>,
    (tissue, step): (&Tissue<N>, &Field<N>),
) -> Motion {
    let lattice = problem.lattice;
    let [mut before, mut after, mut work, mut led] = [lanes.nothing(); 4];
    for at in blocks::<L, N>(lattice.len()) {
        let free = lanes.load(&lattice.free, at);
        let half = lanes.splat(0.5) * lanes.load(&lattice.mass, at) * free;
        let [x, y, z] = lanes.vector(step, at);
        let [u, v, w] = lanes.vector(&tissue.velocity, at);
        let [fx, fy, fz] = lanes.vector(load, at);
        let way = x * x + y * y + z * z;
        before = lanes.add(before, at, half * (u * u + v * v + w * w));
        after = lanes.add(after, at, half * way * lanes.splat(1.0 / (DT * DT)));
        work = lanes.add(work, at, (fx * x + fy * y + fz * z) * free);
        led = lanes.add(led, at, way * (lanes.splat(1.0) - free));
    }
    Motion {
        before: lanes.total(before),
        after: lanes.total(after),
        work: lanes.total(work),
        led: lanes.total(led),
    }
}

/// Energy of the wound's pairs that overlap [J].
fn wound<const N: usize>(problem: &Problem<'_, N>, [place, ..]: &Field<N>) -> f32 {
    let Some(faces) = problem.faces else { return 0.0 };
    let pairs = faces.pairs().filter_map(|(left, right)| {
        let over = faces.width(*place.get(left)?, *place.get(right)?).min(0.0);
        Some(0.5 * faces.penalty * over * over)
    });
    pairs.sum()
}
