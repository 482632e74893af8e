//! Keeps a tick from giving tissue energy that nobody put in.
//!
//! Backward Euler loses energy where springs only stiffen, but one linearised step is not backward Euler: a blow that crosses steep slopes
//! overshoots, and what it lands on throws the tissue back harder. So the energy after a step is compared with that before it and the
//! work done on the way: the exact energies of springs, voxels, wound contact and masses. A step that gains is not taken: the tissue
//! stays where it is for that tick, at rest, and goes half as far in the next; steps that keep to their energy double it again. This
//! is a trust region over ticks, so that no tick repeats its solve, and since a solved step leads downhill, a short enough part of it
//! descends.

use super::assembly::advance_place;
use super::spring::{measure, rest_length, stored};
use super::step::{TAKEN, restrain, take_step};
use super::sweep::{Given, Pass, sweep};
use super::{Problem, Work, volume};
use crate::coupling::POINTS;
use crate::lanes::{Lanes, blocks};
use crate::lattice::{Balance, Field, Tissue};
use crate::math::{DT, Vec3};

/// Energy that a step may gain, over what there was: sums of single numbers are off by about 1e-6 of it, and a fifth of what hard cases are
/// allowed goes unfelt.
const RISE: f32 = 2e-4;
/// Gain of energy that says nothing against the next step [J]: skin of 1 MPa that moves by 10 nm holds as much, and what has come to rest is
/// rounding alone.
const STILL: f32 = 1e-13;
/// The same over the work that goes through the points and the load, either way: a linear solve that is not run to its end misses the force by
/// less.
const MISSED: f32 = 0.1;
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
    tissue.balance = keep(lanes, problem, (load, &coupling.at(&moved)), tissue, work);
    let kept = coupling.gather(&work.step);
    take_step(lanes, lattice.len(), tissue, work);
    core::array::from_fn(|p| moved[p] + (kept[p] - part[p]))
}

