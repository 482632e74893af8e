//! The work of `sutura poke`: one node of a block is moved on a path, and its reaction and the time of every tick are recorded.
//!
//! Block: bottom layer held, no gravity, no dashpots, mass damping. The moved node is a held node with a velocity, so that every solver
//! takes it along within the tick; at a tick's end it is put on its place exactly. The reaction is the elastic force of its springs and voxels.
//!
//! With a reference: the same block and path in double precision ([`super::double`]), converged. Errors are relative to its root mean
//! square over all ticks: of the force, and over all nodes and ticks of the displacement.

mod choose;
mod converged;
pub mod drive;
mod errors;
mod files;
mod report;

pub use choose::{Unmet, choose};
pub(crate) use converged::{Converged, Equation};
pub(crate) use errors::Distance;
pub use errors::Errors;
pub use report::Report;

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use sutura_controller::lanes::Level;
use sutura_controller::math::TICK_HZ;
use sutura_shared::scene::Law;

use self::drive::Poke;
use super::block::{self, Block, Spec};
use super::budget::Interrupted;
use super::double::{Model, NoEquilibrium, V};
use super::method::{Method, NEAR, NotBuilt};
use super::path::Course;
use crate::run::report::TickTime;

/// Longest run [ticks].
pub const TICKS_MAX: u32 = 60_000;
/// Mass damping of the yardstick's work [1/s].
pub const DAMPING_PER_S: f64 = 50.0;

/// What to poke, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The block.
    pub block: Spec,
    /// Whether a node's mass is what its voxels give it; else ρa³ everywhere.
    pub mass_per_voxel: bool,
    /// The moved node; without one the middle of the top.
    pub node: Option<[u32; 3]>,
    /// Its way.
    pub course: Course,
    /// What the controller's passes run on.
    pub level: Level,
    /// How long [ticks].
    pub ticks: u32,
    /// The solver.
    pub method: Method,
    /// Whether to compare with the converged solution.
    pub reference: bool,
    /// File for the places of all nodes at the end.
    pub positions: Option<PathBuf>,
    /// File for the reaction at every tick.
    pub forces: Option<PathBuf>,
}

/// Pokes; `progress` is told ticks done and ticks in all where it takes long, `interrupted` ends the run without a trace.
///
/// # Errors
/// See [`Error`].
pub fn run(request: &Request, interrupted: &AtomicBool, mut progress: impl FnMut(u32, u32)) -> Result<Report, Error> {
    if let (true, Law::Volume { .. }) = (request.method.is_comparator(), request.block.law) {
        return Err(Error::Volume { method: request.method });
    }
    let (poke, model) = prepare(request)?;
    let (method, solver) = request.method.build(&poke.block, request.level)?;
    if request.method.explicit_substeps() != Some(0) {
        warn_near(method, &model);
    }
    let go_on = || match interrupted.load(Ordering::Relaxed) {
        true => Err(Error::Interrupted),
        false => Ok(()),
    };
    let mut record = Record::default();
    let end = poke.run(&*solver, request.ticks, |state, ns| {
        record.ns.push(ns);
        record
            .forces
            .push(model.reaction(poke.node, |node| state.displacement(node)));
        go_on()
    })?;
    let errors = match request.reference {
        true => {
            let mut converged = Converged::new(&poke, &model, Equation::of(method));
            let mut distance = Distance::default();
            poke.run(&*solver, request.ticks, |state, _| {
                converged.advance(state.tick)?;
                let force = model.reaction(poke.node, |node| state.displacement(node));
                distance.add_force(force, converged.reaction());
                distance.add_shape(state, converged.displacement());
                progress(state.tick, request.ticks);
                go_on()
            })?;
            Some(distance.errors())
        }
        false => None,
    };
    files::write(request, &poke, &end, &record.forces)?;
    let springs = poke.block.springs();
    let us_per_tick = TickTime::of(record.ns);
    Ok(Report {
        nodes: poke.block.lattice.nodes().count(),
        springs,
        solver: method.to_string(),
        finite: end.is_finite()
            && record
                .forces
                .iter()
                .all(|force| force.iter().all(|part| part.is_finite())),
        force_n: record.forces.last().map_or(0.0, |force| force.norm()),
        us_per_tick,
        ns_per_spring_substep: method
            .explicit_substeps()
            .map(|substeps| us_per_tick.median * 1e3 / f64::from(substeps) / springs as f64),
        errors,
        auto: None,
    })
}

