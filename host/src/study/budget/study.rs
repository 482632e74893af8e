//! The work of `sutura study accuracy --scene S --budget-us N`: the whole table of a scene, whatever its own solver, and its files.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use sutura_controller::lanes::Level;

use super::{Extent, Table, files, scene as choice};
use crate::run;
use crate::run::embedded::NODES_MAX;
use crate::scene::{self, Draft, build};

/// What to study.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// A scene file; none is the built-in scene.
    pub scene: Option<PathBuf>,
    /// CPU time that a tick may take [µs].
    pub budget_us: u16,
    /// What the controller's passes run on.
    pub level: Level,
    /// Folder for the files.
    pub out: PathBuf,
}

/// Studies and writes the files.
///
/// # Errors
/// See [`Error`].
pub fn run(request: &Request, interrupted: &AtomicBool) -> Result<Table, Error> {
    let draft = Draft::open(request.scene.as_deref(), &[])?;
    let built = build::build(&draft.plan()?, NODES_MAX)?;
    run::files::folder(&request.out)?;
    let table = choice::run(
        &choice::Request {
            draft: &draft,
            built: &built,
            budget_us: request.budget_us,
            level: request.level,
            extent: Extent::Table,
        },
        interrupted,
    )?;
    let scene = request
        .scene
        .as_ref()
        .map_or_else(|| "the built-in scene".to_owned(), |path| path.display().to_string());
    let title = format!("What accuracy costs: {scene}, {} nodes", built.counts.nodes);
    files::write(&request.out, &title, &table)?;
    Ok(table)
}

/// Why there is no table; one line each.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The scene file.
    #[error(transparent)]
    Scene(#[from] scene::Error),
    /// Its meshes and its patch.
    #[error(transparent)]
    Build(#[from] build::Error),
    /// The choice.
    #[error(transparent)]
    Choice(#[from] choice::Error),
    /// The files.
    #[error(transparent)]
    Files(#[from] run::files::Error),
}

impl Error {
    /// The exit code: 2 for the user's input or environment, 1 for a defect of ours, 130 for an interrupt.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Choice(error) => error.exit_code(),
            Self::Files(run::files::Error::Plot(_)) => 1,
            Self::Scene(_) | Self::Build(_) | Self::Files(_) => 2,
        }
    }
}
