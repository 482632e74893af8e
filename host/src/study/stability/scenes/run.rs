//! One scene under way: where the tool is, tick by tick, and what is seen of it.

use sutura_controller::lattice::PC_NODES;
use sutura_controller::math::{Pose, Vec3};
use sutura_controller::record::{Output, Sample};
use sutura_controller::tick::{Controller, Memory};
use sutura_controller::wound::{self, Faces};
use sutura_shared::scene::{Effect, Scene};

use super::circle::Circle;
use crate::study::block;
use crate::study::stability::case::{Attempt, Unfinished};
use crate::study::stability::watch::{Trace, Watch};

/// Time after the input [ticks].
const REST: u32 = 1500;
/// The period [s].
const DT: f32 = 1e-3;

/// A controller under watch.
pub(super) struct Run<'a> {
    attempt: Attempt<'a>,
    controller: Controller<'a, PC_NODES>,
    watch: Watch,
    faces: Option<Faces>,
    device_from_patch: Pose,
    /// Where the tool is, patch frame.
    tool: Pose,
}

impl<'a> Run<'a> {
    /// The scene at rest, the tool at `tool` in the patch frame.
    pub(super) fn new(
        attempt: Attempt<'a>,
        memory: &'a mut Memory<PC_NODES>,
        (scene, cells): &(Scene, Vec<u8>),
        tool: Pose,
    ) -> Result<Self, Unfinished> {
        let refused = |error| Unfinished::of(scene.solver, error);
        let mut controller = Controller::new(memory, attempt.level);
        controller.load(scene, cells).map_err(refused)?;
        let watch = Watch::new(scene, cells).map_err(|error| match error {
            block::Error::Assembly(error) => refused(error.into()),
            block::Error::Nodes { .. } => Unfinished::Interrupted,
        })?;
        let wound = scene.wound.filter(|_| scene.effects.has(Effect::WoundContact));
        Ok(Self {
            faces: wound.and_then(|wound| wound::faces(&wound, None, controller.lattice()).ok()),
            device_from_patch: Pose::from(scene.device.patch_from_device).inverse(),
            attempt,
            controller,
            watch,
            tool,
        })
    }

    /// A pose of the patch frame in the device's.
    pub(super) fn in_device(&self, pose: Pose) -> Pose {
        self.device_from_patch.then(&pose)
    }

    /// One tick with the stylus there, device frame.
    pub(super) fn sense(&mut self, pose: Pose) -> Result<Output, Unfinished> {
        self.attempt.go_on()?;
        let output = self.controller.tick(&Sample { pose, button: false });
        let held = self.contact();
        let state = (self.controller.lattice(), self.controller.tissue());
        self.watch.see(state, &output, held);
        Ok(output)
    }

    /// One tick with the tool there, patch frame.
    pub(super) fn tick(&mut self, tool: Pose) -> Result<Output, Unfinished> {
        self.tool = tool;
        self.sense(self.in_device(tool))
    }

    /// The tool stays.
    pub(super) fn wait(&mut self, ticks: u32) -> Result<(), Unfinished> {
        (0..ticks).try_for_each(|_| self.tick(self.tool).map(drop))
    }

    /// The tool jumps by `far` [m].
    pub(super) fn jump(&mut self, far: Vec3) {
        self.tool.position += far;
    }

    /// Takes the tool straight to `place` at `speed` [m/s].
    pub(super) fn go(&mut self, place: Vec3, speed: f32) -> Result<(), Unfinished> {
        let from = self.tool;
        let way = place - from.position;
        let ticks = (way.norm() / (speed * DT)).ceil().max(1.0);
        (1..=ticks as u32).try_for_each(|tick| {
            let position = from.position + way * (tick as f32 / ticks);
            self.tick(Pose { position, ..from }).map(drop)
        })
    }

    /// Turns the needle on its circle, its tip `between` these angles, at a `speed` of the tip [m/s].
    pub(super) fn turn(&mut self, circle: &Circle, [from, to]: [f32; 2], speed: f32) -> Result<(), Unfinished> {
        let ticks = ((to - from).abs() / circle.turn(speed * DT)).ceil().max(1.0);
        (1..=ticks as u32).try_for_each(|tick| {
            let turned = from + (to - from) * (tick as f32 / ticks);
            self.tick(circle.at(turned)).map(drop)
        })
    }

    /// The tool has let go: the input stops here.
    pub(super) fn let_go(&mut self) {
        let held = self.contact();
        self.watch
            .let_go((self.controller.lattice(), self.controller.tissue()), held);
    }

    /// The tool has let go, and stays until all is at rest.
    pub(super) fn rest(mut self) -> Result<Trace, Unfinished> {
        self.let_go();
        self.wait(REST)?;
        Ok(self.trace())
    }

    /// All that was seen.
    pub(super) fn trace(self) -> Trace {
        let trace = self.watch.trace(self.controller.lattice(), self.controller.tissue());
        let energies = trace.moments.iter().map(|moment| moment.energy_j);
        Trace {
            peak_j: energies.fold(0.0, f64::max),
            ..trace
        }
    }

    /// Energy of the wound's faces where they have met, ½ k g² of each pair [J].
    fn contact(&self) -> f64 {
        let Some(faces) = &self.faces else { return 0.0 };
        let [x, ..] = &self.controller.tissue().displacement;
        let pair = |(left, right): (usize, usize)| {
            let width = faces.width(x[left], x[right]).min(0.0);
            0.5 * f64::from(faces.penalty) * f64::from(width).powi(2)
        };
        faces.pairs().map(pair).sum()
    }
}
