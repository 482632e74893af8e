//! The patch: a regular lattice of mass points in structures of arrays.
//!
//! Node (i, j, k) has index k·layer + j·nx + i, where a layer of nx·ny nodes is filled up to whole vectors ([`Lattice::layer`]) with
//! nodes that do not exist. A spring belongs to its lower node and to one of seven directions: its other node is a fixed
//! [`Lattice::offsets`] further, so each direction is one contiguous pass and needs no index list. Where there is no spring, its
//! stiffness is zero.
//!
//! All arrays have capacity `N` and are zero at first: memory that is all zeros is a valid empty lattice, so it is made in place
//! (zeroed pages on a PC, `.bss` on a microcontroller) and never on the stack.

use crate::lanes::SUM_LANES;
use crate::math::{Vec3, sqrt};
use bytemuck::Zeroable;

/// Spring directions: three edges, then four body diagonals.
pub const DIRECTIONS: usize = 7;
/// Steps of each direction along x, y, z.
pub const STEPS: [[i32; 3]; DIRECTIONS] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 1, 1],
    [-1, 1, 1],
    [1, -1, 1],
    [-1, -1, 1],
];
/// Edges come first among the directions.
pub const EDGES: usize = 3;
/// Stress–strain curves that may meet in one spring.
pub const CURVES: usize = 3;

/// Array length of the PC's patch: holds a box of 24 × 24 × 12 = 6,912 nodes, and any box of as many in layers of at least 144.
///
/// An odd number of vectors, so that the many arrays of a pass begin in different sets of the cache.
pub const PC_NODES: usize = 743 * SUM_LANES;
const _: () = assert!(Lattice::<0>::guard([24, 24, 12]) as usize <= PC_NODES);

/// A vector at every node: x, y and z apart, shape `[3][N]`.
pub type Field<const N: usize> = [[f32; N]; 3];

/// What does not change while the scene runs.
#[derive(Clone, Debug, PartialEq, Zeroable)]
#[repr(C, align(64))]
pub struct Lattice<const N: usize> {
    /// ρa³/8 from each voxel around the node [kg]; zero where there is no node.
    pub mass: [f32; N],
    /// 1 where the node moves, 0 where it is held or absent.
    pub free: [f32; N],
    /// First-slope stiffness by curve, direction and lower node [N/m].
    pub stiffness: [[[f32; N]; DIRECTIONS]; CURVES],
    /// Λ of the volume energy ½ Λ (J − 1)² a³ by the voxel's lowest corner [Pa]; zero where there is no voxel, or no such energy.
    /// J is the determinant of the voxel's mean edges: of its four edges along x, its four along y and its four along z, over a.
    pub volume: [f32; N],
    /// B of its barrier ½ B max(0, J_b − J)² a³ against inverted voxels, likewise [Pa].
    pub barrier: [f32; N],
    /// By column i + nx·j: 1 + index of its highest node, 0 for an empty column.
    pub top: [u32; N],
    /// Nodes along x, y, z.
    pub nodes: [u32; 3],
    /// Voxel edge a [m].
    pub pitch: f32,
    /// Node (0, 0, 0) at rest, patch frame [m].
    pub origin: [f32; 3],
}

/// What changes: the tissue's state.
#[derive(Clone, Debug, PartialEq, Zeroable)]
#[repr(C, align(64))]
pub struct Tissue<const N: usize> {
    /// Displacement from rest [m]; small numbers keep the digits that positions would lose.
    pub displacement: Field<N>,
    /// Velocity [m/s].
    pub velocity: Field<N>,
    /// What the last tick leaves for the next one's balance of energy.
    pub balance: Balance,
}

/// What a tick leaves for the next one's balance of energy; all zeros is valid in any state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Zeroable)]
#[repr(C)]
pub struct Balance {
    /// Elastic energy of springs and voxels [J].
    pub elastic: f32,
    /// 1 where `elastic` is that of the present displacement, 0 where it has to be found.
    pub known: u32,
    /// How much shorter than solved for the next step is, since one before it gained energy: 1/(1 + this) of it.
    pub caution: f32,
}

impl<const N: usize> Lattice<N> {
    /// Indices of the whole box, existing nodes or not.
    #[must_use]
    pub fn len(&self) -> usize {
        let [_, _, nz] = self.nodes;
        (nz as usize * self.layer()).min(N)
    }

    /// Indices from one layer of nodes to the next: nx·ny in whole vectors.
    #[must_use]
    pub const fn layer(&self) -> usize {
        let [nx, ny, _] = self.nodes;
        ((nx * ny) as usize).next_multiple_of(SUM_LANES)
    }

