//! Backward Euler by vertex block descent (Chen et al. 2024) of the incremental potential
//! m|u − dt v|²/(2 dt²) + α m|u|²/(2 dt) + W(x + u) − u·load over the displacement u within the tick, in two colours.
//!
//! Every spring joins nodes of opposite parity of i + j + k, so all nodes of one parity are independent of each other and a half sweep
//! moves them at once: each by its own 3 × 3 system, together with the coupling points, which alone tie them (Woodbury). With the blocks
//! of [`majorise`] no half sweep raises the potential at ω = 1; over-relaxation by 1 < ω < 2 brings smooth errors down faster.

use super::assembly::{Tangent, advance_place, axial, inertial, tangent};
use super::points::Points;
use super::spring::{rest_length, steepest};
use super::step::{PREDICTED, predict_step, restrain, take_step};
use super::sweep::{Pass, sweep};
use super::symmetric::{SYMMETRIC, Symmetric};
use super::{Problem, Solver, Work, symmetric, volume};
use crate::coupling::{Kernel, POINTS};
use crate::lanes::{Lanes, blocks, run_on};
use crate::lattice::{Field, Tissue, at};
use crate::math::Vec3;
use crate::wound::Faces;

/// The method's dials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vbd {
    /// Sweeps a tick over both colours.
    pub sweeps: u16,
    /// Over-relaxation ω of all sweeps but the first, above 0 and below 2.
    pub omega: f32,
}

/// How far a half sweep may move a node and be sure to lower the potential, over the pitch.
const REACH: f32 = 0.005;
/// Even nodes, then odd ones.
const COLOURS: [f32; 2] = [1.0, -1.0];

impl<const N: usize> Solver<N> for Vbd {
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

impl Vbd {
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
        advance_place(lanes, n, tissue, work);
        begin(lanes, problem, load, work);
        let mut points = [None, None];
        for sweep in 0..self.sweeps {
            let omega = if sweep == 0 { 1.0 } else { self.omega };
            for (colour, points) in COLOURS.into_iter().zip(&mut points) {
                press(problem, load, &predicted, work);
                descend(lanes, problem, [colour, omega], tissue, work);
                // The points' part changes little within a tick, so it is factored once for each colour.
                if sweep == 0 {
                    *points = Points::new(problem.coupling, &work.inverse_block);
                }
                if let Some(points) = points {
                    hold(points, omega, tissue, work);
                }
            }
        }
        let reached = problem.coupling.gather(&work.step);
        take_step(lanes, n, tissue, work);
        core::array::from_fn(|p| reached[p] - predicted[p])
    }
}

/// `work.solution` = load; `work.search` x = 1 at even nodes that move, −1 at odd ones, 0 at others; `work.search` y = 0, the wound's
/// stiffness.
#[inline(always)]
fn begin<L: Lanes, const N: usize>(lanes: L, problem: &Problem<'_, N>, load: &Field<N>, work: &mut Work<N>) {
    let lattice = problem.lattice;
    let [colour, stiffness, _] = &mut work.search;
    for ([i, j, k], index) in lattice.nodes() {
        if let (Some(colour), Some(free)) = (colour.get_mut(index), lattice.free.get(index)) {
            *colour = if (i + j + k).is_multiple_of(2) { *free } else { -free };
        }
    }
    for at in blocks::<L, N>(lattice.len()) {
        lanes.store(lanes.splat(0.0), stiffness, at);
        for c in 0..3 {
            lanes.store(lanes.load(&load[c], at), &mut work.solution[c], at);
        }
    }
}

/// `work.solution` = load and what points and wound faces push with at the present step, at their nodes.
fn press<const N: usize>(problem: &Problem<'_, N>, load: &Field<N>, predicted: &[Vec3; POINTS], work: &mut Work<N>) {
    let Work {
        solution,
        search: [_, stiffness, _],
        step,
        place,
        ..
    } = work;
    let coupling = problem.coupling;
    for (node, _) in coupling.kernels.iter().flat_map(Kernel::iter) {
        set(solution, node, at(load, node));
    }
    if let Some(faces) = problem.faces {
        meet(faces, place, (load, solution), stiffness);
    }
    let now = coupling.gather(step);
    let held = coupling.product(&core::array::from_fn(|p| now[p] - predicted[p]));
    coupling.scatter(&core::array::from_fn(|p| coupling.force[p] - held[p]), solution);
}

/// Pairs of the wound's nodes that overlap push each other along x.
fn meet<const N: usize>(
    faces: &Faces,
    [place, ..]: &Field<N>,
    ([load, ..], [pushed, ..]): (&Field<N>, &mut Field<N>),
    stiffness: &mut [f32; N],
) {
    // Nodes of one colour move at once: their spring is majorised by twice itself at each of them.
    let share = if faces.across().is_multiple_of(2) { 2.0 } else { 1.0 };
    for (left, right) in faces.pairs() {
        let (Some(a), Some(b)) = (place.get(left), place.get(right)) else {
            continue;
        };
        let width = faces.width(*a, *b);
        let push = faces.penalty * width.min(0.0);
        let steep = if width < 0.0 { share * faces.penalty } else { 0.0 };
        for (node, push) in [(left, push), (right, -push)] {
            if let (Some(load), Some(pushed), Some(stiffness)) =
                (load.get(node), pushed.get_mut(node), stiffness.get_mut(node))
            {
                *pushed = load + push;
                *stiffness = steep;
            }
        }
    }
}

