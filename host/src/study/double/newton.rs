//! The displacement at which a sum of elastic energy and a quadratic of the displacement is least: Newton's method with line search.

use super::tangent::{Form, Tangent};
use super::{Field, Model};

/// Residual of a converged solve, by component [N].
const CONVERGED: f64 = 1e-11;
/// Newton steps after which there is no hope.
const STEPS_MAX: usize = 200;
/// How far one linear solve brings the residual down: the next step's curvature takes over from there.
const FORCING: f64 = 1e-4;

/// The quadratic ½ c m |u − y|² at every node: inertia, or nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inertia<'a> {
    /// c [1/s²].
    pub(super) rate: f64,
    /// y [m].
    pub(super) toward: &'a Field,
}

/// Newton's method does not get there.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the reference in double precision does not converge: a residual of {residual_n:.1e} N is left after {STEPS_MAX} steps"
)]
pub struct NoEquilibrium {
    /// Largest component of the residual [N].
    pub residual_n: f64,
}

impl Model {
    /// Moves the free nodes of `at` to where the energy has no slope.
    pub(super) fn settle(&self, at: &mut Field, inertia: Inertia<'_>) -> Result<(), NoEquilibrium> {
        let mut residual = Field::zeros(self.len());
        let mut energy = self.residual(at, inertia, &mut residual);
        let mut tried = at.clone();
        let mut next = residual.clone();
        for _ in 0..STEPS_MAX {
            let left = residual.largest();
            if left <= CONVERGED {
                return Ok(());
            }
            let enough = (left * FORCING).max(0.1 * CONVERGED);
            let step = [Form::Exact, Form::Definite]
                .into_iter()
                .find_map(|form| Tangent::new(self, at, inertia.rate, form).solve(&residual, enough))
                .ok_or(NoEquilibrium { residual_n: left })?;
            let mut part = 1.0;
            // Near the end the energy's digits are used up, and the residual alone can tell.
            for _ in 0..40 {
                tried.clone_from(at);
                tried.blend(1.0, part, &step);
                let there = self.residual(&tried, inertia, &mut next);
                if there < energy || next.largest() < left {
                    energy = there;
                    break;
                }
                part *= 0.5;
            }
            std::mem::swap(at, &mut tried);
            std::mem::swap(&mut residual, &mut next);
        }
        Err(NoEquilibrium {
            residual_n: residual.largest(),
        })
    }

    /// Fills `residual` with the negative slope of the energy at the free nodes [N], and gives the energy [J].
    fn residual(&self, at: &Field, inertia: Inertia<'_>, residual: &mut Field) -> f64 {
        let mut energy = self.elastic(at, residual);
        let parts = residual.parts.iter_mut().zip(&at.parts).zip(&inertia.toward.parts);
        for ((r, u), y) in parts {
            for (((r, u), y), mass) in r.iter_mut().zip(u).zip(y).zip(&self.mass) {
                let pull = inertia.rate * mass * (u - y);
                *r -= pull;
                energy += 0.5 * pull * (u - y);
            }
        }
        residual.clear_held(&self.free);
        energy
    }
}
