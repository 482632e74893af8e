//! The work of `sutura study accuracy`: what accuracy costs in time.
//!
//! Every solver over its dial, on the work of `sutura poke` ([`case`]): how far its force is from the truth ([`measure`]), what a tick costs
//! ([`price`]), and which settings nothing beats ([`verdict`]). Beside them the errors that no solver can mend ([`pitch`], [`model`]). Errors are computed on all cores; times are measured when nothing else of
//! ours runs, instructions last.

mod body;
pub mod case;
mod files;
pub mod measure;
pub mod model;
pub mod pitch;
pub mod price;
mod report;
pub mod statics;
pub mod verdict;

pub use report::{Lattice, Report, Row};

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use sutura_controller::lanes::Level;

use self::case::{Case, Matrix, named};
use self::measure::Measured;
use self::price::Work;
use self::statics::{Extent, Statics};
use super::limit::Limit;
use super::{callgrind, parallel, poke};
use crate::run;

/// What to study, and with what.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// Cases and dials.
    pub matrix: Matrix,
    /// Errors of pitch and model, where they are wanted.
    pub statics: Option<Extent>,
    /// What the controller's passes run on.
    pub level: Level,
    /// Source of the C kernel.
    pub limit_source: PathBuf,
    /// The `sutura` program, whose pokes are counted; without it no instructions.
    pub program: Option<PathBuf>,
    /// Folder for the files.
    pub out: PathBuf,
}

/// How far the study is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// Part of the errors.
    Errors(f64),
    /// Part of the bodies at rest.
    Statics(f64),
    /// Part of the times of one lattice.
    Times(f64),
    /// Part of the instructions.
    Instructions(f64),
}

/// Studies and writes the files; `progress` is told how far it is from any thread, `interrupted` ends it without a trace.
///
/// # Errors
/// See [`Error`].
pub fn run(
    request: &Request,
    interrupted: &AtomicBool,
    progress: &(impl Fn(Progress) + Sync),
) -> Result<Report, Error> {
    let fresh = !request.out.exists();
    run::files::folder(&request.out)?;
    let result = study(request, interrupted, progress).and_then(|report| {
        files::write(&request.out, &report)?;
        Ok(report)
    });
    if result.is_err() && fresh {
        // Not there before, and empty: as if it had never been called.
        std::fs::remove_dir(&request.out).ok();
    }
    result
}

fn study(request: &Request, interrupted: &AtomicBool, progress: &(impl Fn(Progress) + Sync)) -> Result<Report, Error> {
    let go_on = || match interrupted.load(Ordering::Relaxed) {
        true => Err(poke::Error::Interrupted),
        false => Ok(()),
    };
    let mut notes = Vec::new();
    let measured = errors(request, &go_on, |part| progress(Progress::Errors(part)))?;
    let statics = at_rest(request.statics, &go_on, progress, &mut notes)?;
    let works = price::works(&measured);
    let mut rows: Vec<Row> = measured.iter().map(Row::new).collect();
    let mut lattices = Vec::new();
    for &nodes in &request.matrix.lattices {
        let here: Vec<_> = works.iter().filter(|work| [work.case.nodes] == [nodes]).collect();
        let limit = kernel(&request.limit_source, nodes, &mut notes);
        let done = |part| progress(Progress::Times(part));
        let times = price::times(&here, limit.as_ref(), request.level, &go_on, done)?;
        for (row, measured) in rows.iter_mut().zip(&measured) {
            let priced = here.iter().zip(&times.us).find(|(work, _)| work.is_of(measured));
            if let Some((_, us)) = priced {
                row.us_median = *us;
                row.limit_ratio = times.limit_us.map(|limit| us / limit);
            }
        }
        lattices.push((nodes, times.limit_us));
    }
    for (work, count) in instructions(request, &works, &go_on, progress, &mut notes)? {
        let mine = rows
            .iter_mut()
            .zip(&measured)
            .filter(|(_, measured)| work.is_of(measured));
        mine.for_each(|(row, _)| row.instructions = count);
    }
    let verdict = |&(nodes, limit_us): &([u32; 3], Option<f64>)| Lattice::new(nodes, limit_us, &rows);
    Ok(Report {
        lattices: lattices.iter().map(verdict).collect(),
        rows,
        statics,
        ticks: case::TICKS,
        ramp_ms: case::RAMP_MS,
        simd: request.level.name(),
        notes,
        out: request.out.display().to_string(),
    })
}

