//! The most accurate solver within a budget of time, on this machine, for this tissue: what `auto:<µs>` stands for.
//!
//! Time is the CPU time of a whole tick ([`clock`]), error the distance of the tool force from that of the same backward Euler step,
//! converged ([`probe`]). The error of the time step itself is the same for all of them and does not enter; for `explicit`, which takes other
//! steps, it does. Among solvers within the budget the one with the smallest error is chosen, and where several are below [`ENOUGH`], the
//! cheapest of these.

pub mod clock;
mod dials;
pub mod files;
pub mod probe;
mod remedy;
mod report;
pub mod scene;
pub mod study;

pub(crate) use dials::families;
pub use remedy::{Remedy, Unmet};
pub use report::Table;

use std::fmt::{self, Display, Formatter};

use serde::{Serialize, Serializer};
use sutura_shared::scene::Solver;

use crate::run::report::TickTime;

/// Error of the force below which no better one is looked for.
pub const ENOUGH: f64 = 1e-3;
/// Error of the force that a hand can tell: its just noticeable difference is 7 to 10 % (Jones & Hunter 1990).
pub const FELT: f64 = 0.07;
/// How far beyond the budget a table goes on.
const BEYOND: f64 = 2.0;

/// One solver and what it costs and gives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The solver.
    #[serde(serialize_with = "as_text")]
    pub solver: Solver,
    /// CPU time of a tick, the median [µs].
    pub us_median: f64,
    /// 99 % of the ticks took less [µs].
    pub us_p99: f64,
    /// Error of the force, root mean square over a path relative to that of the force, on the worse of the paths; none where the solver is
    /// too slow to be measured, or does not hold the tissue.
    pub force_error: Option<f64>,
    /// Whether the median is within the budget.
    pub within: bool,
}

/// What a clock has chosen, for the record.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Auto {
    /// The budget [µs].
    pub budget_us: u16,
    /// CPU time of a tick as it was measured, the median [µs].
    pub us_median: f64,
    /// 99 % of the ticks took less [µs].
    pub us_p99: f64,
    /// Error of the force, as in [`Row::force_error`].
    pub force_error: f64,
}

impl Auto {
    /// The record of a chosen row; `None` for one whose error is not known.
    #[must_use]
    pub fn new(budget_us: u16, row: &Row) -> Option<Self> {
        Some(Self {
            budget_us,
            us_median: row.us_median,
            us_p99: row.us_p99,
            force_error: row.force_error?,
        })
    }

    /// Says so where a hand can tell the error.
    pub fn warn(&self) {
        if self.force_error > FELT {
            tracing::warn!(
                "{:.0} % of force error can be felt: more than {} µs are right here",
                100.0 * self.force_error,
                self.budget_us
            );
        }
    }
}

impl Display for Auto {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "by auto:{}, {:.0} µs a tick (median), {:.0} µs (99 %), force error {:.2} %",
            self.budget_us,
            self.us_median,
            self.us_p99,
            100.0 * self.force_error
        )
    }
}

/// How many solvers are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// As many as the choice needs.
    Choice,
    /// All within the budget, and some beyond it.
    Table,
}

/// The row that is chosen; `None` where nothing that holds the tissue is within the budget.
#[must_use]
pub fn choose(rows: &[Row]) -> Option<&Row> {
    let within = || {
        let known = rows.iter().filter(|row| row.within);
        known.filter_map(|row| Some((row, row.force_error?)))
    };
    let enough = within().filter(|(_, error)| *error <= ENOUGH);
    let cheapest = enough.min_by(|(a, _), (b, _)| a.us_median.total_cmp(&b.us_median));
    let best = within().min_by(|(_, a), (_, b)| a.total_cmp(b));
    cheapest.or(best).map(|(row, _)| row)
}

/// Times and measures solvers, family by family, each from its cheapest on: `time` is given the time beyond which it may give up [µs] and
/// answers `None` for a solver that does not hold the tissue, as `error` does.
///
/// # Errors
/// What `time` and `error` end it with.
pub fn survey<E>(
    families: &[Vec<Solver>],
    (budget_us, extent): (u16, Extent),
    mut time: impl FnMut(Solver, f64) -> Result<Option<TickTime>, E>,
    mut error: impl FnMut(Solver) -> Result<Option<f64>, E>,
) -> Result<Vec<Row>, E> {
    let budget = f64::from(budget_us);
    let mut rows: Vec<Row> = Vec::new();
    for family in families {
        for &solver in family {
            let limit = match extent {
                Extent::Table => BEYOND * budget,
                // What is no cheaper than one that is good enough is never chosen.
                Extent::Choice => choose(&rows)
                    .filter(|row| row.force_error.is_some_and(|error| error <= ENOUGH))
                    .map_or(budget, |row| row.us_median),
            };
            let Some(us) = time(solver, limit)? else { continue };
            let slow = us.median > limit;
            let force_error = if slow { None } else { error(solver)? };
            rows.push(Row {
                solver,
                us_median: us.median,
                us_p99: us.p99,
                force_error,
                within: us.median <= budget,
            });
            let enough = force_error.is_some_and(|error| error <= ENOUGH);
            if slow || (enough && extent == Extent::Choice) {
                break;
            }
        }
    }
    Ok(rows)
}

/// Ctrl+C.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("interrupted")]
pub struct Interrupted;

