//! Symplectic Euler in substeps: v⁺ = (v + h f(x)/m)/(1 + α h), x⁺ = x + h v⁺.
//!
//! Stable only below h = 2/ω of the lattice's fastest mode ([`super::spectrum`]). What needle, thread and wound hold is far stiffer than
//! tissue: those few unknowns are stepped implicitly within each substep, so they add nothing to that limit.

use super::points::Points;
use super::spring::{drag, pull};
use super::step::still;
use super::sweep::{Pass, sweep};
use super::{Problem, Solver, Work, predict, volume};
use crate::coupling::POINTS;
use crate::lanes::{Lanes, blocks, run_on};
use crate::lattice::{Field, Tissue, add, at};
use crate::math::{DT, Vec3};

/// The method's dial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Explicit {
    /// Substeps a tick, at least 1.
    pub substeps: u16,
}

impl<const N: usize> Solver<N> for Explicit {
    fn advance(
        &self,
        problem: &Problem<'_, N>,
        load: &Field<N>,
        tissue: &mut Tissue<N>,
        work: &mut Work<N>,
    ) -> [Vec3; POINTS] {
        let step = DT / f32::from(self.substeps);
        let predicted = predict(problem.coupling, tissue);
        let start = problem.coupling.gather(&tissue.displacement);
        // Where the points' force is stated at, as displacement from rest.
        let stated = core::array::from_fn(|p| start[p] + predicted[p]);
        run_on!(problem.level, lanes => fold(lanes, problem, step, work));
        let points = Points::new(problem.coupling, &work.inverse_diagonal);
        for _ in 0..self.substeps {
            run_on!(problem.level, lanes => substep(lanes, (problem, load), step, tissue, work));
            if let Some(points) = &points {
                hold(points, &stated, step, tissue, work);
            }
            if problem.faces.is_some() {
                meet(problem, step, tissue, work);
            }
        }
        run_on!(problem.level, lanes => still(lanes, problem.lattice.len(), tissue));
        let end = problem.coupling.gather(&tissue.displacement);
        core::array::from_fn(|p| end[p] - stated[p])
    }
}

/// `work.residual` x and y = h/m/(1 + α h), zero at held nodes, and 1/(1 + α h), one at held nodes, which glide on; `work.inverse_diagonal` =
/// what a node moves within the substep under a newton [m/N].
#[inline(always)]
fn fold<L: Lanes, const N: usize>(lanes: L, problem: &Problem<'_, N>, step: f32, work: &mut Work<N>) {
    let lattice = problem.lattice;
    let kept = 1.0 / (1.0 + problem.material.mass_damping * step);
    let [answer, keep, _] = &mut work.residual;
    for at in blocks::<L, N>(lattice.len()) {
        let free = lanes.load(&lattice.free, at);
        let per_newton = lanes.splat(kept * step) / lanes.load(&lattice.mass, at);
        let per_newton = lanes.where_positive(free, per_newton);
        lanes.store(per_newton, answer, at);
        lanes.store(lanes.splat(1.0) - free * lanes.splat(1.0 - kept), keep, at);
        for inverse in &mut work.inverse_diagonal {
            lanes.store(per_newton * lanes.splat(step), inverse, at);
        }
    }
}

/// One substep of springs and voxels.
#[inline(always)]
fn substep<L: Lanes, const N: usize>(
    lanes: L,
    (problem, load): (&Problem<'_, N>, &Field<N>),
    step: f32,
    tissue: &mut Tissue<N>,
    work: &mut Work<N>,
) {
    let Work {
        given,
        residual: [answer, keep, _],
        product,
        ..
    } = work;
    let load = if problem.material.volume {
        product.clone_from(load);
        volume::add_force(lanes, problem.lattice, &tissue.displacement, (given, product));
        product
    } else {
        load
    };
    let mut pass = Substep {
        problem,
        load,
        step,
        answer,
        keep,
        displacement: &mut tissue.displacement,
        velocity: &mut tissue.velocity,
    };
    sweep(lanes, problem.lattice, given, &mut pass);
}

struct Substep<'a, const N: usize> {
    problem: &'a Problem<'a, N>,
    load: &'a Field<N>,
    step: f32,
    answer: &'a [f32; N],
    keep: &'a [f32; N],
    displacement: &'a mut Field<N>,
    velocity: &'a mut Field<N>,
}

