//! One millisecond: sense → contact → thread → deform → force → safety → output.

use crate::coupling::{Coupling, LEFT, RIGHT, TAIL};
use crate::event::{Fault, Faults};
use crate::hash::Hasher;
use crate::lattice::{Field, Lattice, Tissue};
use crate::math::{Pose, Vec3, finite};
use crate::needle::{self, Arc, Passage, Point};
use crate::record::{Output, Sample};
use crate::safety::{self, Gate};
use crate::solver::{BePcg, Problem, Solver, Work};
use crate::thread::{self, Ends, Pull};
use crate::tissue::{self, Faces, Gap, Material, Skin};
use crate::{ConfigError, stage};
use bytemuck::Zeroable;
use sutura_shared::scene::{self, Effect, Scene, Stage};

/// Everything that grows with the lattice. All zeros is a valid empty one.
#[derive(Clone, Debug, PartialEq, Zeroable)]
#[repr(C)]
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

/// Coefficients of a scene; immutable while it runs.
#[derive(Clone, Debug, PartialEq)]
struct Params {
    material: Material,
    solver: BePcg,
    needle: needle::Params,
    thread: Option<thread::Params>,
    /// Where the thread's tail is held.
    tail: Point,
    /// The thread lies on the skin.
    lies: bool,
    faces: Option<Faces>,
    /// The faces meet.
    meet: bool,
    safety: safety::Params,
    patch_from_device: Pose,
}

/// What changes from tick to tick, apart from the tissue.
#[derive(Clone, Debug, Default, PartialEq)]
struct State {
    tick: u32,
    stage: stage::State,
    needle: needle::State,
    thread: Option<thread::State>,
    safety: safety::State,
    faults: Faults,
    tension: f32,
}

/// The controller: a scene's coefficients and state.
#[derive(Debug)]
pub struct Controller<'m, const N: usize> {
    memory: &'m mut Memory<N>,
    thread_work: thread::Work,
    running: Option<(Params, State)>,
}

