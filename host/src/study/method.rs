//! The solvers that a study may compare, by their names.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use bytemuck::zeroed_box;
use sutura_controller::coupling::Coupling;
use sutura_controller::lanes::Level;
use sutura_controller::lattice::PC_NODES;
use sutura_controller::solver::{self, Choice, Explicit, Problem, Refused};
use sutura_shared::scene::{NoSolver, Solver};

use super::block::Block;
use super::pd::Pd;
use super::xpbd::Xpbd;

/// A way to advance a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// One that scenes may choose too.
    Controller(Solver),
    /// Extended position-based dynamics, a comparator.
    Xpbd {
        /// Substeps a tick.
        substeps: u16,
    },
    /// Projective dynamics, a comparator.
    Pd {
        /// Iterations a tick.
        iterations: u16,
    },
}

impl Default for Method {
    fn default() -> Self {
        Self::Controller(Solver::default())
    }
}

/// Substeps of `xpbd` where none are named.
const XPBD_SUBSTEPS: u16 = 20;
/// Iterations of `pd` where none are named.
const PD_ITERATIONS: u16 = 4;
/// Part of the largest stable step above which an explicit run is warned about.
pub const NEAR: f64 = 0.9;
/// Most substeps or iterations of a comparator.
const MOST: u16 = 1000;

/// A solver with memory of its own or without.
pub type Boxed = Box<dyn solver::Solver<PC_NODES>>;

impl Method {
    /// The solver itself for a block as it is held now, its passes on `level`, and the method with the count of substeps that it has chosen.
    ///
    /// # Errors
    /// See [`NotBuilt`].
    pub fn build(self, block: &Block, level: Level) -> Result<(Self, Boxed), NotBuilt> {
        match self {
            Self::Controller(solver) => {
                let coupling = Coupling::default();
                let problem = Problem {
                    lattice: &block.lattice,
                    material: &block.material,
                    coupling: &coupling,
                    faces: None,
                    level,
                };
                let choice = Choice::new(solver, &problem, &mut zeroed_box())
                    .map_err(|Refused::Unstable { least }| NotBuilt::Unstable { method: self, least })?;
                let method = match choice {
                    Choice::Explicit(Explicit { substeps }) => Self::explicit(substeps),
                    _ => self,
                };
                Ok((method, Box::new(choice)))
            }
            Self::Xpbd { substeps } => Ok((self, Box::new(Xpbd { substeps }))),
            Self::Pd { iterations } => {
                let pd = Pd::new(block, iterations).ok_or(NotBuilt::Missing { method: self })?;
                Ok((self, Box::new(pd)))
            }
        }
    }

    /// Whether it takes springs alone and no energy of volume.
    #[must_use]
    pub const fn is_comparator(self) -> bool {
        matches!(self, Self::Xpbd { .. } | Self::Pd { .. })
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
            _ => None,
        }
    }

    /// Whether it approximates the equation of motion itself and not its backward Euler step.
    #[must_use]
    pub const fn is_substepped(self) -> bool {
        matches!(self, Self::Controller(Solver::Explicit { .. }) | Self::Xpbd { .. })
    }
}

impl Display for Method {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Controller(solver) => solver.fmt(f),
            Self::Xpbd { substeps } => write!(f, "xpbd:{substeps}"),
            Self::Pd { iterations } => write!(f, "pd:{iterations}"),
        }
    }
}

impl FromStr for Method {
    type Err = NoMethod;

    fn from_str(text: &str) -> Result<Self, NoMethod> {
        let (name, number) = text
            .split_once(':')
            .map_or((text, None), |(name, number)| (name, Some(number)));
        let count = |default| match number.map(str::parse) {
            None => Ok(default),
            Some(Ok(count @ 1..=MOST)) => Ok(count),
            Some(_) => Err(NoMethod::Comparator),
        };
        match name {
            "xpbd" => Ok(Self::Xpbd {
                substeps: count(XPBD_SUBSTEPS)?,
            }),
            "pd" => Ok(Self::Pd {
                iterations: count(PD_ITERATIONS)?,
            }),
            _ => Ok(Self::Controller(text.parse()?)),
        }
    }
}

/// Why a method has no solver for a block; one line each.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotBuilt {
    /// Too few substeps.
    #[error("{method} is unstable on this lattice: explicit:{least} is the smallest stable count")]
    Unstable {
        /// What was asked for.
        method: Method,
        /// The smallest stable count.
        least: u16,
    },
    /// There is no such solver.
    #[error("there is no solver {method} for this block")]
    Missing {
        /// What was asked for.
        method: Method,
    },
}

/// Why a text names no method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoMethod {
    /// Neither a solver of the controller nor a comparator.
    #[error("{0}; or, to compare, xpbd[:substeps], pd[:iterations]")]
    Controller(#[from] NoSolver),
    /// A comparator's number.
    #[error("xpbd[:substeps] and pd[:iterations] take 1 to {MOST}")]
    Comparator,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_are_found_by_their_names() {
        for (text, full) in [
            ("xpbd", "xpbd:20"),
            ("xpbd:7", "xpbd:7"),
            ("pd", "pd:4"),
            ("pd:9", "pd:9"),
            ("be-pcg:5", "be-pcg:5:1"),
            ("explicit", "explicit"),
        ] {
            assert_eq!(text.parse::<Method>().unwrap().to_string(), full);
        }
        for text in ["xpbd:0", "pd:x", "pd:1:1", "xpbd:1001"] {
            assert_eq!(text.parse::<Method>(), Err(NoMethod::Comparator), "{text}");
        }
        let line = "leapfrog".parse::<Method>().unwrap_err().to_string();
        assert!(line.contains("be-pcg") && line.contains("xpbd[:substeps]"), "{line}");
    }
}
