//! Backward Euler with a fixed number of Newton steps, each a fixed number of preconditioned conjugate gradients.

use super::operator;
use super::points::Points;
use super::step::{PREDICTED, add_step, predict_step, restrain};
use super::{Problem, Solver, Work, assembly, guard};
use crate::coupling::POINTS;
use crate::lanes::{Lanes, blocks, run_on};
use crate::lattice::{Field, Tissue};
use crate::math::Vec3;

/// Newton steps before the last only bring springs to their segments, for which this part of the iterations is enough.
const EARLIER: u16 = 3;
/// rᵀ M⁻¹ r below which what is left is rounding [J]: sums of squares of single numbers lose their digits from there down, and a solve that
/// goes on there may diverge.
const ROUNDING: f32 = 1e-34;

/// The method's dials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BePcg {
    /// Conjugate-gradient iterations of the last Newton step; those before take a third.
    pub iterations: u16,
    /// Newton steps a tick.
    pub newton: u16,
}

impl<const N: usize> Solver<N> for BePcg {
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

impl BePcg {
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
        let mut moved: [Vec3; POINTS] = core::array::from_fn(|p| started[p] - predicted[p]);
        for round in 1..=self.newton {
            assembly::linearise(lanes, problem, load, tissue, work);
            operator::load_points(problem, &moved, work);
            let iterations = match round < self.newton {
                true => self.iterations.div_ceil(EARLIER),
                false => self.iterations,
            };
            solve(lanes, problem, iterations, work);
            let further = problem.coupling.gather(&work.solution);
            moved.iter_mut().zip(&further).for_each(|(m, f)| *m += f);
            add_step(lanes, n, &mut work.step, &work.solution);
        }
        guard::take(lanes, (problem, load), &moved, tissue, work)
    }
}

/// `work.solution` = A⁻¹ `work.residual`, approximately; the residual is used up.
#[inline(always)]
fn solve<L: Lanes, const N: usize>(lanes: L, problem: &Problem<'_, N>, iterations: u16, work: &mut Work<N>) {
    let n = problem.lattice.len();
    let points = Points::new(problem.coupling, &work.inverse_diagonal);
    for array in work
        .solution
        .iter_mut()
        .chain(&mut work.search)
        .chain(&mut work.product)
    {
        array.iter_mut().take(n).for_each(|x| *x = 0.0);
    }
    let (mut rz, back) = reduce(lanes, n, points.as_ref(), 0.0, work);
    turn(lanes, n, (points.as_ref(), &back), [0.0, 0.0], work);
    for _ in 0..iterations {
        let curvature = operator::apply(lanes, problem, points.as_ref(), work);
        // A residual that is rounding already ends the progress but not the loop.
        let along = if curvature > ROUNDING && rz > ROUNDING {
            rz / curvature
        } else {
            0.0
        };
        let (next, back) = reduce(lanes, n, points.as_ref(), along, work);
        let keep = if rz > ROUNDING { next / rz } else { 0.0 };
        rz = next;
        turn(lanes, n, (points.as_ref(), &back), [along, keep], work);
    }
}

/// r −= `along`·q; gives rᵀ M⁻¹ r, and what the points take of D⁻¹ r to make M⁻¹ r.
#[inline(always)]
fn reduce<L: Lanes, const N: usize>(
    lanes: L,
    n: usize,
    points: Option<&Points<'_>>,
    along: f32,
    work: &mut Work<N>,
) -> (f32, [Vec3; POINTS]) {
    let mut sum = lanes.nothing();
    let parts = work.residual.iter_mut().zip(&work.product).zip(&work.inverse_diagonal);
    for ((residual, product), inverse) in parts {
        for at in blocks::<L, N>(n) {
            let left = lanes.load(residual, at) - lanes.splat(along) * lanes.load(product, at);
            lanes.store(left, residual, at);
            sum = lanes.add(sum, at, left * left * lanes.load(inverse, at));
        }
    }
    let whole = lanes.total(sum);
    points.map_or((whole, [Vec3::zeros(); POINTS]), |points| {
        let (back, taken) = points.take(&work.residual, &work.inverse_diagonal);
        (whole - taken, back)
    })
}

/// x += `along`·p, then p = M⁻¹ r + `keep`·p.
#[inline(always)]
fn turn<L: Lanes, const N: usize>(
    lanes: L,
    n: usize,
    (points, back): (Option<&Points<'_>>, &[Vec3; POINTS]),
    [along, keep]: [f32; 2],
    work: &mut Work<N>,
) {
    let parts = work.solution.iter_mut().zip(&mut work.search);
    for ((solution, search), (residual, inverse)) in parts.zip(work.residual.iter().zip(&work.inverse_diagonal)) {
        for at in blocks::<L, N>(n) {
            let before = lanes.load(search, at);
            let sum = lanes.load(solution, at) + lanes.splat(along) * before;
            lanes.store(sum, solution, at);
            let scaled = lanes.load(residual, at) * lanes.load(inverse, at);
            lanes.store(scaled + lanes.splat(keep) * before, search, at);
        }
    }
    if let Some(points) = points {
        points.give(back, &work.inverse_diagonal, &mut work.search);
    }
}
