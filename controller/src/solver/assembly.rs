//! Linearisation of the backward Euler equation at x + u:
//! residual f(x + u) − m (u/dt − v)/dt − α m u/dt, and its spring operator.
//!
//! A spring's Jacobian is k_t d dᵀ + (T/l)(I − d dᵀ) with T/l cut off at zero, so the operator stays positive definite under
//! compression; the force is exact.

use super::spring::{Ends, Spring, follow, measure, pull, rest_length};
use super::sweep::{Pass, sweep};
use super::symmetric::{self, Symmetric};
use super::{Problem, Work, operator, volume};
use crate::lanes::{Lanes, blocks, run_on};
use crate::lattice::{DIRECTIONS, Field, Tissue};
use crate::math::DT;

/// Fills residual, operator and inverse diagonal for the displacement `work.step` within the tick; the points' force is not among it.
#[inline(always)]
pub(super) fn linearise<L: Lanes, const N: usize>(
    lanes: L,
    problem: &Problem<'_, N>,
    load: &Field<N>,
    tissue: &Tissue<N>,
    work: &mut Work<N>,
) {
    assemble::<L, 6, N>(lanes, (problem, load), tissue, work);
    if problem.material.volume {
        volume::linearise(lanes, problem.lattice, work);
    }
    if let Some(faces) = problem.faces {
        let Work {
            place,
            residual,
            contact,
            inverse_diagonal,
            ..
        } = work;
        operator::meet(faces, place, (residual, contact), inverse_diagonal);
    }
}

/// The same with the inverse of each node's own 3 × 3 block of the operator instead of that of its diagonal; voxels count in it as
/// [`volume::linearise_blocks`] says.
#[inline(always)]
pub(super) fn linearise_blocks<L: Lanes, const N: usize>(
    lanes: L,
    problem: &Problem<'_, N>,
    load: &Field<N>,
    tissue: &Tissue<N>,
    work: &mut Work<N>,
) {
    if problem.material.volume {
        advance_place(lanes, problem.lattice.len(), tissue, work);
        volume::linearise_blocks(lanes, problem.lattice, work);
    }
    assemble::<L, 9, N>(lanes, (problem, load), tissue, work);
    if let Some(faces) = problem.faces {
        let Work {
            place,
            residual,
            contact,
            inverse_block,
            ..
        } = work;
        operator::meet(faces, place, (residual, contact), inverse_block);
    }
}