impl<L: Lanes, const N: usize> Pass<L, 3> for Substep<'_, N> {
    type Near = [L::F; 3];

    #[inline(always)]
    fn near(&self, lanes: L, at: usize) -> Self::Near {
        lanes.vector(self.displacement, at)
    }

    #[inline(always)]
    fn spring<const D: usize>(&mut self, lanes: L, near: Self::Near, at: usize, far: usize) -> [L::F; 3] {
        let material = self.problem.material;
        let ends = [near, lanes.vector(self.displacement, far)];
        let elastic = pull::<L, D, N>(lanes, (self.problem.lattice, material), at, ends);
        if material.spring_damping > 0.0 {
            let rates = [lanes.vector(self.velocity, at), lanes.vector(self.velocity, far)];
            let viscous = drag::<L, D, N>(lanes, (self.problem.lattice, material), at, (ends, rates));
            [
                elastic[0] + viscous[0],
                elastic[1] + viscous[1],
                elastic[2] + viscous[2],
            ]
        } else {
            elastic
        }
    }

    #[inline(always)]
    fn node(&mut self, lanes: L, at: usize, begin: [L::F; 3], end: [L::F; 3]) {
        let (answer, keep) = (lanes.load(self.answer, at), lanes.load(self.keep, at));
        for c in 0..3 {
            let force = begin[c] - end[c] + lanes.load(&self.load[c], at);
            let velocity = lanes.load(&self.velocity[c], at) * keep + force * answer;
            lanes.store(velocity, &mut self.velocity[c], at);
            let place = lanes.load(&self.displacement[c], at) + velocity * lanes.splat(self.step);
            lanes.store(place, &mut self.displacement[c], at);
        }
    }
}

/// What needle and thread do within the substep.
fn hold<const N: usize>(
    points: &Points<'_>,
    stated: &[Vec3; POINTS],
    step: f32,
    tissue: &mut Tissue<N>,
    work: &Work<N>,
) {
    let now = points.coupling.gather(&tissue.displacement);
    let force = points.force(&core::array::from_fn(|p| now[p] - stated[p]));
    for (kernel, force) in points.coupling.kernels.iter().zip(&force) {
        for (node, w) in kernel.iter() {
            let moved = at(&work.inverse_diagonal, node).component_mul(force) * w;
            add(&mut tissue.displacement, node, moved);
            add(&mut tissue.velocity, node, moved / step);
        }
    }
}

/// Pushes the wound's faces apart where they overlap; a node is in one pair, so each pair is solved apart.
fn meet<const N: usize>(problem: &Problem<'_, N>, step: f32, tissue: &mut Tissue<N>, work: &Work<N>) {
    let Some(faces) = problem.faces else { return };
    let [compliance, ..] = &work.inverse_diagonal;
    let ([place, ..], [velocity, ..]) = (&mut tissue.displacement, &mut tissue.velocity);
    for (left, right) in faces.pairs() {
        let ends = (place.get(left), place.get(right));
        let (Some(a), Some(b)) = ends else { continue };
        let (Some(ca), Some(cb)) = (compliance.get(left), compliance.get(right)) else {
            continue;
        };
        let overlap = (-faces.width(*a, *b)).max(0.0);
        let push = faces.penalty * overlap / (1.0 + faces.penalty * (ca + cb));
        for (node, moved) in [(left, -push * ca), (right, push * cb)] {
            if let (Some(x), Some(v)) = (place.get_mut(node), velocity.get_mut(node)) {
                *x += moved;
                *v += moved / step;
            }
        }
    }
}
