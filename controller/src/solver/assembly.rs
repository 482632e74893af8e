//! Linearisation of the backward Euler equation at x + u:
//! residual f(x + u) − m (u/dt − v)/dt − α m u/dt, and its spring operator.
//!
//! A spring's Jacobian is k_t d dᵀ + (T/l)(I − d dᵀ) with T/l cut off at zero, so the operator stays positive definite under
//! compression; the force is exact.

use super::spring::{Spring, follow, measure, pull, rest_length};
use super::sweep::{Pass, sweep};
use super::{Problem, Work, operator, volume};
use crate::lanes::{Lanes, blocks, run_on};
use crate::lattice::{DIRECTIONS, Field, Tissue};
use crate::math::DT;

/// Fills residual, operator and inverse diagonal for the displacement `work.step` within the tick.
#[inline(always)]
pub(super) fn linearise<L: Lanes, const N: usize>(
    lanes: L,
    problem: &Problem<'_, N>,
    load: &Field<N>,
    tissue: &Tissue<N>,
    work: &mut Work<N>,
) {
    advance_place(lanes, problem.lattice.len(), tissue, work);
    let Work {
        given,
        step,
        place,
        residual,
        inverse_diagonal,
        axial,
        transverse,
        ..
    } = work;
    let mut pass = Linearise {
        problem,
        load,
        velocity: &tissue.velocity,
        rate: problem.material.spring_damping / DT,
        step,
        place,
        residual,
        inverse_diagonal,
        axial,
        transverse,
    };
    sweep(lanes, problem.lattice, given, &mut pass);
    if problem.material.volume {
        volume::linearise(lanes, problem.lattice, work);
    }
    if let Some(faces) = problem.faces {
        operator::meet(faces, work);
    }
    operator::load_points(problem, work);
}

/// `work.place` = displacement from rest at the end of `work.step`.
#[inline(always)]
fn advance_place<L: Lanes, const N: usize>(lanes: L, n: usize, tissue: &Tissue<N>, work: &mut Work<N>) {
    let parts = work.place.iter_mut().zip(&tissue.displacement).zip(&work.step);
    for ((place, displacement), step) in parts {
        for at in blocks::<L, N>(n) {
            let sum = lanes.load(displacement, at) + lanes.load(step, at);
            lanes.store(sum, place, at);
        }
    }
}

struct Linearise<'a, const N: usize> {
    problem: &'a Problem<'a, N>,
    load: &'a Field<N>,
    velocity: &'a Field<N>,
    /// β/dt.
    rate: f32,
    step: &'a Field<N>,
    place: &'a Field<N>,
    residual: &'a mut Field<N>,
    inverse_diagonal: &'a mut Field<N>,
    axial: &'a mut [Field<N>; DIRECTIONS],
    transverse: &'a mut [[f32; N]; DIRECTIONS],
}

