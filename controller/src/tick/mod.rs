//! One millisecond: sense → contact → thread → deform → force → safety → output.
//!
//! What couples two parts of the physics happens here, through slices and small records; the parts do not know each other.

mod params;
mod sewing;
mod view;

pub use params::ConfigError;

use crate::coupling::Coupling;
use crate::event::{Fault, Faults};
use crate::hash::Hasher;
use crate::lanes::Level;
use crate::lattice::{Balance, Field, Lattice, Tissue};
use crate::math::{Pose, Vec3, finite, length};
use crate::needle::{self, Arc, Passage};
use crate::record::{Output, Sample};
use crate::safety::{self, Gate};
use crate::solver::{self, Choice, Problem, Solver, Work};
use crate::stage;
use crate::thread::{self, Pull};
use crate::tissue;
use bytemuck::Zeroable;
use params::Params;
use sewing::Sewn;
use sutura_shared::scene::Scene;

/// Everything that grows with the lattice. All zeros is a valid empty one.
#[derive(Clone, Debug, PartialEq, Zeroable)]
#[repr(C, align(64))]
pub struct Memory<const N: usize> {
    /// The patch.
    pub lattice: Lattice<N>,
    /// Its state.
    pub tissue: Tissue<N>,
    /// Load on its nodes [N].
    load: Field<N>,
    /// Scratch.
    work: Work<N>,
}

/// What changes from tick to tick, apart from the tissue.
#[derive(Clone, Debug, Default, PartialEq)]
struct State {
    tick: u32,
    stage: stage::State,
    needle: needle::State,
    sewn: Sewn,
    thread: Option<thread::State>,
    safety: safety::State,
    faults: Faults,
    pull: Pull,
}

/// The controller: a scene's coefficients and state.
#[derive(Debug)]
pub struct Controller<'m, const N: usize> {
    memory: &'m mut Memory<N>,
    level: Level,
    thread_work: thread::Work,
    running: Option<(Params, State)>,
}

impl<'m, const N: usize> Controller<'m, N> {
    /// A controller without a scene: zero force. Its passes run on `level`.
    #[must_use]
    pub fn new(memory: &'m mut Memory<N>, level: Level) -> Self {
        Self {
            memory,
            level,
            thread_work: thread::Work::default(),
            running: None,
        }
    }

    /// Takes a scene: the only step that can fail.
    ///
    /// # Errors
    ///
    /// What the scene lacks, see [`ConfigError`]; the controller then has no scene and gives zero force.
    pub fn load(&mut self, scene: &Scene, cells: &[u8]) -> Result<(), ConfigError> {
        self.running = None;
        let Memory {
            lattice,
            tissue,
            load,
            work,
        } = &mut *self.memory;
        let material = tissue::assemble(scene, cells, lattice)?;
        for field in [&mut tissue.displacement, &mut tissue.velocity, load] {
            field.iter_mut().for_each(|c| c.fill(0.0));
        }
        // At rest nothing is held.
        tissue.balance = Balance {
            known: 1,
            ..Balance::default()
        };
        work.clear();
        let alone = Problem {
            lattice,
            material: &material,
            coupling: &Coupling::default(),
            faces: None,
            level: self.level,
        };
        let solver = Choice::new(scene.solver, &alone, work)?;
        work.clear();
        let params = Params::new((scene, cells), (material, solver), lattice, tissue)?;
        let sewn = Sewn {
            tail: params.tail,
            ..Sewn::default()
        };
        self.running = Some((
            params,
            State {
                sewn,
                ..State::default()
            },
        ));
        Ok(())
    }

    /// The patch; empty without a scene.
    #[must_use]
    pub const fn lattice(&self) -> &Lattice<N> {
        &self.memory.lattice
    }

    /// The patch and its state, for studies that begin elsewhere than at rest, or hold what the scene does not.
    pub const fn patch_mut(&mut self) -> (&mut Lattice<N>, &mut Tissue<N>) {
        self.memory.tissue.balance.known = 0;
        (&mut self.memory.lattice, &mut self.memory.tissue)
    }

