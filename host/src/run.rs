//! One run: scene → patch → controller → figures and files.

pub mod embedded;
pub mod files;
pub mod log;
pub mod profile;
pub mod report;
mod session;
pub(crate) mod solver;
pub mod vtk;
pub mod watch;

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use sutura_controller::lanes::Level;
use sutura_controller::record::{Fault, Faults};
use sutura_shared::message::{Telemetry, UploadError};
use sutura_shared::scene::{Effect, Stage};

use crate::geometry::patch::PatchError;
use crate::link::LinkError;
use crate::scene;
use crate::scene::build;
use crate::scene::draft::{Draft, Key};
use crate::scene::skill::Person;
use crate::score;
use crate::study::block;
use crate::voxelize::Springs;
use log::{Change, Log};
use report::{LinkCount, Report, TickTime, WoundGap};
use session::Session;
use vtk::{Frames, Series};

/// Longest run [ticks].
pub const TICKS_MAX: u32 = 60_000;
/// Ticks that a run goes on after its stitch is done, for the thread to be let go and the tissue to rest.
pub(crate) const AFTER: u32 = 1_500;

/// Runs a scene; `progress` sees every tick, `interrupted` ends the run without a trace.
///
/// # Errors
/// See [`Error`].
pub fn run(request: &Request, interrupted: &AtomicBool, progress: impl FnMut(&Telemetry)) -> Result<Report, Error> {
    let scene = Draft::open(request.scene.as_deref(), &request.meshes)?;
    let draft = match request.person {
        Some(person) => scene.sewn_by(person)?,
        None => scene,
    };
    let plan = draft.plan()?;
    let mut built = build::build(&plan, embedded::NODES_MAX).map_err(|error| refused(&draft, error))?;
    for warning in &built.warnings {
        tracing::warn!("{warning}");
    }
    let (solver, auto) = solver::settled(plan.solver, (&draft, &built), request.level, interrupted)?;
    built.scene.solver = solver;
    let note = auto.map(|auto| format!("solver {solver} chosen {auto}"));
    let copy = draft.copy(solver, note.as_slice())?;
    files::spare(&request.out, request.scene.as_deref(), &copy)?;
    files::folder(&request.out)?;
    let mut session = session::listen(request, &built, interrupted, progress)?;
    if session.ran.skipped > 0 {
        tracing::warn!(
            "{} ms passed without a tick: the machine is too slow or too busy for real time",
            session.ran.skipped
        );
    }
    let title = match &request.scene {
        Some(path) => format!("Force on the hand: {}", path.display()),
        None => "Force on the hand over one stitch".to_owned(),
    };
    files::write(&request.out, &copy, &title, &session.log)?;
    session.series.take().map_or(Ok(()), Series::finish)?;
    let score = score::of(&request.out)?;
    score::write(&request.out, &score)?;
    let whole = request.seconds.is_none();
    if whole {
        stuck(&session.log)?;
    }
    let report = Report {
        person: plan.person,
        auto,
        score: Some(score),
        ..report(request, &built, session)
    };
    if whole && built.scene.thread.is_some() {
        left_open(&report);
    }
    Ok(report)
}

/// The error of a scene that cannot be built, with the line of the key to change where there is one.
fn refused(draft: &Draft, error: build::Error) -> Error {
    match error {
        build::Error::Patch(error @ PatchError::TooManyNodes { .. }) => draft.fault(Key::Pitch, error).into(),
        error => error.into(),
    }
}

/// Part of a wound's width above which it counts as open.
const OPEN: f32 = 0.25;

/// Says where a stitch has not closed its wound.
fn left_open(report: &Report) {
    for (stitch, Change { before, after }) in (1..).zip(&report.wound_gap_mm.at_stitch) {
        if *after > OPEN * before {
            tracing::warn!(
                "the wound is not closed: {after:.2} of {before:.2} mm are left at stitch {stitch}; a higher operator.sew.tension_n or a \
                 wider stitch.bite_mm closes it further"
            );
        }
    }
}

/// Refuses a run that had all its time and is not done. A fault says more than that, so a run with one is reported.
fn stuck(log: &Log) -> Result<(), Error> {
    match log.ticks.last() {
        Some(last) if last.stage != Stage::Done && log.faults() == 0 => Err(Error::Stuck {
            stage: last.stage.name(),
            seconds: last.tick / 1000,
        }),
        _ => Ok(()),
    }
}

