//! Backward Euler with a fixed number of Newton steps, each a fixed number of preconditioned conjugate gradients.

use super::operator::{self, Points};
use super::reduce::dot;
use super::{Problem, Solver, Work, assembly};
use crate::coupling::POINTS;
use crate::lattice::{Field, Tissue};
use crate::math::{DT, Vec3};

/// The method's dials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BePcg {
    /// Conjugate-gradient iterations of one linear solve.
    pub iterations: u16,
    /// Newton steps a tick.
    pub newton: u16,
}

/// A displacement within a tick, and one from rest, below which a node is still [m]: a thousandth of an atom. Motion that dies
/// out would otherwise end in subnormal numbers, which cost a hundred times the time.
const STILL: f32 = 1e-15;
const REST: f32 = 1e-13;

impl<const N: usize> Solver<N> for BePcg {
    fn advance(
        &self,
        problem: &Problem<'_, N>,
        load: &Field<N>,
        tissue: &mut Tissue<N>,
        work: &mut Work<N>,
    ) -> [Vec3; POINTS] {
        let n = problem.lattice.len();
        for (step, velocity) in work.step.iter_mut().zip(&tissue.velocity) {
            for (u, v) in step.iter_mut().zip(velocity).take(n) {
                *u = DT * v;
            }
        }
        let mut moved = [Vec3::zeros(); POINTS];
        for _ in 0..self.newton {
            // The coupling is stated at the predicted place; what the points have moved since changes its force.
            let mut coupling = *problem.coupling;
            let given = problem.coupling.product(&moved);
            coupling.force.iter_mut().zip(&given).for_each(|(f, g)| *f -= g);
            let now = Problem {
                coupling: &coupling,
                ..*problem
            };
            assembly::linearise(&now, load, tissue, work);
            solve(&now, self.iterations, work);
            for (step, solution) in work.step.iter_mut().zip(&work.solution) {
                step.iter_mut().zip(solution).take(n).for_each(|(u, d)| *u += d);
            }
            let further = coupling.gather(&work.solution);
            moved.iter_mut().zip(&further).for_each(|(m, f)| *m += f);
        }
        let parts = tissue.displacement.iter_mut().zip(&mut tissue.velocity).zip(&work.step);
        for ((displacement, velocity), step) in parts {
            for ((x, v), u) in displacement.iter_mut().zip(velocity).zip(step).take(n) {
                let u = if u.abs() < STILL { 0.0 } else { *u };
                let place = *x + u;
                *x = if place.abs() < REST { 0.0 } else { place };
                *v = u / DT;
            }
        }
        moved
    }
}

/// `work.solution` = A⁻¹ `work.residual`, approximately; the residual is used up.
fn solve<const N: usize>(problem: &Problem<'_, N>, iterations: u16, work: &mut Work<N>) {
    let n = problem.lattice.len();
    let points = Points::new(problem.coupling, &work.inverse_diagonal);
    for solution in &mut work.solution {
        solution.iter_mut().take(n).for_each(|x| *x = 0.0);
    }
    operator::precondition(points.as_ref(), n, work);
    for (search, scaled) in work.search.iter_mut().zip(&work.scaled) {
        search.iter_mut().zip(scaled).take(n).for_each(|(p, z)| *p = *z);
    }
    let mut rz = dot(&work.residual, &work.scaled, n);
    for _ in 0..iterations {
        operator::apply(problem, points.as_ref(), work);
        let curvature = dot(&work.search, &work.product, n);
        // A residual that is zero already, or rounding, ends the progress but not the loop.
        let along = if curvature > 0.0 && rz > 0.0 {
            rz / curvature
        } else {
            0.0
        };
        let steps = work
            .solution
            .iter_mut()
            .zip(&mut work.residual)
            .zip(work.search.iter().zip(&work.product));
        for ((x, r), (p, q)) in steps {
            for ((x, r), (p, q)) in x.iter_mut().zip(r.iter_mut()).zip(p.iter().zip(q)).take(n) {
                *x += along * p;
                *r -= along * q;
            }
        }
        operator::precondition(points.as_ref(), n, work);
        let next = dot(&work.residual, &work.scaled, n);
        let keep = if rz > 0.0 { next / rz } else { 0.0 };
        rz = next;
        for (search, scaled) in work.search.iter_mut().zip(&work.scaled) {
            search
                .iter_mut()
                .zip(scaled)
                .take(n)
                .for_each(|(p, z)| *p = z + keep * *p);
        }
    }
}
