//! The work of `sutura study effects`: what each effect of a scene costs, and how far the force and the wound move without it.
//!
//! The scene runs from its beginning to its end, and beside it the same scene without each effect that is on and with each one that is off: all
//! in one thread, some ticks of each in turn, so that whatever else the machine does slows all of them alike. What the runs differ in is the
//! worth of an effect. Its price is the time of a tick, and where valgrind is present the instructions of a tick, counted in child processes
//! over a span that begins at the skin: the way there through the air is left out.

mod course;
mod files;
mod leave;
mod report;
mod upload;

pub use leave::without;
pub use report::{Counted, Report, Row};
pub use upload::{ticks, write};

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use sutura_controller::effects::{self, TABLE};
use sutura_controller::lanes::Level;
use sutura_shared::scene::{Effect, Motion, Scene, Solver, Until};

use self::course::Course;
use super::callgrind;
use crate::run;
use crate::scene::Draft;
use crate::scene::build::{self, Built};

/// Ticks of the span in which instructions are counted: enough for the built-in scene's needle to pass the skin and go through the tissue.
const COUNTED: u32 = 3_000;
/// The same in a quick study.
const COUNTED_QUICK: u32 = 100;
/// The function whose instructions are a tick's.
const TICK: &str = "*PcRig*tick*";
/// Child processes at a time.
const CHILDREN: usize = 2;

/// What to study.
#[derive(Clone, Debug)]
pub struct Request {
    /// A scene file; none is the built-in scene.
    pub scene: Option<PathBuf>,
    /// Whether to count instructions over a short span only.
    pub quick: bool,
    /// What the controller's passes run on where time is taken.
    pub level: Level,
    /// This program, to be started again under valgrind.
    pub program: PathBuf,
    /// Folder for the files.
    pub out: PathBuf,
}

/// What a study has come to: a line for whoever waits.
pub type Progress<'a> = &'a mut dyn FnMut(&str);

/// Studies a scene; `interrupted` ends it without a file.
///
/// # Errors
/// See [`Error`].
pub fn run(request: &Request, interrupted: &AtomicBool, progress: Progress<'_>) -> Result<Report, Error> {
    let draft = Draft::open(request.scene.as_deref(), &[]).map_err(run::Error::from)?;
    let base = built(request, &draft, interrupted)?;
    let cases: Vec<Case> = TABLE.iter().map(|row| Case::new(&draft, &base, row.effect)).collect();
    run::files::folder(&request.out)?;
    let scenes: Vec<&Scene> = [&base.scene]
        .into_iter()
        .chain(cases.iter().filter_map(|case| case.other.as_ref().ok()))
        .collect();
    let courses = course::run(&scenes, &base.cells, request.level, interrupted, progress)?;
    let counted = count(request, &scenes, &base.cells, interrupted, progress)?;
    let report = report(request, &base, &cases, (&courses, counted));
    files::write(&request.out, &report)?;
    Ok(report)
}

/// The scene as a run would have it, its solver chosen.
fn built(request: &Request, draft: &Draft, interrupted: &AtomicBool) -> Result<Built, run::Error> {
    let plan = draft.plan()?;
    let mut built = build::build(&plan, run::embedded::NODES_MAX)?;
    let (solver, _) = run::solver::settled(plan.solver, (draft, &built), request.level, interrupted)?;
    built.scene.solver = solver;
    Ok(built)
}

/// One effect and the scene that differs in it.
struct Case {
    effect: Effect,
    /// Whether it is on in the scene that is studied.
    on: bool,
    /// The scene without it, or with it; or why there is none.
    other: Result<Scene, String>,
}

impl Case {
    fn new(draft: &Draft, base: &Built, effect: Effect) -> Self {
        let on = base.scene.effects.has(effect);
        let other = match on {
            true => Ok(without(&base.scene, effect)),
            false => with(draft, base, effect).map_err(|error| error.to_string()),
        };
        Self { effect, on, other }
    }
}

/// The scene with `effect` and what that needs, their keys at their defaults. Explicit substeps are as many as it needs to be stable.
fn with(draft: &Draft, base: &Built, effect: Effect) -> Result<Scene, run::Error> {
    let chain = std::iter::successors(Some(effect), |&effect| effects::row(effect).needs);
    let plan = draft.plan_with(&chain.collect::<Vec<_>>())?;
    let mut scene = build::build(&plan, run::embedded::NODES_MAX)?.scene;
    scene.solver = match base.scene.solver {
        Solver::Explicit { .. } => Solver::Explicit { substeps: 0 },
        other => other,
    };
    Ok(scene)
}