impl<L: Lanes, const N: usize> Pass<L, 6> for Linearise<'_, N> {
    type Near = [L::F; 3];

    #[inline(always)]
    fn near(&self, lanes: L, at: usize) -> Self::Near {
        lanes.vector(self.place, at)
    }

    #[inline(always)]
    fn spring<const D: usize>(&mut self, lanes: L, near: Self::Near, at: usize, far: usize) -> [L::F; 6] {
        let lattice = self.problem.lattice;
        let Spring {
            along,
            length,
            square,
            product,
        } = measure::<L, D>(lanes, lattice.pitch, near, lanes.vector(self.place, far));
        let rest = rest_length::<D>(lattice.pitch);
        let one = lanes.splat(1.0);
        // 1/l and q/(l + L) from one division.
        let inverse_product = one / product;
        let inverse = inverse_product * (length + lanes.splat(rest));
        let stretch = square * inverse_product * length;
        let load = follow::<L, D, N>(
            lanes,
            (lattice, self.problem.material),
            at,
            stretch * lanes.splat(1.0 / rest),
        );
        let [x, y, z] = along;
        let unit = [x * inverse, y * inverse, z * inverse];
        let tension = load.tension * lanes.splat(rest);
        let turn = lanes.where_positive(tension, tension) * inverse;
        let (mut pull, mut steepness) = (tension, load.slope);
        if self.rate > 0.0 {
            let viscous = lanes.splat(self.rate) * load.stiffness;
            let mut rate = lanes.splat(0.0);
            for c in 0..3 {
                rate = rate + unit[c] * (lanes.load(&self.step[c], far) - lanes.load(&self.step[c], at));
            }
            pull = pull + viscous * rate;
            steepness = steepness + viscous;
        }
        let along = lanes.root(lanes.larger(steepness - turn, lanes.splat(0.0)));
        lanes.store(turn, &mut self.transverse[D], at);
        let mut given = [turn; 6];
        for c in 0..3 {
            let axial = unit[c] * along;
            lanes.store(axial, &mut self.axial[D][c], at);
            given[c] = unit[c] * pull;
            given[c + 3] = axial * axial + turn;
        }
        given
    }

    #[inline(always)]
    fn node(&mut self, lanes: L, at: usize, begin: [L::F; 6], end: [L::F; 6]) {
        let lattice = self.problem.lattice;
        let mass = lanes.load(&lattice.mass, at);
        let free = lanes.load(&lattice.free, at);
        let (inertia, drag) = (1.0 / (DT * DT), self.problem.material.mass_damping / DT);
        for c in 0..3 {
            let step = lanes.load(&self.step[c], at);
            let glide = step - lanes.splat(DT) * lanes.load(&self.velocity[c], at);
            let fall = mass * (lanes.splat(inertia) * glide + lanes.splat(drag) * step);
            let force = lanes.load(&self.load[c], at) + (begin[c] - end[c]);
            lanes.store((force - fall) * free, &mut self.residual[c], at);
            let diagonal = mass * lanes.splat(inertia + drag) + (begin[c + 3] + end[c + 3]);
            let inverse = lanes.where_positive(free, lanes.splat(1.0) / diagonal);
            lanes.store(inverse, &mut self.inverse_diagonal[c], at);
        }
    }
}

/// Elastic force of springs and voxels on every node, held ones too [N]; no dashpots, no inertia.
pub fn elastic_force<'w, const N: usize>(
    problem: &Problem<'_, N>,
    tissue: &Tissue<N>,
    work: &'w mut Work<N>,
) -> &'w Field<N> {
    let Work { given, residual, .. } = work;
    let mut pass = Elastic {
        problem,
        place: &tissue.displacement,
        force: residual,
    };
    run_on!(problem.level, lanes => sweep(lanes, problem.lattice, given, &mut pass));
    if problem.material.volume {
        let place = &tissue.displacement;
        run_on!(problem.level, lanes => volume::add_force(lanes, problem.lattice, place, (given, residual)));
    }
    residual
}

struct Elastic<'a, const N: usize> {
    problem: &'a Problem<'a, N>,
    place: &'a Field<N>,
    force: &'a mut Field<N>,
}

impl<L: Lanes, const N: usize> Pass<L, 3> for Elastic<'_, N> {
    type Near = [L::F; 3];

    #[inline(always)]
    fn near(&self, lanes: L, at: usize) -> Self::Near {
        lanes.vector(self.place, at)
    }

    #[inline(always)]
    fn spring<const D: usize>(&mut self, lanes: L, near: Self::Near, at: usize, far: usize) -> [L::F; 3] {
        let far = lanes.vector(self.place, far);
        pull::<L, D, N>(lanes, (self.problem.lattice, self.problem.material), at, [near, far])
    }

    #[inline(always)]
    fn node(&mut self, lanes: L, at: usize, begin: [L::F; 3], end: [L::F; 3]) {
        for c in 0..3 {
            lanes.store(begin[c] - end[c], &mut self.force[c], at);
        }
    }
}
