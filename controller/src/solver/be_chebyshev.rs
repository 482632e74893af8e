//! Backward Euler with one Newton step and a fixed number of iterations of the Chebyshev semi-iteration (Golub & Varga 1961): no inner
//! products, so nothing is summed over the lattice.
//!
//! The preconditioner M is the operator's 3 × 3 block at each node, with the coupling points. Then no eigenvalue of M⁻¹A is above 2 in
//! any state of the tissue: a spring's energy is at most twice the sum of what each of its ends alone would give it (and a voxel's at most
//! eight times that of its corners, whose blocks are taken four times). The diagonal alone
//! has no such bound, since springs that stiffen in one direction leave it.

use super::points::Points;
use super::step::{PREDICTED, add_step, predict_step, restrain};
use super::sweep::{Pass, sweep};
use super::symmetric::Symmetric;
use super::{Problem, Solver, Work, assembly, guard, operator, spectrum, symmetric, volume};
use crate::coupling::POINTS;
use crate::lanes::{Lanes, blocks, run_on};
use crate::lattice::{DIRECTIONS, Field, Tissue};
use crate::math::Vec3;

/// Largest eigenvalue of M⁻¹A, in any state.
pub(super) const HIGHEST: f32 = 2.0;

/// Largest part of an error on the interval that may be left, with its sign turned.
///
/// A tick starts from x + dt v, so a stiff mode of which −p is left goes by z² + 2pz − p = 0: it grows where p > 1/3, which too wide an
/// interval with few iterations gives. Below the interval errors only fall more slowly.
const RIPPLE: f32 = 0.14;

/// The method's dial, and what it needs to know of the lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeChebyshev {
    /// Iterations of the linear solve: degree of the polynomial, at least 1.
    pub iterations: u16,
    /// Lower end of the interval of eigenvalues of M⁻¹A that the polynomial is best on, above 0 and below 2.
    pub lowest: f32,
}

impl<const N: usize> Solver<N> for BeChebyshev {
    fn advance(
        &self,
        problem: &Problem<'_, N>,
        load: &Field<N>,
        tissue: &mut Tissue<N>,
        work: &mut Work<N>,
    ) -> [Vec3; POINTS] {
        run_on!(problem.level, lanes => self.advance_on(lanes, problem, (load, tissue, work)))
    }
}

impl BeChebyshev {
    /// For the lattice of `problem`; `work` is used as scratch.
    ///
    /// The interval begins at the slowest mode of the lattice at rest, but never so low that 1/T_n is above `RIPPLE` on it.
    pub fn new<const N: usize>(iterations: u16, problem: &Problem<'_, N>, work: &mut Work<N>) -> Self {
        // T_n((h + l)/(h − l)) = 1/RIPPLE for l = h tanh²(arcosh(1/RIPPLE)/(2n)).
        let root = libm::tanhf(0.5 * libm::acoshf(1.0 / RIPPLE) / f32::from(iterations));
        let least = HIGHEST * root * root;
        Self {
            iterations,
            lowest: spectrum::slowest(problem, work).max(least).min(0.9 * HIGHEST),
        }
    }

    #[inline(always)]
    fn advance_on<L: Lanes, const N: usize>(
        &self,
        lanes: L,
        problem: &Problem<'_, N>,
        (load, tissue, work): (&Field<N>, &mut Tissue<N>, &mut Work<N>),
    ) -> [Vec3; POINTS] {
        let n = problem.lattice.len();
        predict_step(lanes, n, tissue, work);
        let predicted = problem.coupling.gather(&work.step);
        restrain(lanes, problem.lattice, (1.0, PREDICTED), work);
        let started = problem.coupling.gather(&work.step);
        assembly::linearise_blocks(lanes, problem, load, tissue, work);
        operator::load_points(problem, &core::array::from_fn(|p| started[p] - predicted[p]), work);
        let points = Points::new(problem.coupling, &work.inverse_block);
        let (middle, half) = (0.5 * (HIGHEST + self.lowest), 0.5 * (HIGHEST - self.lowest));
        let mut ratio = half / middle;
        begin(lanes, n, 1.0 / middle, work);
        correct(points.as_ref(), 1.0 / middle, work);
        for _ in 1..self.iterations {
            let next = 1.0 / (2.0 * middle / half - ratio);
            let (keep, turn) = (ratio * next, 2.0 * next / half);
            ratio = next;
            if problem.material.volume {
                volume::reduce(lanes, problem.lattice, work);
            }
            let Work {
                search,
                contact,
                residual,
                ..
            } = &mut *work;
            // The points and the wound answer d; the sweep adds what the springs do.
            operator::tie(problem, points.as_ref(), (search, contact), (-1.0, residual));
            iterate(lanes, problem, [keep, turn], work);
            correct(points.as_ref(), turn, work);
        }
        add_step(lanes, n, &mut work.step, &work.search);
        let reached = problem.coupling.gather(&work.step);
        let moved = core::array::from_fn(|p| reached[p] - predicted[p]);
        guard::take(lanes, (problem, load), &moved, tissue, work)
    }
}