/// Instructions of a tick of each scene, as far as they can be counted.
fn count(
    request: &Request,
    scenes: &[&Scene],
    cells: &[u8],
    interrupted: &AtomicBool,
    progress: Progress<'_>,
) -> Result<Counted, Error> {
    if let Err(error) = callgrind::present() {
        tracing::warn!("{error}");
        return Ok(Counted::Not(error.to_string()));
    }
    let ticks = if request.quick { COUNTED_QUICK } else { COUNTED };
    let folder = tempfile::tempdir().map_err(callgrind::Error::Folder)?;
    let one = |(index, scene): (usize, &&Scene)| -> Result<f64, Error> {
        let file = folder.path().join(index.to_string());
        write(&file, &at_skin(scene), cells)?;
        let arguments = ["ticks".into(), file.into_os_string(), ticks.to_string().into()];
        let all = callgrind::instructions(&request.program, &arguments, TICK)?;
        Ok(all as f64 / f64::from(ticks))
    };
    let mut counts = Vec::new();
    let jobs: Vec<_> = scenes.iter().enumerate().collect();
    for some in jobs.chunks(CHILDREN) {
        progress(&format!(
            "counting instructions, {} of {} scenes",
            counts.len(),
            scenes.len()
        ));
        let results: Vec<_> = std::thread::scope(|scope| {
            let children: Vec<_> = some.iter().map(|&job| scope.spawn(move || one(job))).collect();
            children.into_iter().map(|child| child.join()).collect()
        });
        if interrupted.load(Ordering::Relaxed) {
            return Err(Error::Interrupted);
        }
        for result in results {
            counts.push(result.map_err(|_| Error::Thread)??);
        }
    }
    Ok(Counted::Over { ticks, counts })
}

/// The scene with the hand where its first way through the air ends.
fn at_skin(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    if let Some(hand) = &mut scene.hand
        && let Some(first) = hand.steps.first()
        && let (Motion::Line { to }, Until::Elapsed) = (first.motion, first.until)
    {
        hand.start = to;
        hand.steps.remove(0);
    }
    scene
}

fn report(request: &Request, base: &Built, cases: &[Case], (courses, counted): (&[Course], Counted)) -> Report {
    let name = request.scene.as_deref().map(Path::display);
    let nodes = base
        .scene
        .lattice
        .cells
        .iter()
        .fold(1, |all, cells| all * (usize::from(*cells) + 1));
    let [own, others @ ..] = courses else {
        return Report::default();
    };
    let mut others = others.iter().zip(1..);
    let mut rows = Vec::new();
    for case in cases {
        let mut row = Row::new(effects::row(case.effect), case.on, nodes);
        match &case.other {
            Ok(scene) => {
                row.also = also(case, &base.scene, scene);
                if let Some((other, index)) = others.next() {
                    let pair = if case.on { [own, other] } else { [other, own] };
                    row.compare(pair, base.scene.wound.is_some());
                    row.count(&counted, if case.on { [0, index] } else { [index, 0] });
                }
            }
            Err(why) => row.why = Some(why.clone()),
        }
        rows.push(row);
    }
    Report {
        scene: name.map_or_else(|| "built-in scene".to_owned(), |name| name.to_string()),
        nodes,
        solver: base.scene.solver.to_string(),
        ticks: own.ticks(),
        counted_ticks: counted.ticks(),
        not_counted: counted.why(),
        rows,
        out: request.out.display().to_string(),
    }
}

/// Effects that `scene` differs in from the base beside the case's own.
fn also(case: &Case, base: &Scene, scene: &Scene) -> Vec<&'static str> {
    let others = Effect::ALL.into_iter().filter(|&effect| effect != case.effect);
    others
        .filter(|&effect| base.effects.has(effect) != scene.effects.has(effect))
        .map(Effect::name)
        .collect()
}

/// Why there is no study; one line each.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The scene does not run.
    #[error(transparent)]
    Run(#[from] run::Error),
    /// The controller refuses it.
    #[error("the controller refuses the scene: {0}")]
    Refused(&'static str),
    /// The scene does not fit into an upload.
    #[error("the scene takes more than {most} bytes, the longest upload")]
    TooLong {
        /// What fits [bytes].
        most: usize,
    },
    /// A scene as bytes is none.
    #[error("{}: no upload of a scene: {what}", path.display())]
    Upload {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// A file.
    #[error(transparent)]
    Files(#[from] run::files::Error),
    /// Counting.
    #[error(transparent)]
    Count(#[from] callgrind::Error),
    /// A thread of ours panicked.
    #[error("a thread of the study stopped: this is a defect of the program")]
    Thread,
    /// Ctrl+C.
    #[error("interrupted")]
    Interrupted,
}

impl Error {
    /// Of a program that ends with this error.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Run(error) => error.exit_code(),
            Self::Refused(_) | Self::TooLong { .. } | Self::Upload { .. } => 2,
            Self::Files(run::files::Error::File { .. } | run::files::Error::NotFolder { .. })
            | Self::Count(callgrind::Error::Folder(_)) => 2,
            Self::Files(_) | Self::Count(_) | Self::Thread => 1,
            Self::Interrupted => 130,
        }
    }
}