/// Times what is chosen once more, thoroughly than a survey at a glance does, until the choice stands.
///
/// # Errors
/// What `time` ends it with.
pub fn confirm<E>(
    rows: &mut [Row],
    budget_us: u16,
    mut time: impl FnMut(Solver) -> Result<Option<TickTime>, E>,
) -> Result<(), E> {
    let mut sure = Vec::new();
    while let Some(solver) = choose(rows)
        .map(|row| row.solver)
        .filter(|solver| !sure.contains(solver))
    {
        let us = time(solver)?;
        sure.push(solver);
        for row in rows.iter_mut().filter(|row| row.solver == solver) {
            match us {
                Some(us) => {
                    (row.us_median, row.us_p99) = (us.median, us.p99);
                    row.within = us.median <= f64::from(budget_us);
                }
                None => row.force_error = None,
            }
        }
    }
    Ok(())
}

fn as_text<S: Serializer>(solver: &Solver, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(solver)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;
    use std::convert::Infallible;

    fn pcg(iterations: u16, newton: u16) -> Solver {
        Solver::BePcg { iterations, newton }
    }

    fn row(iterations: u16, us: f64, force_error: Option<f64>) -> Row {
        Row {
            solver: pcg(iterations, 1),
            us_median: us,
            us_p99: 1.2 * us,
            force_error,
            within: us <= 500.0,
        }
    }

    #[test]
    fn the_most_accurate_is_chosen_and_below_enough_the_cheapest() {
        let chosen = |rows: &[Row]| choose(rows).map(|row| row.us_median);
        let [poor, fair] = [row(3, 100.0, Some(0.2)), row(5, 200.0, Some(0.01))];
        let [good, better] = [row(10, 300.0, Some(9e-4)), row(20, 400.0, Some(1e-5))];
        let [beyond, broken] = [row(30, 600.0, Some(1e-6)), row(7, 50.0, None)];
        assert_eq!(chosen(&[poor, fair, beyond, broken]), Some(200.0));
        assert_eq!(chosen(&[better, poor, fair, good, beyond]), Some(300.0));
        assert_eq!(chosen(&[beyond, broken]), None);
        assert_eq!(chosen(&[]), None);
    }

    /// Times of 20 µs an iteration and Newton step, errors that halve with each iteration and are squared by the second step.
    fn surveyed(budget_us: u16, extent: Extent) -> (Vec<Row>, Vec<Solver>) {
        let families = [1, 2].map(|newton| [2, 4, 8, 16, 32].map(|iterations| pcg(iterations, newton)).to_vec());
        let measured = RefCell::new(Vec::new());
        let dials = |solver| match solver {
            Solver::BePcg { iterations, newton } => (f64::from(iterations), f64::from(newton)),
            _ => unreachable!(),
        };
        let time = |solver, _| {
            let (iterations, newton) = dials(solver);
            let median = 20.0 * iterations * newton;
            Ok::<_, Infallible>(Some(TickTime {
                median,
                p99: median,
                max: median,
            }))
        };
        let error = |solver| {
            measured.borrow_mut().push(solver);
            let (iterations, newton) = dials(solver);
            Ok(Some(0.5_f64.powf(iterations * newton * newton)))
        };
        let rows = survey(&families, (budget_us, extent), time, error).unwrap();
        (rows, measured.into_inner())
    }

    /// Without a second step 16 iterations are needed for 0.1 % (2⁻¹⁰), with it 4, at half the time.
    #[test]
    fn looking_at_fewer_solvers_leaves_the_choice_as_it_is() {
        for (budget_us, chosen) in [
            (1000, Some(pcg(4, 2))),
            (160, Some(pcg(4, 2))),
            (150, Some(pcg(2, 2))),
            (79, Some(pcg(2, 1))),
            (39, None),
        ] {
            let [few, all] = [Extent::Choice, Extent::Table].map(|extent| surveyed(budget_us, extent));
            for (rows, _) in [&few, &all] {
                assert_eq!(choose(rows).map(|row| row.solver), chosen, "{budget_us} µs: {rows:?}");
            }
            assert!(few.1.len() <= all.1.len());
        }
        // Up to 16 iterations with one step; with two, 8 are no longer looked at.
        assert_eq!(surveyed(1000, Extent::Choice).1.len(), 4 + 2);
    }

    /// At a glance all took less than they do.
    #[test]
    fn a_choice_stands_that_a_longer_look_confirms() {
        let mut rows = [
            row(5, 200.0, Some(0.01)),
            row(10, 300.0, Some(9e-4)),
            row(20, 400.0, Some(1e-5)),
        ];
        let mut looks = 0;
        let time = |solver| {
            looks += 1;
            let median = if solver == pcg(5, 1) { 450.0 } else { 550.0 };
            Ok::<_, Infallible>(Some(TickTime {
                median,
                p99: median,
                max: median,
            }))
        };
        confirm(&mut rows, 500, time).unwrap();
        assert_eq!((choose(&rows).map(|row| row.solver), looks), (Some(pcg(5, 1)), 3));
        confirm(&mut rows, 500, |_| Ok::<_, Infallible>(None)).unwrap();
        assert_eq!(choose(&rows), None);
    }

    #[test]
    fn a_solver_beyond_the_budget_is_not_measured() {
        let (rows, measured) = surveyed(30, Extent::Choice);
        assert_eq!((rows.len(), measured.len()), (2, 0));
        assert!(rows.iter().all(|row| !row.within && row.force_error.is_none()));
    }
}