/// d = `turn`·D⁻¹ r.
#[inline(always)]
fn begin<L: Lanes, const N: usize>(lanes: L, n: usize, turn: f32, work: &mut Work<N>) {
    for at in blocks::<L, N>(n) {
        let residual = lanes.vector(&work.residual, at);
        let scaled = symmetric::times::<L>(symmetric::load(lanes, &work.inverse_block, at), residual);
        for c in 0..3 {
            lanes.store(lanes.splat(turn) * scaled[c], &mut work.search[c], at);
        }
    }
}

/// Takes from d what makes `turn`·D⁻¹ r in it `turn`·M⁻¹ r.
fn correct<const N: usize>(points: Option<&Points<'_>>, turn: f32, work: &mut Work<N>) {
    if let Some(points) = points {
        let (back, _) = points.take(&work.residual, &work.inverse_block);
        points.give(&back.map(|b| b * turn), &work.inverse_block, &mut work.search);
    }
}

/// u += d, r −= (m(1/dt² + α/dt) + K) d, then d = `keep`·d + `turn`·D⁻¹ r.
#[inline(always)]
fn iterate<L: Lanes, const N: usize>(lanes: L, problem: &Problem<'_, N>, [keep, turn]: [f32; 2], work: &mut Work<N>) {
    let Work {
        given,
        step,
        residual,
        search,
        inverse_block,
        axial,
        transverse,
        ..
    } = work;
    let mut pass = Iterate {
        mass: &problem.lattice.mass,
        inertia: operator::inertia(problem),
        keep,
        turn,
        step,
        residual,
        search,
        inverse_block,
        axial,
        transverse,
    };
    sweep(lanes, problem.lattice, given, &mut pass);
}

struct Iterate<'a, const N: usize> {
    mass: &'a [f32; N],
    inertia: f32,
    keep: f32,
    turn: f32,
    step: &'a mut Field<N>,
    residual: &'a mut Field<N>,
    /// A node's d is replaced once all springs that end there have used it.
    search: &'a mut Field<N>,
    inverse_block: &'a Symmetric<N>,
    axial: &'a [Field<N>; DIRECTIONS],
    transverse: &'a [[f32; N]; DIRECTIONS],
}

impl<L: Lanes, const N: usize> Pass<L, 3> for Iterate<'_, N> {
    type Near = [L::F; 3];

    #[inline(always)]
    fn near(&self, lanes: L, at: usize) -> Self::Near {
        lanes.vector(self.search, at)
    }

    #[inline(always)]
    fn spring<const D: usize>(&mut self, lanes: L, near: Self::Near, at: usize, far: usize) -> [L::F; 3] {
        let ends = [near, lanes.vector(self.search, far)];
        operator::answer::<L, D, N>(lanes, (self.axial, self.transverse), at, ends)
    }

    #[inline(always)]
    fn node(&mut self, lanes: L, at: usize, begin: [L::F; 3], end: [L::F; 3]) {
        let inertia = lanes.load(self.mass, at) * lanes.splat(self.inertia);
        let search = lanes.vector(self.search, at);
        let mut residual = search;
        for c in 0..3 {
            let step = lanes.load(&self.step[c], at) + search[c];
            lanes.store(step, &mut self.step[c], at);
            residual[c] = lanes.load(&self.residual[c], at) - (inertia * search[c] - (begin[c] - end[c]));
            lanes.store(residual[c], &mut self.residual[c], at);
        }
        let scaled = symmetric::times::<L>(symmetric::load(lanes, self.inverse_block, at), residual);
        for c in 0..3 {
            let next = lanes.splat(self.keep) * search[c] + lanes.splat(self.turn) * scaled[c];
            lanes.store(next, &mut self.search[c], at);
        }
    }
}
