//! The most accurate solver within a budget for one poke: its own block and way, and the time of the solve alone.

use std::fmt::{self, Display, Formatter};
use std::sync::atomic::AtomicBool;

use sutura_shared::scene::Solver;

use super::{Error, Request, prepare};
use crate::study::block::Spec;
use crate::study::budget::probe::Probe;
use crate::study::budget::{Extent, Row, Table, families, survey};

/// Most ticks that solvers are measured for; a shorter run is measured whole.
const TICKS: u32 = 400;
/// Nodes along an axis over the request's, tried where no solver is within the budget.
const SMALLER: [f64; 9] = [0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.0];
/// Part of the budget that a suggestion may take, for it is timed on a busy machine.
const MARGIN: f64 = 0.9;

/// Times and measures solvers on a request's block and way, whatever its method, and chooses one.
///
/// # Errors
/// See [`Error`].
pub fn choose(request: &Request, budget_us: u16, interrupted: &AtomicBool) -> Result<Table, Error> {
    let probe = probe(request, interrupted)?;
    let rows = survey::<Error>(
        &families(probe.substeps()),
        (budget_us, Extent::Choice),
        |solver, _| Ok(probe.time(solver)?),
        |solver| Ok(probe.error(solver)?),
    )?;
    match Table::new(budget_us, rows) {
        Ok(table) => Ok(table),
        Err(rows) => Err(unmet(request, budget_us, &rows, interrupted)?),
    }
}

fn probe<'a>(request: &Request, interrupted: &'a AtomicBool) -> Result<Probe<'a>, Error> {
    let (poke, _) = prepare(request)?;
    let ticks = request.ticks.min(TICKS);
    let courses = [request.course];
    Ok(Probe::new(
        (poke.block, poke.node),
        (&courses, ticks),
        request.level,
        interrupted,
    )?)
}

/// The error, with a smaller block that was tried.
fn unmet(request: &Request, budget_us: u16, rows: &[Row], interrupted: &AtomicBool) -> Result<Error, Error> {
    let Some(cheapest) = rows.iter().min_by(|a, b| a.us_median.total_cmp(&b.us_median)) else {
        return Ok(Error::NoSolver);
    };
    let mut unmet = Unmet {
        budget_us,
        cheapest: (cheapest.solver, cheapest.us_median),
        smaller: (request.block.nodes, cheapest.us_median),
    };
    for factor in SMALLER {
        let nodes = request.block.nodes.map(|n| ((f64::from(n) * factor) as u32).max(2));
        let smaller = Request {
            block: Spec { nodes, ..request.block },
            node: None,
            ..request.clone()
        };
        if let Some(us) = probe(&smaller, interrupted)?.time(cheapest.solver)? {
            unmet.smaller = (nodes, us.median);
        }
        if unmet.is_met() {
            break;
        }
    }
    Ok(Error::Unmet(unmet))
}

/// No solver within the budget; one line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unmet {
    /// The budget [µs].
    pub budget_us: u16,
    /// The cheapest solver, and what it takes [µs].
    pub cheapest: (Solver, f64),
    /// Nodes of the largest block tried that would do, or else of the smallest, and what that takes [µs].
    pub smaller: ([u32; 3], f64),
}

impl Unmet {
    /// Whether the smaller block would do.
    fn is_met(&self) -> bool {
        self.smaller.1 <= MARGIN * f64::from(self.budget_us)
    }
}

impl std::error::Error for Unmet {}

impl Display for Unmet {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let ((solver, us), ([x, y, z], smaller_us)) = (self.cheapest, self.smaller);
        write!(
            f,
            "no solver takes {} µs or less a tick: {solver}, the cheapest, takes {us:.0} µs; ",
            self.budget_us
        )?;
        if self.is_met() {
            write!(f, "--nodes {x}x{y}x{z} ({smaller_us:.1} µs) is right")
        } else {
            let right = (smaller_us / MARGIN).ceil();
            write!(
                f,
                "even --nodes {x}x{y}x{z} takes {smaller_us:.1} µs, so {right} µs or more are right"
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smaller_block_or_a_larger_budget_is_named() {
        let unmet = |us| Unmet {
            budget_us: 10,
            cheapest: (
                Solver::BePcg {
                    iterations: 3,
                    newton: 1,
                },
                40.0,
            ),
            smaller: ([8, 8, 4], us),
        };
        let line = unmet(8.9).to_string();
        assert!(line.ends_with("; --nodes 8x8x4 (8.9 µs) is right"), "{line}");
        let line = unmet(9.1).to_string();
        assert!(
            line.ends_with("even --nodes 8x8x4 takes 9.1 µs, so 11 µs or more are right"),
            "{line}"
        );
    }
}
