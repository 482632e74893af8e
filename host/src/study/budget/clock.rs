//! The time of a scene's whole tick: needle, thread, contact, tissue, safety, through the rig that runs it, in this thread.

use std::sync::atomic::{AtomicBool, Ordering};

use bytemuck::zeroed_box;
use sutura_controller::lanes::Level;
use sutura_controller::lattice::PC_NODES;
use sutura_controller::link::{LoadError, Plant as _};
use sutura_controller::record::Fault;
use sutura_controller::tick::Memory;
use sutura_shared::scene::{Motion, Scene, Solver};

use super::Interrupted;
use crate::link::thread_time;
use crate::run::embedded::PcRig;
use crate::run::report::TickTime;

/// Ticks of a glance, and how many of its first ones do not count.
const GLANCE: usize = 60;
const WARM: usize = 10;
/// Ticks in all, and how many of the last ones count: by then a tool at 8 mm/s has come down 3 mm of air and is in contact.
const TICKS: usize = 800;
const COUNTED: usize = 300;

/// A scene whose ticks are timed.
pub struct Clock<'a> {
    scene: Scene,
    cells: &'a [u8],
    level: Level,
    memory: Box<Memory<PC_NODES>>,
    interrupted: &'a AtomicBool,
}

impl<'a> Clock<'a> {
    /// A scene without its hand's way through the air, so that the tissue is soon under load.
    #[must_use]
    pub fn new(scene: &Scene, cells: &'a [u8], level: Level, interrupted: &'a AtomicBool) -> Self {
        let mut scene = scene.clone();
        if let Some(hand) = &mut scene.hand
            && let Some(Motion::Line { to }) = hand.steps.first().map(|step| step.motion)
            && hand.steps.len() > 1
        {
            hand.start = to;
            hand.steps.remove(0);
        }
        Self {
            scene,
            cells,
            level,
            memory: zeroed_box(),
            interrupted,
        }
    }

    /// CPU time of a tick with `solver`, after a glance, before the tool is in contact. `None` where the tissue's state does not stay finite.
    ///
    /// # Errors
    /// The controller refuses the scene, or Ctrl+C.
    pub fn glance(&mut self, solver: Solver) -> Result<Option<TickTime>, Stopped> {
        let ns = self.run(solver, GLANCE, |_| true)?;
        Ok(ns.map(|mut ns| TickTime::of(ns.split_off(WARM))))
    }

    /// CPU time of a tick with `solver`, the tool in contact; beyond `limit_us` [µs] a glance is enough. `None` where the tissue's state
    /// does not stay finite.
    ///
    /// # Errors
    /// As of [`Clock::glance`].
    pub fn time(&mut self, solver: Solver, limit_us: f64) -> Result<Option<TickTime>, Stopped> {
        let first = |ns: &[u64]| TickTime::of(ns.iter().skip(WARM).copied().collect());
        let promising = |ns: &[u64]| ns.len() != GLANCE || first(ns).median <= limit_us;
        let ns = self.run(solver, TICKS, promising)?;
        Ok(ns.map(|mut ns| match ns.len() {
            TICKS => TickTime::of(ns.split_off(TICKS - COUNTED)),
            _ => first(&ns),
        }))
    }

    /// Runs some ticks, or as many as `go_on` wants after each, and gives their times [ns].
    fn run(
        &mut self,
        solver: Solver,
        ticks: usize,
        go_on: impl Fn(&[u64]) -> bool,
    ) -> Result<Option<Vec<u64>>, Stopped> {
        self.scene.solver = solver;
        let mut rig = PcRig::new(&mut self.memory, self.level);
        rig.load(&self.scene, self.cells)?;
        let mut ns = Vec::with_capacity(ticks);
        while ns.len() < ticks && go_on(&ns) {
            let start = thread_time();
            let output = rig.tick();
            ns.push(thread_time().saturating_sub(start).as_nanos() as u64);
            if output.faults.has(Fault::State) {
                return Ok(None);
            }
            if self.interrupted.load(Ordering::Relaxed) {
                return Err(Interrupted.into());
            }
        }
        Ok(Some(ns))
    }
}

/// Why a scene has no time; one line each.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Stopped {
    /// The controller refuses it.
    #[error("the controller refuses the scene: {} is right", .0.0)]
    Refused(LoadError),
    /// Ctrl+C.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl From<LoadError> for Stopped {
    fn from(error: LoadError) -> Self {
        Self::Refused(error)
    }
}
