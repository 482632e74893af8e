//! How the tissue is advanced, and the text that names it: `METHOD[:NUMBER[:NUMBER]]`.

use crate::check::{Invalid, Validate, require};
use core::fmt;
use core::num::{IntErrorKind, ParseIntError};
use core::str::{FromStr, Split};
use serde::{Deserialize, Serialize};

/// How the tissue is advanced by one tick.
///
/// As text `explicit[:substeps]`, `be-pcg[:iterations[:newton]]`, `be-chebyshev[:iterations]` or `vbd[:sweeps[:omega]]`; numbers left
/// out are `explicit`, `be-pcg:10:1`, `be-chebyshev:10` and `vbd:8:1.5`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Solver {
    /// Symplectic Euler in substeps.
    Explicit {
        /// Substeps a tick; 0 for the smallest stable count, which the controller finds.
        substeps: u16,
    },
    /// Backward Euler: `newton` linearisations, each with `iterations` of preconditioned conjugate gradients.
    BePcg {
        /// Conjugate-gradient iterations of the last Newton step; those before take a third.
        iterations: u16,
        /// Newton steps a tick.
        newton: u16,
    },
    /// Backward Euler: one linearisation, with the Chebyshev semi-iteration.
    BeChebyshev {
        /// Chebyshev iterations of the linear solve.
        iterations: u16,
    },
    /// Backward Euler: vertex block descent, both colours in each sweep.
    Vbd {
        /// Sweeps a tick.
        sweeps: u16,
        /// Over-relaxation ω; 1 for none.
        omega: f32,
    },
}

/// What scenes take unless something speaks for another: `be-pcg` without a number.
impl Default for Solver {
    fn default() -> Self {
        Self::BePcg {
            iterations: 10,
            newton: 1,
        }
    }
}

/// What the text of a solver may be.
const GRAMMAR: &str =
    "explicit[:substeps], be-pcg[:iterations[:newton]], be-chebyshev[:iterations], vbd[:sweeps[:omega]]";

impl Validate for Solver {
    fn validate(&self) -> Result<(), Invalid> {
        match self {
            Self::Explicit { substeps } => require(*substeps <= 1000, "solver.substeps", "1 to 1000, or none"),
            Self::BePcg { iterations, newton } => {
                require((1..=1000).contains(iterations), "solver.iterations", "1 to 1000")?;
                require((1..=100).contains(newton), "solver.newton", "1 to 100")
            }
            Self::BeChebyshev { iterations } => {
                require((1..=1000).contains(iterations), "solver.iterations", "1 to 1000")
            }
            Self::Vbd { sweeps, omega } => {
                require((1..=1000).contains(sweeps), "solver.sweeps", "1 to 1000")?;
                require((0.1..=1.95).contains(omega), "solver.omega", "0.1 to 1.95")
            }
        }
    }
}

impl fmt::Display for Solver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Explicit { substeps: 0 } => write!(f, "explicit"),
            Self::Explicit { substeps } => write!(f, "explicit:{substeps}"),
            Self::BePcg { iterations, newton } => write!(f, "be-pcg:{iterations}:{newton}"),
            Self::BeChebyshev { iterations } => write!(f, "be-chebyshev:{iterations}"),
            Self::Vbd { sweeps, omega } => write!(f, "vbd:{sweeps}:{omega}"),
        }
    }
}

impl FromStr for Solver {
    type Err = NoSolver;

    fn from_str(text: &str) -> Result<Self, NoSolver> {
        let mut parts = text.split(':');
        let solver = match parts.next() {
            Some("explicit") => Self::Explicit {
                substeps: count(&mut parts, 0)?,
            },
            Some("be-pcg") => Self::BePcg {
                iterations: count(&mut parts, 10)?,
                newton: count(&mut parts, 1)?,
            },
            Some("be-chebyshev") => Self::BeChebyshev {
                iterations: count(&mut parts, 10)?,
            },
            Some("vbd") => Self::Vbd {
                sweeps: count(&mut parts, 8)?,
                omega: parts
                    .next()
                    .map_or(Ok(1.5), |part| part.parse().map_err(|_| NoSolver::Method))?,
            },
            _ => return Err(NoSolver::Method),
        };
        match (parts.next(), solver.validate()) {
            (None, Ok(())) => Ok(solver),
            (None, Err(invalid)) => Err(NoSolver::Number(invalid)),
            (Some(_), _) => Err(NoSolver::Method),
        }
    }
}

/// The next part of the text, or what stands for it where it is left out. A number too long to hold is the largest: it is out of range,
/// and the refusal says which range.
fn count(parts: &mut Split<'_, char>, default: u16) -> Result<u16, NoSolver> {
    let Some(part) = parts.next() else { return Ok(default) };
    part.parse().or_else(|error: ParseIntError| match error.kind() {
        IntErrorKind::PosOverflow => Ok(u16::MAX),
        _ => Err(NoSolver::Method),
    })
}

/// Why a text names no solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoSolver {
    /// There is no such method, or it does not take what follows it.
    Method,
    /// A number is out of its range.
    Number(Invalid),
}

impl fmt::Display for NoSolver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Method => write!(f, "there are {GRAMMAR}, such as be-pcg:10:1"),
            Self::Number(Invalid { field, expected }) => write!(f, "{field} is {expected}"),
        }
    }
}

impl core::error::Error for NoSolver {}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    /// The grammar's texts and what they stand for in full.
    #[test]
    fn numbers_left_out_have_their_defaults() {
        assert_eq!("be-pcg".parse(), Ok(Solver::default()));
        for (text, full) in [
            ("explicit", "explicit"),
            ("explicit:5", "explicit:5"),
            ("be-pcg", "be-pcg:10:1"),
            ("be-pcg:20", "be-pcg:20:1"),
            ("be-pcg:20:2", "be-pcg:20:2"),
            ("be-chebyshev", "be-chebyshev:10"),
            ("be-chebyshev:15", "be-chebyshev:15"),
            ("vbd", "vbd:8:1.5"),
            ("vbd:4", "vbd:4:1.5"),
            ("vbd:4:1", "vbd:4:1"),
        ] {
            let solver: Solver = text.parse().unwrap();
            assert_eq!(solver.to_string(), full);
            assert_eq!(full.parse(), Ok(solver));
        }
    }

    #[test]
    fn what_is_no_solver_is_told_what_there_is() {
        for text in [
            "",
            "pd:3",
            "be-pcg:",
            "be-pcg:x",
            "be-pcg:1:1:1",
            "explicit:-1",
            "vbd:8:a",
            "VBD",
        ] {
            assert_eq!(text.parse::<Solver>(), Err(NoSolver::Method), "{text}");
        }
        for (text, what) in [
            ("be-pcg:0", "solver.iterations is 1 to 1000"),
            ("be-pcg:100000", "solver.iterations is 1 to 1000"),
            ("vbd:99999999999999999999", "solver.sweeps is 1 to 1000"),
            ("be-pcg:1:101", "solver.newton is 1 to 100"),
            ("explicit:1001", "solver.substeps is 1 to 1000, or none"),
            ("vbd:8:2", "solver.omega is 0.1 to 1.95"),
            ("vbd:8:NaN", "solver.omega is 0.1 to 1.95"),
        ] {
            assert_eq!(text.parse::<Solver>().unwrap_err().to_string(), what, "{text}");
        }
    }
}