    /// How far in a layer a spring reaches, nx + 1, in whole vectors.
    #[must_use]
    pub const fn reach(&self) -> usize {
        let [nx, _, _] = self.nodes;
        (nx as usize + 1).next_multiple_of(SUM_LANES)
    }

    /// Whether no scene is loaded.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Array length that a lattice of these nodes needs: springs of the highest layer reach past the last node, and passes keep two
    /// layers with their reach on both sides.
    #[must_use]
    pub const fn guard([nx, ny, nz]: [u32; 3]) -> u32 {
        let lanes = SUM_LANES as u32;
        let (layer, reach) = ((nx * ny).next_multiple_of(lanes), (nx + 1).next_multiple_of(lanes));
        let (springs, pulls) = (layer * (nz + 1) + reach, 2 * (layer + 2 * reach));
        if springs > pulls { springs } else { pulls }
    }

    /// Index distance from the lower node of a spring to the other, by direction.
    #[must_use]
    pub fn offsets(&self) -> [usize; DIRECTIONS] {
        let [nx, _, _] = self.nodes;
        let (row, layer) = (nx as i32, self.layer() as i32);
        STEPS.map(|[x, y, z]| (x + y * row + z * layer).unsigned_abs() as usize)
    }

    /// Rest vectors by direction [m].
    #[must_use]
    pub fn rest(&self) -> [[f32; 3]; DIRECTIONS] {
        STEPS.map(|step| step.map(|s| s as f32 * self.pitch))
    }

    /// Rest lengths by direction [m].
    #[must_use]
    pub fn rest_lengths(&self) -> [f32; DIRECTIONS] {
        STEPS.map(|[x, y, z]| sqrt((x * x + y * y + z * z) as f32) * self.pitch)
    }

    /// Index of node (i, j, k).
    #[must_use]
    pub const fn index(&self, [i, j, k]: [u32; 3]) -> usize {
        let [nx, _, _] = self.nodes;
        k as usize * self.layer() + (j * nx + i) as usize
    }

    /// Every node of the box, existing or not, with its index.
    pub fn nodes(&self) -> impl Iterator<Item = ([u32; 3], usize)> + use<N> {
        let [nx, ny, nz] = self.nodes;
        let layer = self.layer();
        let rows = (0..nz).flat_map(move |k| (0..ny).map(move |j| (j, k)));
        rows.flat_map(move |(j, k)| {
            let first = k as usize * layer + (j * nx) as usize;
            (0..nx).map(move |i| ([i, j, k], first + i as usize))
        })
    }

    /// Column of a node along x.
    #[must_use]
    pub fn column(&self, index: usize) -> u32 {
        let [nx, ..] = self.nodes;
        (index % self.layer().max(1)) as u32 % nx.max(1)
    }

    /// Place of a node at rest, patch frame [m].
    #[must_use]
    pub fn rest_place(&self, index: usize) -> Vec3 {
        let (nx, layer) = ((self.nodes[0] as usize).max(1), self.layer().max(1));
        let at = [index % layer % nx, index % layer / nx, index / layer];
        let [x, y, z] = self.origin;
        let [i, j, k] = at.map(|n| n as f32 * self.pitch);
        Vec3::new(x + i, y + j, z + k)
    }

    /// Place of a node now, patch frame [m].
    #[must_use]
    pub fn place(&self, tissue: &Tissue<N>, index: usize) -> Vec3 {
        self.rest_place(index) + at(&tissue.displacement, index)
    }

    /// Index of the highest node of column (i, j), if there is one.
    #[must_use]
    pub fn top(&self, i: u32, j: u32) -> Option<usize> {
        let [nx, ny, _] = self.nodes;
        if i >= nx || j >= ny {
            return None;
        }
        let stored = *self.top.get((j * nx + i) as usize)?;
        (stored as usize).checked_sub(1)
    }
}

/// The vector of a field at one node; zero beyond its end.
#[inline]
#[must_use]
pub fn at<const N: usize>(field: &Field<N>, index: usize) -> Vec3 {
    let [x, y, z] = field;
    let get = |c: &[f32; N]| c.get(index).copied().unwrap_or(0.0);
    Vec3::new(get(x), get(y), get(z))
}

/// Adds a vector to a field at one node; nothing beyond its end.
#[inline]
pub fn add<const N: usize>(field: &mut Field<N>, index: usize, v: Vec3) {
    for (component, add) in field.iter_mut().zip(v.iter()) {
        if let Some(x) = component.get_mut(index) {
            *x += add;
        }
    }
}
