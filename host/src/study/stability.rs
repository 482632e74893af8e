//! The work of `sutura study stability`: hard cases under every solver and law that scenes may choose, and whether they come to rest.
//!
//! A case ([`Case`]) mistreats a patch of tissue through the controller's whole tick, safety edge and all, and then lets go. What is seen of
//! it ([`watch`]) is held to criteria that are the same for all ([`judge`]). A setting that fails is listed as failing; one that a formula
//! refuses before it runs is listed as refused, with the formula's number.

pub mod bench;
pub mod blocks;
pub mod case;
mod files;
pub mod inverted;
pub mod judge;
pub mod report;
mod scenes;
pub mod setting;
pub mod watch;
mod work;

pub use case::{Attempt, Case, Equilibrium, Unfinished};
pub use report::{Report, Row};
pub use setting::{Curve, Setting};

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use sutura_controller::lanes::Level;
use sutura_shared::scene::Solver;

use crate::run;

/// What to try.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// One case, or all whose name begins with this and a colon; `None` for every case.
    pub case: Option<String>,
    /// One solver; `None` for all of [`setting::SOLVERS`].
    pub solver: Option<Solver>,
    /// What the controller's passes run on.
    pub level: Level,
    /// Folder for stability.csv, .json, .md, .png and .svg.
    pub out: PathBuf,
}

/// Every case, in the order of the table.
#[must_use]
pub fn cases() -> Vec<Case> {
    blocks::cases().into_iter().chain(scenes::cases()).collect()
}

/// Tries; `progress` is told runs done and runs in all from any thread, `interrupted` ends the study without a trace.
///
/// # Errors
/// See [`Error`].
pub fn run(
    request: &Request,
    interrupted: &AtomicBool,
    progress: impl Fn(usize, usize) + Sync,
) -> Result<Report, Error> {
    let cases = chosen(request.case.as_deref())?;
    let settings = setting::all(request.solver);
    run::files::folder(&request.out)?;
    let rows = work::all(&cases, &settings, (request.level, interrupted), progress)?;
    let report = Report { rows };
    files::write(&request.out, &cases, &report)?;
    Ok(report)
}

/// The cases of a name.
fn chosen(name: Option<&str>) -> Result<Vec<Case>, Error> {
    let mut cases = cases();
    let Some(name) = name else { return Ok(cases) };
    let asked_family = name.split_once(':').map_or(name, |(family, _)| family);
    let of_family = cases.iter().filter(|case| case.family() == asked_family);
    let mut there: Vec<_> = of_family.map(|case| case.name.clone()).collect();
    if there.is_empty() {
        for case in &cases {
            let family = case.family();
            if !there.iter().any(|known| known == family) {
                there.push(family.to_owned());
            }
        }
    }
    cases.retain(|case| case.is_called(name));
    match cases.is_empty() {
        true => Err(Error::Case {
            name: name.to_owned(),
            there: there.join(", "),
        }),
        false => Ok(cases),
    }
}

/// Why there is no report; one line each.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No case has this name.
    #[error("no case is called {name:?}: there are {there}")]
    Case {
        /// What was asked for.
        name: String,
        /// The names of its family, or of all families.
        there: String,
    },
    /// A case's own scene cannot be loaded.
    #[error("the case {case} cannot be set up: {cause}")]
    Setup {
        /// Which.
        case: String,
        /// Why.
        cause: Unfinished,
    },
    /// A file.
    #[error(transparent)]
    Files(#[from] run::files::Error),
    /// Ctrl+C.
    #[error("interrupted")]
    Interrupted,
}

impl Error {
    /// The exit code: 2 for the user's input or environment, 1 for a defect of ours, 130 for an interrupt.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Interrupted => 130,
            Self::Setup { .. } => 1,
            Self::Case { .. } | Self::Files(_) => 2,
        }
    }
}

#[cfg(test)]
mod tests;
