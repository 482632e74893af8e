//! The solver that a scene asks for, with what it computes at build.

use super::spectrum::fewest_substeps;
use super::{BeChebyshev, BePcg, Explicit, Problem, Solver, Vbd, Work};
use crate::coupling::POINTS;
use crate::lattice::{Field, Tissue};
use crate::math::Vec3;
use sutura_shared::scene;

/// A solver that scenes may choose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Choice {
    /// Symplectic Euler in substeps.
    Explicit(Explicit),
    /// Backward Euler by conjugate gradients.
    BePcg(BePcg),
    /// Backward Euler by Chebyshev iteration.
    BeChebyshev(BeChebyshev),
    /// Backward Euler by vertex block descent.
    Vbd(Vbd),
}

/// Why a scene's solver cannot run its patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refused {
    /// Fewer explicit substeps than are stable at the steepest segment of every curve.
    Unstable {
        /// The smallest stable count.
        least: u16,
    },
}

impl Choice {
    /// The solver `asked` for, on the patch of `problem`; `work` is used as scratch.
    ///
    /// # Errors
    ///
    /// See [`Refused`].
    pub fn new<const N: usize>(
        asked: scene::Solver,
        problem: &Problem<'_, N>,
        work: &mut Work<N>,
    ) -> Result<Self, Refused> {
        match asked {
            scene::Solver::Explicit { substeps } => {
                let least = fewest_substeps(problem, work);
                match substeps {
                    0 => Ok(Self::Explicit(Explicit { substeps: least })),
                    _ if substeps < least => Err(Refused::Unstable { least }),
                    _ => Ok(Self::Explicit(Explicit { substeps })),
                }
            }
            scene::Solver::BePcg { iterations, newton } => Ok(Self::BePcg(BePcg { iterations, newton })),
            scene::Solver::BeChebyshev { iterations } => {
                Ok(Self::BeChebyshev(BeChebyshev::new(iterations, problem, work)))
            }
            scene::Solver::Vbd { sweeps, omega } => Ok(Self::Vbd(Vbd { sweeps, omega })),
        }
    }
}

impl<const N: usize> Solver<N> for Choice {
    fn advance(
        &self,
        problem: &Problem<'_, N>,
        load: &Field<N>,
        tissue: &mut Tissue<N>,
        work: &mut Work<N>,
    ) -> [Vec3; POINTS] {
        match self {
            Self::Explicit(solver) => solver.advance(problem, load, tissue, work),
            Self::BePcg(solver) => solver.advance(problem, load, tissue, work),
            Self::BeChebyshev(solver) => solver.advance(problem, load, tissue, work),
            Self::Vbd(solver) => solver.advance(problem, load, tissue, work),
        }
    }
}
