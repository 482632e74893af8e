//! How the stiff spring system is advanced by one tick: one file per method, one trait.

mod assembly;
mod be_chebyshev;
mod be_pcg;
mod choice;
mod explicit;
mod guard;
mod operator;
mod points;
mod spectrum;
mod spring;
mod step;
mod sweep;
mod symmetric;
mod vbd;
mod volume;
mod voxel;

pub use assembly::elastic_force;
pub use be_chebyshev::BeChebyshev;
pub use be_pcg::BePcg;
pub use choice::{Choice, Refused};
pub use explicit::Explicit;
pub use spectrum::fewest_substeps;
pub use vbd::Vbd;

use crate::coupling::Coupling;
use crate::lanes::{Lanes, Level, blocks, run_on};
use crate::lattice::{DIRECTIONS, Field, Lattice, Tissue};
use crate::law::Material;
use crate::math::Vec3;
use crate::wound::{Faces, PAIRS_MAX};
use bytemuck::Zeroable;

use sweep::Given;
use symmetric::Symmetric;

/// What a solver is given: nothing here changes during a tick.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a, const N: usize> {
    /// Lattice.
    pub lattice: &'a Lattice<N>,
    /// What the springs follow.
    pub material: &'a Material,
    /// Needle and thread, condensed onto their points.
    pub coupling: &'a Coupling,
    /// The wound's faces, where they may not pass through each other.
    pub faces: Option<&'a Faces>,
    /// What the passes run on.
    pub level: Level,
}

/// A method that advances the tissue by one tick with a fixed count of operations.
pub trait Solver<const N: usize> {
    /// Advances `tissue` by one tick under `problem`, with `load` [N] at the nodes; gives the points' displacement from
    /// their predicted places ([`predict`]) [m].
    fn advance(
        &self,
        problem: &Problem<'_, N>,
        load: &Field<N>,
        tissue: &mut Tissue<N>,
        work: &mut Work<N>,
    ) -> [Vec3; crate::coupling::POINTS];
}

/// A solver's scratch memory; what it holds between ticks is of no meaning.
#[derive(Clone, Debug, PartialEq, Zeroable)]
#[repr(C, align(64))]
pub struct Work<const N: usize> {
    /// What springs give their nodes in a sweep.
    given: Given<N>,
    /// Displacement within the tick, u = x⁺ − x [m].
    step: Field<N>,
    /// Displacement from rest at the linearisation [m].
    place: Field<N>,
    /// Residual of the equation of motion, then of the linear system [N].
    residual: Field<N>,
    /// Solution of the linear system [m].
    solution: Field<N>,
    /// Search direction.
    search: Field<N>,
    /// Operator times search direction.
    product: Field<N>,
    /// Inverse of the operator's diagonal; zero at held nodes.
    inverse_diagonal: Field<N>,
    /// Inverse of the operator's 3 × 3 block at a node; zero at held nodes.
    inverse_block: Symmetric<N>,
    /// Spring direction times the root of its axial stiffness less its transverse one, by direction [√(N/m)].
    axial: [Field<N>; DIRECTIONS],
    /// Transverse stiffness T/l ≥ 0 by direction [N/m].
    transverse: [[f32; N]; DIRECTIONS],
    /// A voxel's faces C_i over a² times √(U″ a)/4, by axis i and the voxel's lowest corner [√(N/m)]; used where voxels keep their volume.
    growth: [Field<N>; 3],
    /// |p| a/32 of voxels [N/m]; used where voxels keep their volume.
    pressure: [f32; N],
    /// Stiffness of the wound's pairs that meet, zero for the others [N/m].
    contact: [f32; PAIRS_MAX],
}

impl<const N: usize> Work<N> {
    /// Forgets everything: passes read a guard beyond the last node, which another scene may have filled.
    pub fn clear(&mut self) {
        let Self {
            given,
            step,
            place,
            residual,
            solution,
            search,
            product,
            inverse_diagonal,
            inverse_block,
            axial,
            transverse,
            growth,
            pressure,
            contact,
        } = self;
        let fields = [step, place, residual, solution, search, product, inverse_diagonal];
        let fields = fields.into_iter().chain(axial).chain(growth);
        let arrays = fields
            .flatten()
            .chain(inverse_block)
            .chain(transverse)
            .chain([pressure]);
        arrays.for_each(|array| array.fill(0.0));
        contact.fill(0.0);
        given.clear();
    }
}

/// Whether the last tick left every node's velocity and displacement finite.
#[must_use]
pub fn is_finite<const N: usize>(level: Level, n: usize, tissue: &Tissue<N>) -> bool {
    run_on!(level, lanes => square_sum(lanes, n, tissue)).is_finite()
}

/// A sum of squares, finite only if every term is.
#[inline(always)]
fn square_sum<L: Lanes, const N: usize>(lanes: L, n: usize, tissue: &Tissue<N>) -> f32 {
    let mut sum = lanes.nothing();
    for values in tissue.velocity.iter().chain(&tissue.displacement) {
        for at in blocks::<L, N>(n) {
            let x = lanes.load(values, at);
            sum = lanes.add(sum, at, x * x);
        }
    }
    lanes.total(sum)
}

/// Predicted displacement of the points within the tick, W·(dt·v), the place at which a [`Coupling`] states its force.
#[must_use]
pub fn predict<const N: usize>(coupling: &Coupling, tissue: &Tissue<N>) -> [Vec3; crate::coupling::POINTS] {
    coupling.gather(&tissue.velocity).map(|v| v * crate::math::DT)
}
