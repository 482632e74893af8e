//! What a tick of every solver costs: CPU time beside the C kernel's in turn, and instructions.
//!
//! Every solver has a fixed count of operations, whatever the stiffness and the way: one price for a solver on a lattice with a curve.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use sutura_controller::lanes::Level;

use super::Error;
use super::case::Case;
use super::measure::Measured;
use crate::run::report::TickTime;
use crate::study::limit::Limit;
use crate::study::method::{Boxed, Method};
use crate::study::poke::drive::{Poke, SOLVE};
use crate::study::{callgrind, parallel, poke};

/// Turns of kernel and solvers; the machine's other work only ever makes them slower, so the fastest counts.
const TURNS: usize = 3;
/// Length of a run that is timed [ticks].
const TIMED: u32 = 60;
/// Length of a run whose instructions are counted [ticks].
const COUNTED: u32 = 2;
/// Runs that are counted at a time.
const COUNTERS: usize = 2;

/// A solver on a lattice with a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Work {
    /// A case that asks for it.
    pub case: Case,
    /// The solver with its numbers.
    pub method: Method,
}

impl Work {
    /// Whether `measured` is this work, on whatever stiffness and way.
    #[must_use]
    pub fn is_of(&self, measured: &Measured) -> bool {
        let Case { nodes, stiffening, .. } = measured.case;
        [nodes] == [self.case.nodes] && stiffening == self.case.stiffening && measured.method == self.method
    }
}

/// Each work once, those that stayed finite first asked.
pub(super) fn works(measured: &[Measured]) -> Vec<Work> {
    let mut works: Vec<Work> = Vec::new();
    let (finite, diverged): (Vec<_>, Vec<_>) = measured.iter().partition(|measured| measured.errors.is_some());
    for measured in finite.into_iter().chain(diverged) {
        if !works.iter().any(|work| work.is_of(measured)) {
            works.push(Work {
                case: measured.case,
                method: measured.method,
            });
        }
    }
    works
}

/// Times of one lattice.
pub(super) struct Times {
    /// Median of each work [µs].
    pub(super) us: Vec<f64>,
    /// Median of the kernel [µs]; none where it is missing.
    pub(super) limit_us: Option<f64>,
}

/// Times the works of one lattice, in turn with the kernel; `done` is told the part that is done.
pub(super) fn times(
    works: &[&Work],
    limit: Option<&Limit>,
    level: Level,
    go_on: &impl Fn() -> Result<(), poke::Error>,
    done: impl Fn(f64),
) -> Result<Times, Error> {
    let mut pokes: Vec<(Poke, Boxed)> = Vec::new();
    for work in works {
        let (poke, _) = poke::prepare(&work.case.request(work.method, level))?;
        let (_, solver) = work.method.build(&poke.block, level).map_err(poke::Error::from)?;
        pokes.push((poke, solver));
    }
    let mut times = Times {
        us: vec![f64::INFINITY; works.len()],
        limit_us: None,
    };
    for turn in 0..TURNS {
        if let Some(now) = limit.and_then(now) {
            times.limit_us = Some(times.limit_us.map_or(now, |best| best.min(now)));
        }
        for (at, ((poke, solver), best)) in pokes.iter().zip(&mut times.us).enumerate() {
            let mut ns = Vec::with_capacity(TIMED as usize);
            poke.run(&**solver, TIMED, |_, took| {
                ns.push(took);
                go_on()
            })?;
            *best = best.min(TickTime::of(ns).median);
            done((turn * works.len() + at + 1) as f64 / (TURNS * works.len()) as f64);
        }
    }
    Ok(times)
}

/// Counts the instructions of a tick of each work, by runs of `program`; `done` is told the part that is done.
pub(super) fn instructions(
    works: &[&Work],
    program: &Path,
    go_on: &(impl Fn() -> Result<(), poke::Error> + Sync),
    done: impl Fn(f64) + Sync,
) -> Result<Vec<Option<u64>>, Error> {
    let counted = AtomicUsize::new(0);
    parallel::map(works, COUNTERS, |work| {
        go_on()?;
        let count = callgrind::instructions(program, &work.case.arguments(work.method, COUNTED), SOLVE);
        go_on()?;
        let part = counted.fetch_add(1, Ordering::Relaxed) + 1;
        done(part as f64 / works.len() as f64);
        match count {
            Ok(count) => Ok(Some(count / u64::from(COUNTED))),
            Err(error) => {
                tracing::warn!("{} on {}: {error}", work.method, work.case.lattice());
                Ok(None)
            }
        }
    })
}

/// The kernel's time now [µs].
fn now(limit: &Limit) -> Option<f64> {
    limit
        .us()
        .map_err(|needs| tracing::warn!("the C kernel needs {needs}"))
        .ok()
}