    /// One millisecond. It never fails: a fault is data in the output, and zero force.
    pub fn tick(&mut self, sample: &Sample) -> Output {
        let Some((params, state)) = &mut self.running else {
            return Output::idle();
        };
        let Memory {
            lattice,
            tissue,
            load,
            work,
        } = &mut *self.memory;
        state.tick = state.tick.wrapping_add(1);

        // sense
        let pose = sense(params, state, sample);
        let arc = Arc::new(params.needle.tool, pose);

        // contact
        let mut coupling = Coupling::default();
        needle::detect(&params.needle, &mut state.needle, &arc, &params.body(lattice, tissue));
        let holds = needle::couple(&params.needle, &mut state.needle, &arc, tissue, &mut coupling);

        // thread
        let thread = (&mut self.thread_work, &mut coupling);
        sewing::strain(params, state, &arc, (lattice, tissue), thread);

        // deform
        let problem = params.problem(lattice, &coupling, self.level);
        let moved = params.solver.advance(&problem, load, tissue, work);
        let finite = moved.into_iter().all(finite) && solver::is_finite(self.level, lattice.len(), tissue);
        let stuck = tissue.balance.caution >= Balance::CAUTION_MAX;
        state.faults = state.faults.with(Fault::State, !finite || stuck);

        // force
        let grip = needle::settle(&params.needle, &mut state.needle, &arc, (&holds, &moved), tissue);
        state.pull = sewing::relax(params, state, &moved, (lattice, load), &mut self.thread_work);
        sewing::tear(params, state, &params.body(lattice, tissue));
        let simulated = grip.force + state.pull.direction * state.pull.tension;

        // safety: every force leaves through here
        let edge = limit(params, state, simulated, sample);

        // output
        sewing::advance(params, state, sample);
        let gap = params.gap(lattice, tissue);
        Output {
            tick: state.tick,
            stage: state.stage.stage,
            stitch: state.sewn.stitches as u8 + 1,
            faults: state.faults,
            simulated,
            rendered: edge.force,
            torque: grip.torque,
            position: pose.position,
            thread: state.pull.tension,
            gap: gap.at_stitches,
            gap_mean: gap.mean,
            saturated: edge.saturated,
            puncture: grip.puncture,
        }
    }

    /// The patch's state, for reports.
    #[must_use]
    pub const fn tissue(&self) -> &Tissue<N> {
        &self.memory.tissue
    }

    /// Adds all live state to a hash: existing nodes, needle, thread.
    pub fn add_to(&self, hasher: &mut Hasher) {
        let Some((params, state)) = &self.running else { return };
        let Memory { lattice, tissue, .. } = &*self.memory;
        let exists = |n: &usize| lattice.mass.get(*n).is_some_and(|m| *m > 0.0);
        for field in [&tissue.displacement, &tissue.velocity] {
            for node in (0..lattice.len()).filter(exists) {
                hasher.vector(crate::lattice::at(field, node));
            }
        }
        hasher.vector(Vec3::new(tissue.balance.caution, 0.0, 0.0));
        for point in [&state.sewn.tail].into_iter().chain(&state.sewn.points) {
            hasher.vector(point.rest);
        }
        for site in &state.needle.sites {
            if let Some(point) = site.point() {
                hasher.vector(point.rest);
            }
            match site {
                Passage::Hole(hole) => hasher.vector(Vec3::new(hole.from_tip, hole.adhesion, hole.cut)),
                Passage::Track(track) => hasher.vector(Vec3::x() * track.cut),
                Passage::Ahead | Passage::Touch(_) | Passage::Passed(_) => {}
            }
        }
        hasher.vector(state.needle.offset);
        hasher.vector(state.safety.sent);
        hasher.vector(Vec3::new(state.safety.energy, 0.0, 0.0));
        if let (Some(thread), Some(run)) = (&params.thread, &state.thread) {
            for (place, velocity) in run.live(thread) {
                hasher.vector(place);
                hasher.vector(velocity);
            }
            let loads = run.load.into_iter().take(run.course.count + 1);
            loads.for_each(|load| hasher.vector(load));
        }
    }
}

/// Furthest that the tool goes in one tick [m], 2 m/s: no hand sews as fast, and what tears tissue along faster turns its voxels inside out.
const WAY: f32 = 2e-3;

/// Tool pose in the patch frame. Encoders that jump lead the tool there at the speed of [`WAY`]; a pose that is not finite is a fault, which
/// stands until the next scene, and the tool stays.
fn sense(params: &Params, state: &mut State, sample: &Sample) -> Pose {
    let pose = params.patch_from_device.then(&sample.pose);
    let before = state.needle.before.unwrap_or(pose);
    let way = pose.position - before.position;
    let far = length(way);
    let good = sample.pose.rotation.iter().all(|x| x.is_finite()) && finite(way);
    state.faults = state.faults.with(Fault::Pose, !good);
    if !good {
        return state.needle.before.unwrap_or_default();
    }
    let position = if far > WAY {
        before.position + way * (WAY / far)
    } else {
        pose.position
    };
    Pose { position, ..pose }
}

/// The force in the device's frame, through the output edge.
fn limit(params: &Params, state: &mut State, simulated: Vec3, sample: &Sample) -> safety::Record {
    let device_from_patch = params.patch_from_device.rotation.transpose();
    let inputs = safety::Inputs {
        simulated: device_from_patch * simulated,
        tip: sample.pose.position,
        faults: state.faults,
        gate: Gate::Open,
    };
    let edge = safety::limit(&params.safety, &mut state.safety, &inputs);
    state.faults = edge.faults;
    edge
}
