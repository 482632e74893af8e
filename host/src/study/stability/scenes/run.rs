//! One scene under way: where the tool is, tick by tick, and what is seen of it.

use sutura_controller::lattice::{Lattice, PC_NODES, Tissue};
use sutura_controller::math::{Pose, Vec3};
use sutura_controller::record::{Output, Sample};
use sutura_controller::tick::{Controller, Memory};
use sutura_controller::wound::{self, Faces};
use sutura_shared::scene::{Effect, Scene, Thread};

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
    thread: Option<Thread>,
    /// Whether the stylus button is pressed.
    pressed: bool,
    /// Whether the thread is tied.
    tied: bool,
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
            thread: scene.thread,
            faces: wound.and_then(|wound| wound::faces(&wound, None, controller.lattice()).ok()),
            device_from_patch: Pose::from(scene.device.patch_from_device).inverse(),
            attempt,
            controller,
            watch,
            tool,
            pressed: false,
            tied: false,
        })
    }

    /// A pose of the patch frame in the device's.
    pub(super) fn in_device(&self, pose: Pose) -> Pose {
        self.device_from_patch.then(&pose)
    }

    /// One tick with the stylus there, device frame.
    pub(super) fn sense(&mut self, pose: Pose) -> Result<Output, Unfinished> {
        self.attempt.go_on()?;
        let output = self.controller.tick(&Sample {
            pose,
            button: self.pressed,
        });
        let held = self.held();
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

    /// Turns the tool where it is, and takes it to `pose` at 1 m/s.
    pub(super) fn turn_to(&mut self, pose: Pose) -> Result<(), Unfinished> {
        let position = self.tool.position;
        self.tick(Pose { position, ..pose })?;
        self.go(pose.position, 1.0)
    }

    /// Ties the thread and cuts it from the needle.
    pub(super) fn tie(&mut self) -> Result<(), Unfinished> {
        self.pressed = true;
        self.wait(1)?;
        (self.pressed, self.tied) = (false, true);
        Ok(())
    }

    /// The patch and its state, to be held where no tool does it.
    pub(super) const fn patch_mut(&mut self) -> (&mut Lattice<PC_NODES>, &mut Tissue<PC_NODES>) {
        self.controller.patch_mut()
    }

    /// What there is to see.
    pub(super) const fn controller(&self) -> &Controller<'a, PC_NODES> {
        &self.controller
    }

    /// From the needle's swage to where the hand holds the tool [m].
    pub(super) fn grasp(&self) -> Vec3 {
        let swage = self.controller.tool().map(|arc| self.tool.position - arc.swage());
        swage.unwrap_or_default()
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
        let held = self.held();
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

    /// Energy that is held outside of the tissue [J].
    fn held(&self) -> f64 {
        self.contact() + self.stretched()
    }

    /// Energy of a tied stitch, T² l₀/2EA; a thread in the hand gives its own back to the hand [J].
    fn stretched(&self) -> f64 {
        let Some(thread) = self.thread.filter(|_| self.tied) else {
            return 0.0;
        };
        let pull = self.controller.pull();
        let [tension, axial, length] = [pull.stitch, thread.axial_n, pull.between].map(f64::from);
        0.5 * tension * tension * length / (axial + tension)
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