/// The points' part of a half sweep, over the nodes whose block is not zero.
fn hold<const N: usize>(points: &Points<'_>, omega: f32, tissue: &Tissue<N>, work: &mut Work<N>) {
    let Work {
        residual,
        inverse_block,
        step,
        place,
        ..
    } = work;
    let (back, _) = points.take(residual, inverse_block);
    points.give(&back.map(|b| b * omega), inverse_block, step);
    for (node, _) in points.coupling.kernels.iter().flat_map(Kernel::iter) {
        set(place, node, at(&tissue.displacement, node) + at(step, node));
    }
}

fn set<const N: usize>(field: &mut Field<N>, node: usize, v: Vec3) {
    for (component, x) in field.iter_mut().zip(v.iter()) {
        if let Some(component) = component.get_mut(node) {
            *component = *x;
        }
    }
}

/// Block of springs that is no less than their energy's curvature at either end while that end moves by up to [`REACH`].
///
/// Axially the steepest slope within reach. Across T/l where the spring pulls (a push would only lower the energy), and for the length
/// that a move across adds 2 r/L of the slope, r the reach: (l + e)² with e ≤ δ²/2(l − r) grows by less.
#[inline(always)]
fn majorise<L: Lanes, const D: usize, const N: usize>(
    lanes: L,
    problem: &Problem<'_, N>,
    at: usize,
    tangent: &Tangent<L::F>,
) -> [L::F; SYMMETRIC] {
    let (lattice, material) = (problem.lattice, problem.material);
    let reach = REACH * lattice.pitch / rest_length::<D>(lattice.pitch);
    let slope = steepest::<L, D, N>(lanes, (lattice, material), at, (tangent.strain, reach));
    let across = tangent.across + lanes.splat(2.0 * reach) * slope;
    let axial = axial(lanes, tangent.unit, slope + tangent.viscous, across);
    symmetric::of_spring::<L>(axial, across)
}

/// A half sweep: the nodes of one colour go ω times as far as to the least of the potential's model.
#[inline(always)]
fn descend<L: Lanes, const N: usize>(
    lanes: L,
    problem: &Problem<'_, N>,
    [turn, omega]: [f32; 2],
    tissue: &Tissue<N>,
    work: &mut Work<N>,
) {
    if problem.material.volume {
        volume::linearise_blocks(lanes, problem.lattice, work);
    }
    let Work {
        given,
        step,
        place,
        residual,
        solution,
        search: [colour, stiffness, _],
        inverse_block,
        ..
    } = work;
    let mut pass = Descend {
        problem,
        tissue,
        load: solution,
        colour,
        turn,
        omega,
        stiffness,
        step,
        place,
        residual,
        inverse_block,
    };
    sweep(lanes, problem.lattice, given, &mut pass);
}

struct Descend<'a, const N: usize> {
    problem: &'a Problem<'a, N>,
    tissue: &'a Tissue<N>,
    load: &'a Field<N>,
    colour: &'a [f32; N],
    turn: f32,
    omega: f32,
    stiffness: &'a [f32; N],
    step: &'a mut Field<N>,
    /// A node is moved once all springs that end there have been measured.
    place: &'a mut Field<N>,
    residual: &'a mut Field<N>,
    inverse_block: &'a mut Symmetric<N>,
}

impl<L: Lanes, const N: usize> Pass<L, 9> for Descend<'_, N> {
    type Near = [L::F; 3];

    #[inline(always)]
    fn near(&self, lanes: L, at: usize) -> Self::Near {
        lanes.vector(self.place, at)
    }

    #[inline(always)]
    fn spring<const D: usize>(&mut self, lanes: L, near: Self::Near, at: usize, far: usize) -> [L::F; 9] {
        let ends = [near, lanes.vector(self.place, far)];
        let tangent = tangent::<L, D, N>(lanes, self.problem, [at, far], (ends, self.step));
        symmetric::with_force::<L>(tangent.pull, majorise::<L, D, N>(lanes, self.problem, at, &tangent))
    }

    #[inline(always)]
    fn node(&mut self, lanes: L, at: usize, begin: [L::F; 9], end: [L::F; 9]) {
        let (mut pull, mut block) = symmetric::at_node::<L>(begin, end);
        if self.problem.material.volume {
            symmetric::add(&mut pull, lanes.vector(self.residual, at));
            symmetric::add(&mut block, symmetric::load(lanes, self.inverse_block, at));
        }
        let (step, velocity) = (lanes.vector(self.step, at), lanes.vector(&self.tissue.velocity, at));
        let [fx, fy, fz, inertia] = inertial(lanes, self.problem, at, (step, velocity));
        let [lx, ly, lz] = lanes.vector(self.load, at);
        let residual = [lx + (pull[0] - fx), ly + (pull[1] - fy), lz + (pull[2] - fz)];
        let [xx, xy, xz, yy, yz, zz] = symmetric::plus::<L>(block, inertia);
        let block = [xx + lanes.load(self.stiffness, at), xy, xz, yy, yz, zz];
        let moves = lanes.load(self.colour, at) * lanes.splat(self.turn);
        let inverse = symmetric::invert(lanes, moves, block);
        symmetric::store(lanes, inverse, self.inverse_block, at);
        let further = symmetric::times::<L>(inverse, residual);
        for c in 0..3 {
            let step = step[c] + lanes.splat(self.omega) * further[c];
            lanes.store(residual[c], &mut self.residual[c], at);
            lanes.store(step, &mut self.step[c], at);
            let place = lanes.load(&self.tissue.displacement[c], at) + step;
            lanes.store(place, &mut self.place[c], at);
        }
    }
}