/// Springs and masses; with 6 numbers a spring the inverse diagonal, with 9 the inverse blocks.
#[inline(always)]
fn assemble<L: Lanes, const K: usize, const N: usize>(
    lanes: L,
    (problem, load): (&Problem<'_, N>, &Field<N>),
    tissue: &Tissue<N>,
    work: &mut Work<N>,
) where
    for<'a> Linearise<'a, N>: Pass<L, K>,
{
    advance_place(lanes, problem.lattice.len(), tissue, work);
    let Work {
        given,
        step,
        place,
        residual,
        inverse_diagonal,
        inverse_block,
        axial,
        transverse,
        ..
    } = work;
    let mut pass = Linearise {
        problem,
        load,
        velocity: &tissue.velocity,
        step,
        place,
        residual,
        inverse_diagonal,
        inverse_block,
        axial,
        transverse,
    };
    sweep(lanes, problem.lattice, given, &mut pass);
}

/// `work.place` = displacement from rest at the end of `work.step`.
#[inline(always)]
pub(super) fn advance_place<L: Lanes, const N: usize>(lanes: L, n: usize, tissue: &Tissue<N>, work: &mut Work<N>) {
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
    step: &'a Field<N>,
    place: &'a Field<N>,
    residual: &'a mut Field<N>,
    inverse_diagonal: &'a mut Field<N>,
    inverse_block: &'a mut Symmetric<N>,
    axial: &'a mut [Field<N>; DIRECTIONS],
    transverse: &'a mut [[f32; N]; DIRECTIONS],
}

impl<const N: usize> Linearise<'_, N> {
    /// What springs pull their lower nodes with, and their operator g gᵀ + b I, which is stored: g and b.
    #[inline(always)]
    fn spring<L: Lanes, const D: usize>(
        &mut self,
        lanes: L,
        near: [L::F; 3],
        [at, far]: [usize; 2],
    ) -> ([L::F; 3], [L::F; 3], L::F) {
        let ends = [near, lanes.vector(self.place, far)];
        let tangent = tangent::<L, D, N>(lanes, self.problem, [at, far], (ends, self.step));
        let axial = axial(lanes, tangent.unit, tangent.along, tangent.across);
        lanes.store(tangent.across, &mut self.transverse[D], at);
        for c in 0..3 {
            lanes.store(axial[c], &mut self.axial[D][c], at);
        }
        (tangent.pull, axial, tangent.across)
    }

    /// Stores the residual under what the springs pull with; gives the inertia [N/m], and whether the nodes move.
    #[inline(always)]
    fn node<L: Lanes>(&mut self, lanes: L, at: usize, pull: [L::F; 3]) -> [L::F; 2] {
        let free = lanes.load(&self.problem.lattice.free, at);
        let moved = (lanes.vector(self.step, at), lanes.vector(self.velocity, at));
        let [fx, fy, fz, inertia] = inertial(lanes, self.problem, at, moved);
        let fall = [fx, fy, fz];
        for c in 0..3 {
            let force = lanes.load(&self.load[c], at) + pull[c];
            lanes.store((force - fall[c]) * free, &mut self.residual[c], at);
        }
        [inertia, free]
    }
}

/// m (u − dt v)/dt² + α m u/dt of nodes that move by `step` within the tick [N], and m (1/dt² + α/dt) [N/m].
#[inline(always)]
pub(super) fn inertial<L: Lanes, const N: usize>(
    lanes: L,
    problem: &Problem<'_, N>,
    at: usize,
    (step, velocity): ([L::F; 3], [L::F; 3]),
) -> [L::F; 4] {
    let mass = lanes.load(&problem.lattice.mass, at);
    let (inertia, drag) = (1.0 / (DT * DT), problem.material.mass_damping / DT);
    let mut fall = [mass * lanes.splat(inertia + drag); 4];
    for c in 0..3 {
        let glide = step[c] - lanes.splat(DT) * velocity[c];
        fall[c] = mass * (lanes.splat(inertia) * glide + lanes.splat(drag) * step[c]);
    }
    fall
}

/// Springs at the linearisation.
#[derive(Clone, Copy)]
pub(super) struct Tangent<F> {
    /// What they pull their lower nodes with [N].
    pub(super) pull: [F; 3],
    /// Direction, from the lower node.
    pub(super) unit: [F; 3],
    /// Strain.
    pub(super) strain: F,
    /// Axial stiffness of the dashpots alone [N/m].
    pub(super) viscous: F,
    /// Axial stiffness [N/m].
    pub(super) along: F,
    /// Transverse stiffness T/l ≥ 0 [N/m].
    pub(super) across: F,
}