fn report(request: &Request, built: &build::Built, session: Session) -> Report {
    let Session {
        log,
        ticks,
        state_hash,
        counts,
        ran,
        ..
    } = session;
    let wounded = built.scene.wound.is_some();
    let faults = Faults(log.faults());
    Report {
        voxels: built.counts.voxels,
        nodes: built.counts.nodes,
        surface_nodes: built.counts.surface_nodes,
        springs: Springs {
            edge: built.counts.edges,
            body_diagonal: built.counts.body_diagonals,
        },
        tissues: built
            .tissues
            .iter()
            .map(|(name, voxels)| (name.clone(), (*voxels).into()))
            .collect(),
        effects: names(built, true),
        effects_off: names(built, false),
        solver: built.scene.solver.to_string(),
        person: None,
        auto: None,
        score: None,
        ticks,
        stages: log.stages(),
        punctures: log.punctures(),
        wound_gap_mm: WoundGap {
            at_stitch: if wounded { log.gaps() } else { Vec::new() },
            mean: log.mean_gap().filter(|_| wounded),
        },
        wound_step_mm: if wounded { log.steps() } else { Vec::new() },
        closing_n: if built.scene.thread.is_some() {
            log.closing()
        } else {
            Vec::new()
        },
        torn_mm: built.scene.effects.has(Effect::Tearing).then(|| log.torn()),
        force_n: log.peaks(),
        saturated_ticks: log.saturated(),
        faults: Fault::ALL
            .into_iter()
            .filter(|&fault| faults.has(fault))
            .map(Fault::name)
            .collect(),
        state_hash: format!("{state_hash:016x}"),
        tick_us: TickTime::of(ran.tick_ns.iter().map(|&ns| u64::from(ns)).collect()),
        link: LinkCount {
            frames: counts.frames + u64::from(ran.received.frames),
            errors: counts.errors + u64::from(ran.received.errors) + u64::from(ran.received.missing),
        },
        out: request.out.display().to_string(),
    }
}

/// Effects of a scene that are on, or those that are off.
fn names(built: &build::Built, on: bool) -> Vec<&'static str> {
    let chosen = Effect::ALL
        .into_iter()
        .filter(|&effect| built.scene.effects.has(effect) == on);
    chosen.map(Effect::name).collect()
}

/// What to run.
#[derive(Clone, Debug)]
pub struct Request {
    /// A scene file; none is the built-in scene.
    pub scene: Option<PathBuf>,
    /// Other meshes for its tissues.
    pub meshes: Vec<(String, PathBuf)>,
    /// Whose hand sews; none is as the scene says.
    pub person: Option<Person>,
    /// Where to stop, if before the end [s].
    pub seconds: Option<f64>,
    /// Whether a second of the simulation takes a second.
    pub realtime: bool,
    /// What the controller's passes run on.
    pub level: Level,
    /// Folder for the files.
    pub out: PathBuf,
    /// VTK files to write, if any.
    pub frames: Option<Frames>,
}

/// Why a run has no result; one line each.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The scene file.
    #[error(transparent)]
    Scene(#[from] scene::Error),
    /// Its meshes and its patch.
    #[error(transparent)]
    Build(#[from] build::Error),
    /// The lattice of the patch.
    #[error(transparent)]
    Lattice(block::Error),
    /// The files of the run.
    #[error(transparent)]
    Files(#[from] files::Error),
    /// Its score.
    #[error(transparent)]
    Score(#[from] score::Error),
    /// The controller and the way to it.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// No thread for the controller.
    #[error("the system gives no thread for the controller: {0}")]
    Thread(std::io::Error),
    /// The controller's thread panicked.
    #[error("the controller stopped: this is a defect of the program")]
    Controller,
    /// The script did not come to its end.
    #[error(
        "still in stage {stage} after {seconds} s of simulated time, the longest run: shorter ways or higher speeds in [operator] are right; the files show how far it came"
    )]
    Stuck {
        /// The last stage.
        stage: &'static str,
        /// When [s].
        seconds: u32,
    },
    /// Ctrl+C.
    #[error("interrupted")]
    Interrupted,
}

impl Error {
    /// The exit code: 2 for the user's input or environment, 1 for a defect of ours, 130 for an interrupt.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Scene(_)
            | Self::Build(_)
            | Self::Lattice(_)
            | Self::Files(files::Error::File { .. } | files::Error::NotFolder { .. } | files::Error::Scene { .. })
            | Self::Score(score::Error::Files(_))
            | Self::Thread(_)
            | Self::Stuck { .. } => 2,
            Self::Link(
                LinkError::Refused {
                    reason: UploadError::Build,
                    ..
                }
                | LinkError::TooLong { .. },
            ) => 2,
            Self::Interrupted => 130,
            Self::Files(files::Error::Plot(_)) | Self::Score(_) | Self::Link(_) | Self::Controller => 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_that_never_ends_names_its_stage_unless_a_fault_says_more() {
        let log = |stage, faults| Log {
            ticks: vec![Telemetry {
                tick: TICKS_MAX,
                stage,
                stitch: 1,
                faults,
                position_m: [0.0; 3],
                simulated_n: [0.0; 3],
                rendered_n: [0.0; 3],
                torque_n_m: [0.0; 3],
                thread_n: 0.0,
                gap_m: [0.0; 3],
                gap_mean_m: 0.0,
                saturated: false,
            }],
            ..Log::default()
        };
        let error = stuck(&log(Stage::Indent, 0)).unwrap_err();
        assert!(
            error.to_string().starts_with("still in stage indent after 60 s"),
            "{error}"
        );
        assert_eq!(error.exit_code(), 2);
        assert!(stuck(&log(Stage::Indent, 1)).is_ok());
        assert!(stuck(&log(Stage::Done, 0)).is_ok());
    }
}
