//! Runs every case under every setting, on all cores: no run knows of another, and none is timed.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use crossbeam_channel::unbounded;
use sutura_controller::lanes::Level;
use sutura_shared::scene::Solver;

use super::Error;
use super::case::{Attempt, Case, Unfinished};
use super::judge::judge;
use super::report::Row;
use super::setting::Setting;

/// A row for each case and setting, cases first; `progress` is told runs done and runs in all.
pub(super) fn all(
    cases: &[Case],
    settings: &[Setting],
    (level, interrupted): (Level, &AtomicBool),
    mut progress: impl FnMut(usize, usize),
) -> Result<Vec<Row>, Error> {
    let runs: Vec<_> = cases
        .iter()
        .flat_map(|case| settings.iter().map(move |setting| (case, setting)))
        .collect();
    let next = AtomicUsize::new(0);
    let (sender, results) = unbounded();
    let take = |sender: &crossbeam_channel::Sender<_>| {
        while let Some((n, (case, setting))) = {
            let n = next.fetch_add(1, Ordering::Relaxed);
            runs.get(n).map(|run| (n, *run))
        } {
            let attempt = Attempt::new(*setting, level, interrupted);
            // Whoever no longer listens has seen an error.
            if sender.send((n, one(case, &attempt))).is_err() {
                break;
            }
        }
    };
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let mut rows: Vec<_> = runs.iter().map(|_| None).collect();
    thread::scope(|scope| {
        for sender in vec![sender; cores] {
            scope.spawn(move || take(&sender));
        }
        progress(0, runs.len());
        for (done, (n, row)) in (1..).zip(results) {
            if let Some(place) = rows.get_mut(n) {
                *place = Some(row?);
            }
            progress(done, runs.len());
        }
        Ok::<(), Error>(())
    })?;
    Ok(rows.into_iter().flatten().collect())
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