impl<'m, const N: usize> Controller<'m, N> {
    /// A controller without a scene: zero force.
    #[must_use]
    pub fn new(memory: &'m mut Memory<N>) -> Self {
        Self {
            memory,
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
        let Memory { lattice, tissue, load, .. } = &mut *self.memory;
        let material = tissue::assemble(scene, cells, lattice)?;
        for field in [&mut tissue.displacement, &mut tissue.velocity, load] {
            field.iter_mut().for_each(|c| c.fill(0.0));
        }
        let params = Params::new(scene, material, lattice, tissue)?;
        self.running = Some((params, State::default()));
        Ok(())
    }

    /// One millisecond. It never fails: a fault is data in the output, and zero force.
    pub fn tick(&mut self, sample: &Sample) -> Output {
        let Some((params, state)) = &mut self.running else {
            return Output::idle();
        };
        let Memory { lattice, tissue, load, work } = &mut *self.memory;
        state.tick = state.tick.wrapping_add(1);
        let good = finite(sample.pose.position) && sample.pose.rotation.iter().all(|x| x.is_finite());
        state.faults = state.faults.with(Fault::Pose, !good);

        // sense
        let pose = params.patch_from_device.then(&if good { sample.pose } else { Pose::default() });
        let arc = Arc::new(params.needle.tool, pose);

        // contact
        needle::detect(&params.needle, &mut state.needle, &arc, lattice, tissue);
        let mut coupling = Coupling::default();
        let holds = needle::couple(&params.needle, &mut state.needle, &arc, tissue, &mut coupling);
        strain(params, state, &arc, (lattice, tissue), (&mut self.thread_work, &mut coupling));

        // deform
        let faces = params.faces.as_ref().filter(|_| params.meet);
        let problem = Problem { lattice, material: &params.material, coupling: &coupling, faces };
        let moved = params.solver.advance(&problem, load, tissue, work);
        state.faults = state.faults.with(Fault::State, !moved.into_iter().all(finite) || !work.is_finite(lattice.len()));

        // force
        let grip = needle::settle(&params.needle, &mut state.needle, &arc, (&holds, &moved), tissue);
        let pull = relax(params, state, [moved[TAIL], moved[RIGHT]], (lattice, load), &mut self.thread_work);
        let simulated = grip.force + pull.direction * pull.tension;
        state.tension = pull.tension;

        // safety: every force leaves through here
        let device_from_patch = params.patch_from_device.rotation.transpose();
        let edge = safety::limit(
            &params.safety,
            &mut state.safety,
            &safety::Inputs {
                simulated: device_from_patch * simulated,
                tip: sample.pose.position,
                faults: state.faults,
                gate: Gate::Open,
            },
        );
        state.faults = edge.faults;

        // output
        let signs = stage::Signs {
            needle: &state.needle,
            pierces: params.needle.f0.is_some(),
            tension: params.thread.as_ref().map(|_| state.tension),
            button: sample.button,
        };
        state.stage = stage::next(state.stage, &signs);
        let gap = params.faces.as_ref().map_or_else(Gap::default, |f| tissue::gap(f, lattice, tissue));
        Output {
            tick: state.tick,
            stage: state.stage.stage,
            faults: state.faults,
            simulated,
            rendered: edge.force,
            torque: grip.torque,
            position: pose.position,
            thread: state.tension,
            gap: gap.at_stitch,
            gap_mean: gap.mean,
            saturated: edge.saturated,
            puncture: grip.puncture,
        }
    }

    /// Adds all live state to a hash: existing nodes, needle, thread.
    pub fn hash(&self, hasher: &mut Hasher) {
        let Some((_, state)) = &self.running else { return };
        let Memory { lattice, tissue, .. } = &*self.memory;
        let exists = |n: &usize| lattice.mass.get(*n).is_some_and(|m| *m > 0.0);
        for field in [&tissue.displacement, &tissue.velocity] {
            for node in (0..lattice.len()).filter(exists) {
                hasher.vec3(crate::lattice::at(field, node));
            }
        }
        for site in [&state.needle.left, &state.needle.right] {
            if let Some(point) = site.point() {
                hasher.vec3(point.rest);
            }
        }
        for node in state.thread.iter().flat_map(thread::State::live) {
            hasher.vec3(node);
        }
    }
}

/// States the thread's pull on its two points, condensed, and adds it to the coupling.
fn strain<const N: usize>(
    params: &Params,
    state: &mut State,
    arc: &Arc,
    (lattice, tissue): (&Lattice<N>, &Tissue<N>),
    (work, coupling): (&mut thread::Work, &mut Coupling),
) {
    let Some(thread) = &params.thread else { return };
    let tail = params.tail.predicted(tissue);
    let laid = || thread::State::laid(thread, arc.swage(), tail, Vec3::y());
    let run = state.thread.get_or_insert_with(laid);
    let eyelet = match &state.needle.right {
        Passage::Passed(point) => {
            run.lead_through();
            Some(point)
        }
        _ => None,
    };
    let ends = Ends {
        swage: Some(arc.swage()).filter(|_| state.stage.stage < Stage::Tie),
        tail: Some(tail),
        eyelet: eyelet.map(|point| point.predicted(tissue)),
        end_stiffness: SURFACE_STIFFNESS,
    };
    let skin = Skin { lattice, tissue, lies: params.lies };
    let condensed = thread::condense(thread, run, &ends, &skin, work);
    coupling.kernels[TAIL] = params.tail.kernel;
    for (p, a) in [TAIL, RIGHT].into_iter().enumerate() {
        coupling.force[a] += condensed.force[p];
        for (q, b) in [TAIL, RIGHT].into_iter().enumerate() {
            coupling.stiffness[a][b] += condensed.stiffness[p][q];
        }
    }
}

/// Ends the thread's tick; its weight on the skin loads the nodes in the next one.
fn relax<const N: usize>(
    params: &Params,
    state: &mut State,
    moved: [Vec3; 2],
    (lattice, load): (&Lattice<N>, &mut Field<N>),
    work: &mut thread::Work,
) -> Pull {
    let (Some(thread), Some(run)) = (&params.thread, &mut state.thread) else {
        return Pull::default();
    };
    let pull = thread::settle(thread, run, work, moved);
    if params.lies {
        load.iter_mut().for_each(|c| c.iter_mut().take(lattice.len()).for_each(|f| *f = 0.0));
        for (node, reaction) in run.live().zip(&work.reaction) {
            tissue::lifted(lattice, node, *reaction, load);
        }
    }
    if state.stage.stage == Stage::Tie && state.stage.ticks == 0 {
        run.tie(thread);
    }
    pull
}

/// About what skin answers a point's displacement with [N/m]; it steers the thread's own iterations only.
const SURFACE_STIFFNESS: f32 = 300.0;

impl Params {
    fn new<const N: usize>(scene: &Scene, material: Material, lattice: &Lattice<N>, tissue: &Tissue<N>) -> Result<Self, ConfigError> {
        let scene::Solver::BePcg { iterations, newton } = scene.solver;
        let needle = needle::Params::new(scene);
        let thread = match scene.thread.as_ref().filter(|_| scene.effects.has(Effect::Thread)) {
            Some(thread) => Some(thread::build(thread, scene.contact.coupling_n_per_m, scene.effects)?),
            None => None,
        };
        let mut tail = Point::default();
        if let (Some(_), Some(stitch)) = (&thread, &scene.stitch) {
            let [x, y] = stitch.left_m;
            let above = Vec3::new(x, y, 0.0);
            let z = tissue::height(lattice, tissue, above).ok_or(ConfigError::NoSkinAtSite)?;
            let place = Vec3::new(x, y, z);
            tail = Point::new(tissue::kernel_at(lattice, tissue, place, needle.kernel), place, tissue);
        }
        Ok(Self {
            material,
            solver: BePcg { iterations, newton },
            needle,
            thread,
            tail,
            lies: scene.effects.has(Effect::ThreadContact),
            faces: tissue::faces(scene, lattice),
            meet: scene.effects.has(Effect::WoundContact),
            safety: safety::Params::new(&scene.output, scene.device.profile, scene.effects),
            patch_from_device: Pose::from(scene.device.patch_from_device),
        })
    }
}