/// Makes `work.step` nothing where it gains energy that neither `load` [N] at the nodes nor the points, with `force` at its end, have put in;
/// gives the balance for the next tick.
///
/// Whoever moves held nodes works on the tissue unseen: such a step is left as it is.
#[inline(always)]
fn keep<L: Lanes, const N: usize>(
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
    let [overlap_before, overlap_after] = [&tissue.displacement, &work.place].map(|place| wound(problem, place));
    let moved = problem.coupling.gather(&work.step);
    // A hold that gives way within the step does between the work of its force at the beginning and of that at the end.
    let forces = problem.coupling.force.iter().zip(force);
    let by_point = moved.iter().zip(forces);
    let [pulled, passed] = by_point.fold([0.0_f32; 2], |[pulled, passed], (moved, (first, last))| {
        let work = moved.dot(first).max(moved.dot(last));
        [pulled + work, passed + work.max(-work)]
    });
    let had = before + overlap_before + motion.before;
    let gained = (after - before) + (overlap_after - overlap_before) + (motion.after - motion.before);
    let allowed = RISE * had + MISSED * (motion.work.max(-motion.work) + passed);
    let excess = gained - (motion.work + pulled) - allowed;
    let refused = excess > 0.0 && motion.prescribed <= 0.0;
    if refused {
        for step in &mut work.step {
            step.iter_mut().take(n).for_each(|u| *u = 0.0);
        }
    }
    Balance {
        elastic: if refused { before } else { after },
        known: 1,
        caution: if refused && excess > STILL {
            (2.0 * caution + 1.0).min(Balance::CAUTION_MAX)
        } else {
            (0.5 * (caution - 1.0)).max(0.0)
        },
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
    /// Square of the way of held nodes, which is prescribed [m²].
    prescribed: f32,
}

#[inline(always)]
fn motion<L: Lanes, const N: usize>(
    lanes: L,
    problem: &Problem<'_, N>,
    load: &Field<N>,
    (tissue, step): (&Tissue<N>, &Field<N>),
) -> Motion {
    let lattice = problem.lattice;
    let [mut before, mut after, mut work, mut prescribed] = [lanes.nothing(); 4];
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
        prescribed = lanes.add(prescribed, at, way * (lanes.splat(1.0) - free));
    }
    Motion {
        before: lanes.total(before),
        after: lanes.total(after),
        work: lanes.total(work),
        prescribed: lanes.total(prescribed),
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

#[cfg(test)]
mod tests {
    extern crate std;
    use super::super::elastic_force;
    use super::*;
    use crate::coupling::Coupling;
    use crate::lanes::{Level, Single};
    use crate::lattice::{DIRECTIONS, EDGES, Lattice, STEPS};
    use crate::law::{self, Curve, Material};
    use std::boxed::Box;
    use sutura_shared::scene::{Law, Segment};

    const N: usize = Lattice::<0>::guard([5, 4, 4]) as usize;
    const YOUNG: f32 = 1e5;
    const PITCH: f32 = 2e-3;

    /// A block of stiffening springs and of voxels with volume and barrier.
    fn block() -> (Box<Lattice<N>>, Material) {
        let stiffness = law::stiffness(Law::Volume { poisson: 0.45 });
        let segments = [(0.0, 1.0), (0.03, 4.0), (0.06, 10.0)].map(|(from_strain, slope)| Segment {
            from_strain,
            slope_pa: slope * YOUNG,
        });
        let mut material = Material {
            stiffening: true,
            volume: true,
            ..Material::default()
        };
        material.curves[0] = Curve::new(&segments, stiffness);
        let mut lattice: Box<Lattice<N>> = bytemuck::zeroed_box();
        (lattice.nodes, lattice.pitch) = ([5, 4, 4], PITCH);
        let all: std::vec::Vec<_> = lattice.nodes().collect();
        for (node, n) in all {
            (lattice.mass[n], lattice.free[n]) = (1e-6, 1.0);
            let inside = |step: [i32; 3]| (0..3).all(|a| (0..[5, 4, 4][a]).contains(&(node[a] as i32 + step[a])));
            for d in (0..DIRECTIONS).filter(|d| inside(STEPS[*d])) {
                let over_ea = if d < EDGES { stiffness.edge } else { stiffness.diagonal };
                lattice.stiffness[0][d][n] = over_ea * YOUNG * PITCH;
            }
            if inside([1, 1, 1]) {
                (lattice.volume[n], lattice.barrier[n]) = (stiffness.volume * YOUNG, law::BARRIER * YOUNG);
            }
        }
        (lattice, material)
    }

    /// Numbers from −1 to 1 without a pattern.
    fn rough(n: usize, c: usize, seed: f64) -> f32 {
        libm::sin((n * 3 + c) as f64 * 12.9898 + seed) as f32
    }

    /// What the energy loses on a way is the work of the elastic force on it, by Simpson's rule in pieces: near rest, across the curve's breaks,
    /// and where voxels are flat or inverted.
    #[test]
    fn the_energy_is_that_of_the_forces() {
        let (lattice, material) = block();
        let coupling = Coupling::default();
        let problem = Problem {
            lattice: &lattice,
            material: &material,
            coupling: &coupling,
            faces: None,
            level: Level::Single,
        };
        let mut work: Box<Work<N>> = bytemuck::zeroed_box();
        let mut tissue: Box<Tissue<N>> = bytemuck::zeroed_box();
        for shift in [0.01, 0.1, 0.6] {
            let place = |n: usize, c: usize, part: f64| {
                let (from, to) = (rough(n, c, 0.5), rough(n, c, 0.5) + 0.3 * rough(n, c, 2.0));
                shift * PITCH * (from + (to - from) * part as f32)
            };
            let put = |tissue: &mut Tissue<N>, part: f64| {
                for (_, n) in lattice.nodes() {
                    for c in 0..3 {
                        tissue.displacement[c][n] = place(n, c, part);
                    }
                }
            };
            let pieces = 16_u16;
            let mut done = 0.0_f64;
            for at in 0..=2 * pieces {
                let weight = match at {
                    0 => 1.0,
                    _ if at == 2 * pieces => 1.0,
                    _ if at % 2 == 1 => 4.0,
                    _ => 2.0,
                };
                put(&mut tissue, f64::from(at) / f64::from(2 * pieces));
                let force = elastic_force(&problem, &tissue, &mut work);
                for (_, n) in lattice.nodes() {
                    for c in 0..3 {
                        let way = f64::from(place(n, c, 1.0)) - f64::from(place(n, c, 0.0));
                        done += weight * f64::from(force[c][n]) * way / (6.0 * f64::from(pieces));
                    }
                }
            }
            let mut at = |part: f64| {
                put(&mut tissue, part);
                f64::from(elastic(Single, &problem, &tissue.displacement, &mut work.given))
            };
            let (before, after) = (at(0.0), at(1.0));
            let off = (after - before + done).abs() / done.abs();
            assert!(off < 1e-3, "{shift}: {before:e} to {after:e} J, work {done:e} J");
        }
    }
}
