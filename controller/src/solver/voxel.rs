//! The pass over voxels: all of them once, then all nodes with what the voxels' body diagonals give them.
//!
//! A voxel counts by its lowest corner. Its eight corners are the ends of its four body diagonals, so what it gives them is kept by diagonal,
//! two layers at a time as in [`super::sweep`] and in the same arrays, and gathered at both ends.

use super::sweep::Given;
use crate::lanes::{Lanes, within};
use crate::lattice::{DIRECTIONS, EDGES, Field, Lattice};

/// Body diagonals of a voxel, in the order of [`crate::lattice::STEPS`].
pub(super) const DIAGONALS: usize = DIRECTIONS - EDGES;

/// What a sweep does at voxels and nodes; `K` numbers a diagonal.
pub(super) trait VoxelPass<L: Lanes, const K: usize> {
    /// What the diagonals of the voxels from index `at` give.
    fn voxel(&mut self, lanes: L, at: usize) -> [[L::F; K]; DIAGONALS];
    /// Takes, at the nodes `at…`, the sum over the diagonals that begin there and that over those that end there.
    fn node(&mut self, lanes: L, at: usize, begin: [L::F; K], end: [L::F; K]);
}

/// Sweeps `pass` over the lattice's voxels.
#[inline(always)]
pub(super) fn sweep_voxels<L: Lanes, P: VoxelPass<L, K>, const K: usize, const N: usize>(
    lanes: L,
    lattice: &Lattice<N>,
    given: &mut Given<N>,
    pass: &mut P,
) {
    let [nx, _, nz] = lattice.nodes.map(|n| n as usize);
    let (layer, reach) = (lattice.layer(), lattice.reach());
    let halves = [reach, layer + 3 * reach];
    empty::<K, N>(given, halves[1]..halves[1] + layer);
    for k in 0..nz {
        let (here, below) = if k % 2 == 0 {
            (halves[0], halves[1])
        } else {
            (halves[1], halves[0])
        };
        if k + 1 == nz {
            empty::<K, N>(given, here..here + layer);
        } else {
            for i in (0..layer).step_by(L::WIDTH) {
                let give = pass.voxel(lanes, within::<L, N>(k * layer + i));
                let keep = within::<L, N>(here + i);
                for m in 0..DIAGONALS {
                    for n in 0..K {
                        lanes.store(give[m][n], &mut given.by[EDGES + m][n], keep);
                    }
                }
            }
        }
        for i in (0..layer).step_by(L::WIDTH) {
            let behind = [0, 1, nx, nx + 1];
            let up = behind.map(|back| within::<L, N>(here + i - back));
            let down = behind.map(|back| within::<L, N>(below + i - back));
            let (mut begin, mut end) = ([lanes.splat(0.0); K], [lanes.splat(0.0); K]);
            for n in 0..K {
                let [_, _, _, a, b, c, d] = &given.by;
                begin[n] = lanes.load(&a[n], up[0])
                    + lanes.load(&b[n], up[1])
                    + lanes.load(&c[n], up[2])
                    + lanes.load(&d[n], up[3]);
                end[n] = lanes.load(&a[n], down[3])
                    + lanes.load(&b[n], down[2])
                    + lanes.load(&c[n], down[1])
                    + lanes.load(&d[n], down[0]);
            }
            pass.node(lanes, within::<L, N>(k * layer + i), begin, end);
        }
    }
}

/// No voxel gives anything there.
fn empty<const K: usize, const N: usize>(given: &mut Given<N>, range: core::ops::Range<usize>) {
    let diagonals = given.by.iter_mut().skip(EDGES);
    for numbers in diagonals.flat_map(|by| by.iter_mut().take(K)) {
        if let Some(part) = numbers.get_mut(range.clone()) {
            part.fill(0.0);
        }
    }
}

/// Four times the way of the mean edges of the voxels from index `at` whose corners have moved as `field` says, by axis.
#[inline(always)]
pub(super) fn mean_edges<L: Lanes, const N: usize>(
    lanes: L,
    lattice: &Lattice<N>,
    field: &Field<N>,
    at: usize,
) -> [[L::F; 3]; 3] {
    let (row, layer) = (lattice.nodes[0] as usize, lattice.layer());
    let low = [at, at + 1, at + row, at + row + 1].map(within::<L, N>);
    let high = [at + layer + row + 1, at + layer + row, at + layer + 1, at + layer].map(within::<L, N>);
    let mut edges = [[lanes.splat(0.0); 3]; 3];
    for c in 0..3 {
        let part = &field[c];
        let m = lanes.load(part, high[0]) - lanes.load(part, low[0]);
        let n = lanes.load(part, high[1]) - lanes.load(part, low[1]);
        let o = lanes.load(part, high[2]) - lanes.load(part, low[2]);
        let p = lanes.load(part, high[3]) - lanes.load(part, low[3]);
        edges[0][c] = (m + o) - (n + p);
        edges[1][c] = (m - o) + (n - p);
        edges[2][c] = (m + o) + (n + p);
    }
    edges
}

/// What each diagonal makes of a vector by axis: their sum, each with the sign of the diagonal's step along the axis.
#[inline(always)]
pub(super) fn along_diagonals<L: Lanes>(lanes: L, [x, y, z]: [[L::F; 3]; 3]) -> [[L::F; 3]; DIAGONALS] {
    let mut sums = [[lanes.splat(0.0); 3]; DIAGONALS];
    for c in 0..3 {
        let (both, differ) = (x[c] + y[c], x[c] - y[c]);
        sums[0][c] = z[c] + both;
        sums[1][c] = z[c] - differ;
        sums[2][c] = z[c] + differ;
        sums[3][c] = z[c] - both;
    }
    sums
}
