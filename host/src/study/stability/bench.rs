//! A controller with a tool that is wherever a case puts it: a pose a tick, no hand and no device between.

use sutura_controller::lattice::{Lattice, PC_NODES, Tissue};
use sutura_controller::math::{Mat3, Pose, Vec3};
use sutura_controller::record::{Output, Sample};
use sutura_controller::tick::{Controller, Memory};
use sutura_shared::scene::Scene;

use super::case::{Attempt, Unfinished};
use super::watch::{Trace, Watch};
use crate::study::block;

/// A controller under watch.
#[derive(Debug)]
pub struct Bench<'a> {
    attempt: Attempt<'a>,
    controller: Controller<'a, PC_NODES>,
    watch: Watch,
    /// K_c [N/m].
    coupling: f64,
}

/// Memory for one bench, on the heap.
#[must_use]
pub fn memory() -> Box<Memory<PC_NODES>> {
    bytemuck::zeroed_box()
}

impl<'a> Bench<'a> {
    /// The scene at rest; its solver is the attempt's.
    ///
    /// # Errors
    /// The controller refuses the scene or its solver.
    pub fn new(
        attempt: Attempt<'a>,
        memory: &'a mut Memory<PC_NODES>,
        scene: &Scene,
        cells: &[u8],
    ) -> Result<Self, Unfinished> {
        let refused = |error| Unfinished::of(scene.solver, error);
        let mut controller = Controller::new(memory, attempt.level);
        controller.load(scene, cells).map_err(refused)?;
        let watch = Watch::new(scene, cells).map_err(|error| match error {
            block::Error::Assembly(error) => Unfinished::of(scene.solver, error.into()),
            block::Error::Nodes { .. } => Unfinished::Interrupted,
        })?;
        Ok(Self {
            attempt,
            controller,
            watch,
            coupling: f64::from(scene.contact.coupling_n_per_m),
        })
    }

    /// The patch and its state, to begin elsewhere than at rest.
    pub const fn patch_mut(&mut self) -> (&mut Lattice<PC_NODES>, &mut Tissue<PC_NODES>) {
        self.controller.patch_mut()
    }

    /// One tick with the tool's grasp point there, upright [m].
    ///
    /// # Errors
    /// [`Unfinished::Interrupted`].
    pub fn tick(&mut self, place: Vec3) -> Result<Output, Unfinished> {
        self.attempt.go_on()?;
        let pose = Pose {
            position: place,
            rotation: Mat3::identity(),
        };
        let output = self.controller.tick(&Sample { pose, button: false });
        // The coupling's spring holds F²/2K; what its damper adds to F is gone with the tick.
        let held = f64::from(output.simulated.norm_squared()) / (2.0 * self.coupling);
        let state = (self.controller.lattice(), self.controller.tissue());
        self.watch.see(state, &output, held);
        Ok(output)
    }

    /// The input stops: `ticks` ticks with the tool at `place`, which asks nothing of the tissue.
    ///
    /// # Errors
    /// [`Unfinished::Interrupted`].
    pub fn let_go(mut self, place: Vec3, ticks: u32) -> Result<Trace, Unfinished> {
        let state = (self.controller.lattice(), self.controller.tissue());
        self.watch.let_go(state, 0.0);
        for _ in 0..ticks {
            self.tick(place)?;
        }
        Ok(self.watch.trace(self.controller.lattice(), self.controller.tissue()))
    }
}
