//! The solvers that a study may compare, by their names.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use sutura_controller::lattice::PC_NODES;
use sutura_controller::solver::{self, BePcg};
use sutura_shared::scene::{NoSolver, Solver};

/// A solver of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// One that scenes may choose.
    Controller(Solver),
}

impl Method {
    /// The solver itself; `None` where the controller has no such solver.
    #[must_use]
    pub fn build(self) -> Option<Box<dyn solver::Solver<PC_NODES>>> {
        match self {
            Self::Controller(Solver::BePcg { iterations, newton }) => Some(Box::new(BePcg { iterations, newton })),
            Self::Controller(_) => None,
        }
    }

    /// The explicit solver with this many substeps.
    #[must_use]
    pub const fn explicit(substeps: u16) -> Self {
        Self::Controller(Solver::Explicit { substeps })
    }

    /// Substeps of the explicit solver, 0 where it is to choose; `None` for any other solver.
    #[must_use]
    pub const fn explicit_substeps(self) -> Option<u16> {
        match self {
            Self::Controller(Solver::Explicit { substeps }) => Some(substeps),
            Self::Controller(_) => None,
        }
    }

    /// Whether it approximates the equation of motion itself and not its backward Euler step.
    #[must_use]
    pub const fn is_substepped(self) -> bool {
        self.explicit_substeps().is_some()
    }
}

impl Display for Method {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Controller(solver) => solver.fmt(f),
        }
    }
}

impl FromStr for Method {
    type Err = NoSolver;

    fn from_str(text: &str) -> Result<Self, NoSolver> {
        text.parse().map(Self::Controller)
    }
}