/// Errors of every dial on every case, on all cores, the largest lattices first.
fn errors(
    request: &Request,
    go_on: &(impl Fn() -> Result<(), poke::Error> + Sync),
    progress: impl Fn(f64) + Sync,
) -> Result<Vec<Measured>, Error> {
    let Matrix { lattices, dials, .. } = &request.matrix;
    let mut cases: Vec<Case> = lattices.iter().flat_map(|&nodes| request.matrix.cases(nodes)).collect();
    // What begins last should not be what takes longest.
    cases.reverse();
    let weight = |case: &Case| case.nodes.iter().map(|&n| f64::from(n)).product::<f64>();
    let whole: f64 = cases.iter().map(weight).sum();
    let done = Mutex::new(0.0);
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let measured = parallel::map(&cases, workers, |case| {
        let mut before = 0.0;
        measure::measure(case, dials, request.level, go_on, |part| {
            let mut done = done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            *done += (part - before) * weight(case);
            before = part;
            progress(*done / whole);
        })
    })?;
    Ok(measured.into_iter().rev().flatten().collect())
}

/// What pitch and model cost, as far as it is wanted.
fn at_rest(
    extent: Option<Extent>,
    go_on: &(impl Fn() -> Result<(), poke::Error> + Sync),
    progress: &(impl Fn(Progress) + Sync),
    notes: &mut Vec<String>,
) -> Result<Option<Statics>, Error> {
    let Some(extent) = extent else {
        return Ok(None);
    };
    if extent == Extent::Quick {
        notes.push(statics::LEFT_OUT.to_owned());
    }
    Ok(Some(statics::run(extent, go_on, &|part| {
        progress(Progress::Statics(part))
    })?))
}

/// The kernel for a lattice; where it is missing, that is said.
fn kernel(source: &Path, nodes: [u32; 3], notes: &mut Vec<String>) -> Option<Limit> {
    let say = |needs| say(notes, format!("limit_ratio on {} needs {needs}", named(nodes)));
    Limit::compile(source, nodes).map_err(say).ok()
}

/// Instructions of the works, as far as they are to be counted and can be.
fn instructions<'a>(
    request: &Request,
    works: &'a [Work],
    go_on: &(impl Fn() -> Result<(), poke::Error> + Sync),
    progress: &(impl Fn(Progress) + Sync),
    notes: &mut Vec<String>,
) -> Result<Vec<(&'a Work, Option<u64>)>, Error> {
    let Some(program) = &request.program else {
        return Ok(Vec::new());
    };
    if let Err(missing) = callgrind::present() {
        say(notes, missing.to_string());
        return Ok(Vec::new());
    }
    let nodes = |work: &&Work| work.case.nodes.iter().product::<u32>();
    let counted: Vec<_> = works
        .iter()
        .filter(|work| nodes(work) <= request.matrix.counted)
        .collect();
    if counted.len() < works.len() {
        notes.push(format!(
            "instructions on lattices of more than {} nodes: the whole study counts them",
            request.matrix.counted
        ));
    }
    let done = |part| progress(Progress::Instructions(part));
    let counts = price::instructions(&counted, program, go_on, done)?;
    Ok(counted.into_iter().zip(counts).collect())
}

/// Says out loud what is missing, and notes it.
fn say(notes: &mut Vec<String>, line: String) {
    tracing::warn!("{line}");
    notes.push(line);
}

/// Why there is no study; one line each.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A poke.
    #[error(transparent)]
    Poke(#[from] poke::Error),
    /// The files.
    #[error(transparent)]
    Files(#[from] run::files::Error),
}

impl Error {
    /// The exit code: 2 for the user's input or environment, 1 for a defect of ours, 130 for an interrupt.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Poke(error) => error.exit_code(),
            Self::Files(_) => 2,
        }
    }
}
