//! The choice for a scene: whole ticks of that very scene, and a node of its skin near the place where it is worked on.

use std::sync::atomic::AtomicBool;

use sutura_controller::lanes::Level;
use sutura_controller::lattice::{Lattice, PC_NODES};
use sutura_shared::scene::Scene;

use super::clock::{Clock, Stopped};
use super::dials::families;
use super::probe::Probe;
use super::remedy::{self, Unmet};
use super::{Extent, Interrupted, Row, Table, confirm, survey};
use crate::scene::build::Built;
use crate::scene::{self, Draft};
use crate::study::block::{self, Block};
use crate::study::path::{Course, Path};

/// What moves the node, each blended in over 50 ms, and for how long [ticks]: one period of the slower one.
const COURSES: [Course; 2] = [
    Course {
        path: Path::Drag,
        ramp_s: 0.05,
    },
    Course {
        path: Path::Tap,
        ramp_s: 0.05,
    },
];
const TICKS: u32 = 100;

/// A scene and its budget.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The scene as it was written.
    pub draft: &'a Draft,
    /// What came of it.
    pub built: &'a Built,
    /// CPU time that a tick may take [µs].
    pub budget_us: u16,
    /// What the controller's passes run on.
    pub level: Level,
    /// How many solvers are looked at.
    pub extent: Extent,
}

/// Times and measures solvers on a scene and chooses one.
///
/// # Errors
/// See [`Error`].
pub fn run(request: &Request<'_>, interrupted: &AtomicBool) -> Result<Table, Error> {
    let Request {
        built,
        budget_us,
        level,
        extent,
        ..
    } = *request;
    let block = Block::of(&built.scene, &built.cells)?;
    let node = skin(&block.lattice, &built.scene).ok_or(Error::NoSkin)?;
    let probe = Probe::new((block, node), (&COURSES, TICKS), level, interrupted)?;
    let mut clock = Clock::new(&built.scene, &built.cells, level, interrupted);
    let mut rows = survey::<Error>(
        &families(probe.substeps()),
        (budget_us, extent),
        |solver, limit_us| match extent {
            Extent::Choice => Ok(clock.glance(solver)?),
            Extent::Table => Ok(clock.time(solver, limit_us)?),
        },
        |solver| Ok(probe.error(solver)?),
    )?;
    if extent == Extent::Choice {
        confirm::<Error>(&mut rows, budget_us, |solver| Ok(clock.time(solver, f64::INFINITY)?))?;
    }
    match Table::new(budget_us, rows) {
        Ok(table) => Ok(table),
        Err(rows) => Err(Error::Unmet(unmet(request, &rows, interrupted)?)),
    }
}

/// What would meet the budget.
fn unmet(request: &Request<'_>, rows: &[Row], interrupted: &AtomicBool) -> Result<Unmet, Error> {
    let cheapest = rows.iter().min_by(|a, b| a.us_median.total_cmp(&b.us_median));
    let cheapest = cheapest.ok_or(Error::NoSolver)?;
    let limit_us = f64::from(request.budget_us);
    // Another lattice may have no scene at all, which is no remedy; what a clock says of it may end the search.
    let time = |draft: &Draft| -> Result<Option<f64>, Error> {
        let Ok(plan) = draft.plan() else { return Ok(None) };
        let Ok(built) = scene::build::build(&plan, crate::run::embedded::NODES_MAX) else {
            return Ok(None);
        };
        let mut clock = Clock::new(&built.scene, &built.cells, request.level, interrupted);
        match clock.time(cheapest.solver, limit_us) {
            Ok(us) => Ok(us.map(|us| us.median)),
            Err(Stopped::Refused(_)) => Ok(None),
            Err(stopped) => Err(stopped.into()),
        }
    };
    remedy::search(request.draft, (request.budget_us, cheapest), time)
}

/// The free node at the top of the lattice that is nearest to where the scene is worked on: to the first puncture, or to the middle.
fn skin(lattice: &Lattice<PC_NODES>, scene: &Scene) -> Option<usize> {
    let [x, y] = scene.stitch.map_or([0.0; 2], |stitch| stitch.a_m);
    let [nx, ny, _] = lattice.nodes;
    let columns = (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j)));
    let free = |node: &usize| lattice.free.get(*node).is_some_and(|free| *free > 0.0);
    let away = |node: &usize| {
        let place = lattice.rest_place(*node);
        (place.x - x).powi(2) + (place.y - y).powi(2)
    };
    let tops = columns.filter_map(|(i, j)| lattice.top(i, j)).filter(free);
    tops.min_by(|a, b| away(a).total_cmp(&away(b)))
}

/// Why nothing is chosen; one line each.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The scene's text.
    #[error(transparent)]
    Scene(#[from] scene::Error),
    /// The scene's lattice.
    #[error(transparent)]
    Block(#[from] block::Error),
    /// All of the skin is held.
    #[error("all of the skin is held, so no force can be compared: a larger patch is right")]
    NoSkin,
    /// No solver holds the tissue.
    #[error("no solver keeps this tissue's state finite: softer or denser tissue is right")]
    NoSolver,
    /// Its controller.
    #[error(transparent)]
    Clock(Stopped),
    /// No solver within the budget.
    #[error(transparent)]
    Unmet(Unmet),
    /// Ctrl+C.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl From<Stopped> for Error {
    fn from(stopped: Stopped) -> Self {
        match stopped {
            Stopped::Interrupted(interrupted) => Self::Interrupted(interrupted),
            refused @ Stopped::Refused(_) => Self::Clock(refused),
        }
    }
}

impl Error {
    /// The exit code: 2 for the user's input or environment, 130 for an interrupt.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Interrupted(_) => 130,
            _ => 2,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::embedded::NODES_MAX;

    /// The left puncture is half the gap of 4 mm and a bite of 4 mm from the wound's middle, and nodes are 2 mm apart.
    #[test]
    fn the_node_is_where_the_needle_goes_in() {
        let built = scene::build::build(&scene::load(None).unwrap(), NODES_MAX).unwrap();
        let block = Block::of(&built.scene, &built.cells).unwrap();
        let node = skin(&block.lattice, &built.scene).unwrap();
        let place = block.lattice.rest_place(node);
        assert!(
            (place.x + 6e-3).abs() < 1e-6 && place.y.abs() < 1.1e-3 && place.z.abs() < 1e-6,
            "{place}"
        );
        assert!(block.lattice.free[node] > 0.0);
    }
}