/// Springs of direction `D` from nodes `at…` to `far…` whose ends have moved by `step` within the tick, to the displacements `ends` from rest.
#[inline(always)]
pub(super) fn tangent<L: Lanes, const D: usize, const N: usize>(
    lanes: L,
    problem: &Problem<'_, N>,
    [at, far]: [usize; 2],
    (ends, step): (Ends<L::F>, &Field<N>),
) -> Tangent<L::F> {
    let (lattice, material) = (problem.lattice, problem.material);
    let [near, there] = ends;
    let Spring {
        along,
        length,
        square,
        product,
    } = measure::<L, D>(lanes, lattice.pitch, near, there);
    let rest = rest_length::<D>(lattice.pitch);
    let one = lanes.splat(1.0);
    // 1/l and q/(l + L) from one division.
    let inverse_product = one / product;
    let inverse = inverse_product * (length + lanes.splat(rest));
    let stretch = square * inverse_product * length;
    let strain = stretch * lanes.splat(1.0 / rest);
    let load = follow::<L, D, N>(lanes, (lattice, material), at, strain);
    let [x, y, z] = along;
    let unit = [x * inverse, y * inverse, z * inverse];
    let tension = load.tension * lanes.splat(rest);
    let turn = lanes.where_positive(tension, tension) * inverse;
    let (mut pull, mut viscous) = (tension, lanes.splat(0.0));
    if material.spring_damping > 0.0 {
        viscous = lanes.splat(material.spring_damping / DT) * load.stiffness;
        let mut rate = lanes.splat(0.0);
        for c in 0..3 {
            rate = rate + unit[c] * (lanes.load(&step[c], far) - lanes.load(&step[c], at));
        }
        pull = pull + viscous * rate;
    }
    Tangent {
        pull: [unit[0] * pull, unit[1] * pull, unit[2] * pull],
        unit,
        strain,
        viscous,
        along: load.slope + viscous,
        across: turn,
    }
}

/// Direction times the root of the axial stiffness less the transverse one, or of nothing where that is more [√(N/m)].
#[inline(always)]
pub(super) fn axial<L: Lanes>(lanes: L, [x, y, z]: [L::F; 3], along: L::F, across: L::F) -> [L::F; 3] {
    let root = lanes.root(lanes.larger(along - across, lanes.splat(0.0)));
    [x * root, y * root, z * root]
}

impl<L: Lanes, const N: usize> Pass<L, 6> for Linearise<'_, N> {
    type Near = [L::F; 3];

    #[inline(always)]
    fn near(&self, lanes: L, at: usize) -> Self::Near {
        lanes.vector(self.place, at)
    }

    #[inline(always)]
    fn spring<const D: usize>(&mut self, lanes: L, near: Self::Near, at: usize, far: usize) -> [L::F; 6] {
        let (pull, axial, across) = Self::spring::<L, D>(self, lanes, near, [at, far]);
        let [px, py, pz] = pull;
        let [x, y, z] = axial;
        [px, py, pz, x * x + across, y * y + across, z * z + across]
    }

    #[inline(always)]
    fn node(&mut self, lanes: L, at: usize, begin: [L::F; 6], end: [L::F; 6]) {
        let pull = [begin[0] - end[0], begin[1] - end[1], begin[2] - end[2]];
        let [inertia, free] = Self::node(self, lanes, at, pull);
        for c in 0..3 {
            let diagonal = inertia + (begin[c + 3] + end[c + 3]);
            let inverse = lanes.where_positive(free, lanes.splat(1.0) / diagonal);
            lanes.store(inverse, &mut self.inverse_diagonal[c], at);
        }
    }
}

impl<L: Lanes, const N: usize> Pass<L, 9> for Linearise<'_, N> {
    type Near = [L::F; 3];

    #[inline(always)]
    fn near(&self, lanes: L, at: usize) -> Self::Near {
        lanes.vector(self.place, at)
    }

    #[inline(always)]
    fn spring<const D: usize>(&mut self, lanes: L, near: Self::Near, at: usize, far: usize) -> [L::F; 9] {
        let (pull, axial, across) = Self::spring::<L, D>(self, lanes, near, [at, far]);
        symmetric::with_force::<L>(pull, symmetric::of_spring::<L>(axial, across))
    }

    #[inline(always)]
    fn node(&mut self, lanes: L, at: usize, begin: [L::F; 9], end: [L::F; 9]) {
        let (mut pull, mut block) = symmetric::at_node::<L>(begin, end);
        if self.problem.material.volume {
            symmetric::add(&mut pull, lanes.vector(self.residual, at));
            symmetric::add(&mut block, symmetric::load(lanes, self.inverse_block, at));
        }
        let [inertia, free] = Self::node(self, lanes, at, pull);
        let inverse = symmetric::invert(lanes, free, symmetric::plus::<L>(block, inertia));
        symmetric::store(lanes, inverse, self.inverse_block, at);
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
