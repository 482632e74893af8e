//! A block under a moved node, tick by tick.

use bytemuck::zeroed_box;
use sutura_controller::coupling::Coupling;
use sutura_controller::lanes::Level;
use sutura_controller::lattice::{Field, PC_NODES, Tissue, at};
use sutura_controller::math::TICK_HZ;
use sutura_controller::solver::{Problem, Solver, Work};

use crate::link::thread_time;
use crate::study::block::Block;
use crate::study::double::V;
use crate::study::path::Course;

/// A block of which one held node is moved.
#[derive(Clone, Debug)]
pub struct Poke {
    /// The block.
    pub block: Block,
    /// The moved node; held.
    pub node: usize,
    /// Its way.
    pub course: Course,
    /// What the controller's passes run on.
    pub level: Level,
}

/// The solver alone, one tick of it: what is timed. Never inlined, so that its instructions can be counted under this name.
#[inline(never)]
fn solve(
    solver: &dyn Solver<PC_NODES>,
    problem: &Problem<'_, PC_NODES>,
    load: &Field<PC_NODES>,
    tissue: &mut Tissue<PC_NODES>,
    work: &mut Work<PC_NODES>,
) {
    solver.advance(problem, load, tissue, work);
}

/// [`solve`]'s name for a program that counts instructions.
pub(crate) const SOLVE: &str = "*poke::drive::solve";

/// Where the tissue is at a tick's end.
#[derive(Clone, Debug)]
pub struct State {
    /// Ticks done.
    pub tick: u32,
    tissue: Box<Tissue<PC_NODES>>,
}

impl State {
    /// A node's displacement from rest [m].
    #[must_use]
    pub fn displacement(&self, node: usize) -> V {
        at(&self.tissue.displacement, node).map(f64::from)
    }

    /// Whether every displacement and velocity is a finite number.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let fields = [&self.tissue.displacement, &self.tissue.velocity];
        fields.into_iter().flatten().flatten().all(|value| value.is_finite())
    }
}

impl Poke {
    /// Place of the moved node at the end of a tick, as displacement from rest, as the controller holds it [m].
    #[must_use]
    pub fn place(&self, tick: u32) -> [f32; 3] {
        let t = f64::from(tick) / f64::from(TICK_HZ);
        self.course.place(t).map(|part| part as f32)
    }

    /// Advances the block from rest by some ticks; `after` sees each, with the CPU time that the solver alone took [ns].
    ///
    /// # Errors
    /// What `after` ends it with.
    pub fn run<E>(
        &self,
        solver: &dyn Solver<PC_NODES>,
        ticks: u32,
        mut after: impl FnMut(&State, u64) -> Result<(), E>,
    ) -> Result<State, E> {
        let mut state = State {
            tick: 0,
            tissue: zeroed_box(),
        };
        let load: Box<Field<PC_NODES>> = zeroed_box();
        let mut work: Box<Work<PC_NODES>> = zeroed_box();
        let coupling = Coupling::default();
        let problem = Problem {
            lattice: &self.block.lattice,
            material: &self.block.material,
            coupling: &coupling,
            faces: None,
            level: self.level,
        };
        for tick in 1..=ticks {
            self.set_velocity(tick, &mut state.tissue);
            let start = thread_time();
            solve(solver, &problem, &load, &mut state.tissue, &mut work);
            let took = thread_time().saturating_sub(start);
            for (part, place) in state.tissue.displacement.iter_mut().zip(self.place(tick)) {
                part[self.node] = place;
            }
            state.tick = tick;
            after(&state, took.as_nanos() as u64)?;
        }
        Ok(state)
    }

    /// The velocity that takes the moved node along its way during a tick; places that far apart hold it in single precision.
    fn set_velocity(&self, tick: u32, tissue: &mut Tissue<PC_NODES>) {
        let [from, to] = [tick - 1, tick].map(|tick| self.course.place(f64::from(tick) / f64::from(TICK_HZ)));
        let ways = from.into_iter().zip(to);
        for (part, (from, to)) in tissue.velocity.iter_mut().zip(ways) {
            part[self.node] = ((to - from) * f64::from(TICK_HZ)) as f32;
        }
    }
}
