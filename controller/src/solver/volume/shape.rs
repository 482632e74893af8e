//! Voxels as they are: their faces and growth, and the energy and force that follow.

use super::super::sweep::Given;
use super::super::voxel::{DIAGONALS, VoxelPass, along_diagonals, mean_edges, sweep_voxels};
use crate::lanes::Lanes;
use crate::lattice::{Field, Lattice};
use crate::law::BARRIER_BELOW;

/// Voxels as they are.
#[derive(Clone, Copy)]
pub(super) struct Shape<F> {
    /// C_i by axis.
    pub(super) faces: [[F; 3]; 3],
    /// p [Pa].
    pub(super) pressure: F,
    /// U″ [Pa].
    pub(super) stiffness: F,
}

/// C_i by axis of the voxels from index `at` at displacements `place`, and J − 1.
#[inline(always)]
fn faces<L: Lanes, const N: usize>(
    lanes: L,
    lattice: &Lattice<N>,
    place: &Field<N>,
    at: usize,
) -> ([[L::F; 3]; 3], L::F) {
    let mut moved = mean_edges(lanes, lattice, place, at);
    for edge in &mut moved {
        for c in 0..3 {
            edge[c] = edge[c] * lanes.splat(0.25 / lattice.pitch);
        }
    }
    let mut edges = moved;
    for i in 0..3 {
        edges[i][i] = moved[i][i] + lanes.splat(1.0);
    }
    let faces = [
        cross::<L>(edges[1], edges[2]),
        cross::<L>(edges[2], edges[0]),
        cross::<L>(edges[0], edges[1]),
    ];
    // J − 1 without the difference: that of E_x and its rest, and of the part of C_x along x and its rest.
    let [x, y, z] = moved;
    let growth = dot::<L>(x, faces[0]) + (y[1] + z[2] + (y[1] * z[2] - y[2] * z[1]));
    (faces, growth)
}

/// How far J is below J_b where it grew by `growth`.
#[inline(always)]
fn under<L: Lanes>(lanes: L, growth: L::F) -> L::F {
    lanes.splat(BARRIER_BELOW - 1.0) - growth
}

/// Shape of the voxels from index `at` at displacements `place`.
#[inline(always)]
pub(super) fn shape<L: Lanes, const N: usize>(
    lanes: L,
    lattice: &Lattice<N>,
    place: &Field<N>,
    at: usize,
) -> Shape<L::F> {
    let (faces, growth) = faces(lanes, lattice, place, at);
    let volume = lanes.load(&lattice.volume, at);
    let under = under(lanes, growth);
    let barrier = lanes.where_positive(under, lanes.load(&lattice.barrier, at));
    Shape {
        faces,
        pressure: volume * growth - barrier * under,
        stiffness: volume + barrier,
    }
}

/// The voxels' energy at displacements `place` [J].
#[inline(always)]
pub(in crate::solver) fn energy<L: Lanes, const N: usize>(
    lanes: L,
    lattice: &Lattice<N>,
    place: &Field<N>,
    given: &mut Given<N>,
) -> f32 {
    let mut pass = Energy {
        lattice,
        place,
        sum: lanes.nothing(),
    };
    sweep_voxels(lanes, lattice, given, &mut pass);
    lanes.total(pass.sum)
}

struct Energy<'a, L: Lanes, const N: usize> {
    lattice: &'a Lattice<N>,
    place: &'a Field<N>,
    sum: L::Sum,
}

impl<L: Lanes, const N: usize> VoxelPass<L, 0> for Energy<'_, L, N> {
    #[inline(always)]
    fn voxel(&mut self, lanes: L, at: usize) -> [[L::F; 0]; DIAGONALS] {
        let Lattice {
            volume, barrier, pitch, ..
        } = self.lattice;
        let (_, growth) = faces(lanes, self.lattice, self.place, at);
        let under = lanes.larger(under(lanes, growth), lanes.splat(0.0));
        let swollen = lanes.load(volume, at) * growth * growth;
        let over_volume = lanes.splat(0.5) * (swollen + lanes.load(barrier, at) * under * under);
        let voxel = lanes.splat(pitch * pitch * pitch);
        self.sum = lanes.add(self.sum, at, over_volume * voxel);
        [[]; DIAGONALS]
    }

    #[inline(always)]
    fn node(&mut self, _: L, _: usize, _: [L::F; 0], _: [L::F; 0]) {}
}

/// Adds the voxels' force at displacements `place` to `force` [N].
#[inline(always)]
pub(in crate::solver) fn add_force<L: Lanes, const N: usize>(
    lanes: L,
    lattice: &Lattice<N>,
    place: &Field<N>,
    (given, force): (&mut Given<N>, &mut Field<N>),
) {
    sweep_voxels(lanes, lattice, given, &mut Force { lattice, place, force });
}

struct Force<'a, const N: usize> {
    lattice: &'a Lattice<N>,
    place: &'a Field<N>,
    force: &'a mut Field<N>,
}

impl<L: Lanes, const N: usize> VoxelPass<L, 3> for Force<'_, N> {
    #[inline(always)]
    fn voxel(&mut self, lanes: L, at: usize) -> [[L::F; 3]; DIAGONALS] {
        let shape = shape(lanes, self.lattice, self.place, at);
        let pitch = self.lattice.pitch;
        let pull = shape.pressure * lanes.splat(0.25 * pitch * pitch);
        along_diagonals(lanes, scaled::<L>(shape.faces, pull))
    }

    #[inline(always)]
    fn node(&mut self, lanes: L, at: usize, begin: [L::F; 3], end: [L::F; 3]) {
        for c in 0..3 {
            let force = lanes.load(&self.force[c], at) + (begin[c] - end[c]);
            lanes.store(force, &mut self.force[c], at);
        }
    }
}

#[inline(always)]
pub(super) fn dot<L: Lanes>([ax, ay, az]: [L::F; 3], [bx, by, bz]: [L::F; 3]) -> L::F {
    ax * bx + ay * by + az * bz
}

#[inline(always)]
fn cross<L: Lanes>([ax, ay, az]: [L::F; 3], [bx, by, bz]: [L::F; 3]) -> [L::F; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

#[inline(always)]
pub(super) fn scaled<L: Lanes>([x, y, z]: [[L::F; 3]; 3], by: L::F) -> [[L::F; 3]; 3] {
    [times::<L>(x, by), times::<L>(y, by), times::<L>(z, by)]
}

#[inline(always)]
pub(super) fn times<L: Lanes>([x, y, z]: [L::F; 3], by: L::F) -> [L::F; 3] {
    [x * by, y * by, z * by]
}