/// What is written down of every tick.
#[derive(Default)]
struct Record {
    ns: Vec<u64>,
    forces: Vec<V>,
}

/// The block as it is poked, and its double.
pub(crate) fn prepare(request: &Request) -> Result<(Poke, Model), Error> {
    let Spec {
        nodes: [nx, ny, nz],
        pitch_m,
        density_kg_m3,
        ..
    } = request.block;
    let mut block = Block::new(&request.block)?;
    block.hold_bottom();
    if !request.mass_per_voxel {
        block.weigh((density_kg_m3 * pitch_m.powi(3)) as f32);
    }
    let [i, j, k] = request.node.unwrap_or([nx / 2, ny / 2, nz - 1]);
    if i >= nx || j >= ny || !(1..nz).contains(&k) {
        return Err(Error::Node {
            node: [i, j, k],
            nodes: [nx, ny, nz],
        });
    }
    let node = block.lattice.index([i, j, k]);
    if let Some(free) = block.lattice.free.get_mut(node) {
        *free = 0.0;
    }
    let model = Model::new(&block.lattice, &block.material);
    let (course, level) = (request.course, request.level);
    let poke = Poke {
        block,
        node,
        course,
        level,
    };
    Ok((poke, model))
}

/// Says where an explicit step is close to the largest stable one, 2/ω.
fn warn_near(method: Method, model: &Model) {
    if let Some(substeps) = method.explicit_substeps() {
        let part = model.fastest() / (2.0 * f64::from(TICK_HZ) * f64::from(substeps));
        if part > NEAR {
            tracing::warn!(
                "{method} is close to unstable: its step is {:.0} % of the largest stable one",
                100.0 * part
            );
        }
    }
}

/// Why there is no result; one line each.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The block.
    #[error(transparent)]
    Block(#[from] block::Error),
    /// The node is not there or held.
    #[error(
        "no node {},{},{} to move: the block has {}x{}x{} nodes, counted from 0, and those of layer 0 are held",
        node[0], node[1], node[2], nodes[0], nodes[1], nodes[2]
    )]
    Node {
        /// The node asked for.
        node: [u32; 3],
        /// Nodes along x, y, z.
        nodes: [u32; 3],
    },
    /// The solver.
    #[error(transparent)]
    Method(#[from] NotBuilt),
    /// A comparator and the law `volume`.
    #[error("{method} takes springs alone: law volume needs one of the controller's own solvers")]
    Volume {
        /// What was asked for.
        method: Method,
    },
    /// The reference.
    #[error(transparent)]
    Reference(#[from] NoEquilibrium),
    /// The files.
    #[error(transparent)]
    Files(#[from] crate::run::files::Error),
    /// No solver within the budget.
    #[error(transparent)]
    Unmet(Unmet),
    /// No solver holds the block.
    #[error("no solver keeps this block's state finite: softer or denser tissue is right")]
    NoSolver,
    /// Ctrl+C.
    #[error("interrupted")]
    Interrupted,
}

impl From<Interrupted> for Error {
    fn from(_: Interrupted) -> Self {
        Self::Interrupted
    }
}

impl Error {
    /// The exit code: 2 for the user's input or environment, 1 for a defect of ours, 130 for an interrupt.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Interrupted => 130,
            Self::Reference(_) => 1,
            _ => 2,
        }
    }
}
