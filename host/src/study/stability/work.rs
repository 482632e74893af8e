//! Runs every case under every setting, on all cores: no run knows of another, and none is timed.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use sutura_controller::lanes::Level;
use sutura_shared::scene::Solver;

use super::Error;
use super::case::{Attempt, Case, Unfinished};
use super::judge::judge;
use super::report::Row;
use super::setting::Setting;
use crate::study::parallel;

/// A row for each case and setting, cases first; `progress` is told runs done and runs in all, from any thread.
pub(super) fn all(
    cases: &[Case],
    settings: &[Setting],
    (level, interrupted): (Level, &AtomicBool),
    progress: impl Fn(usize, usize) + Sync,
) -> Result<Vec<Row>, Error> {
    let runs: Vec<_> = cases
        .iter()
        .flat_map(|case| settings.iter().map(move |setting| (case, setting)))
        .collect();
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let done = AtomicUsize::new(0);
    progress(0, runs.len());
    parallel::map(&runs, cores, |&(case, setting)| {
        let row = one(case, &Attempt::new(*setting, level, interrupted))?;
        progress(done.fetch_add(1, Ordering::Relaxed) + 1, runs.len());
        Ok(row)
    })
}

/// One case under one setting.
pub(super) fn one(case: &Case, attempt: &Attempt<'_>) -> Result<Row, Error> {
    let Setting { solver, springs } = attempt.setting;
    let row = |passed, why, worst, refused| Row {
        case: case.name.clone(),
        solver: solver.to_string(),
        law: springs.to_string(),
        passed,
        why,
        worst,
        refused,
    };
    match (case.run)(attempt) {
        Ok(trace) => {
            let verdict = judge(&trace, case.equilibrium.as_ref());
            Ok(row(verdict.passed, verdict.why, verdict.worst, false))
        }
        Err(Unfinished::Interrupted) => Err(Error::Interrupted),
        Err(refused @ Unfinished::Refused { solver, least }) => {
            let asked = match solver {
                Solver::Explicit { substeps } => f64::from(substeps),
                _ => 1.0,
            };
            Ok(row(false, refused.to_string(), f64::from(least) / asked, true))
        }
        Err(cause) => Err(Error::Setup {
            case: case.name.clone(),
            cause,
        }),
    }
}
