//! The pass that every method is made of: all springs once, then all nodes with what their springs give them.
//!
//! Layer by layer, what the springs of each direction give their lower nodes is kept (two layers at a time, so it stays in the cache), and
//! then gathered at both ends: plain loads and stores at fixed distances, no index list and nothing added in memory.

use crate::lanes::{Lanes, within};
use crate::lattice::{DIRECTIONS, EDGES, Lattice};
use bytemuck::Zeroable;

/// Most numbers a spring gives its nodes: a force and a symmetric 3 × 3 block.
const GIVEN: usize = 9;

/// What springs give, two layers at a time: the layer, with [`Lattice::reach`] zeros on both sides, twice.
#[derive(Clone, Debug, PartialEq, Zeroable)]
#[repr(C)]
pub(super) struct Given<const N: usize> {
    /// By direction and number.
    pub(super) by: [[[f32; N]; GIVEN]; DIRECTIONS],
    /// Sums over the springs that begin at a node, by number; one layer.
    lower: [[f32; N]; GIVEN],
}

impl<const N: usize> Given<N> {
    /// Forgets everything, as a lattice of another shape must.
    pub(super) fn clear(&mut self) {
        let Self { by, lower } = self;
        by.iter_mut().flatten().chain(lower).for_each(|array| array.fill(0.0));
    }
}

/// What a sweep does at springs and nodes; `K` numbers a spring.
pub(super) trait Pass<L: Lanes, const K: usize> {
    /// What all springs that begin at some nodes need of them.
    type Near: Copy;
    /// Reads it at the nodes from index `at`.
    fn near(&self, lanes: L, at: usize) -> Self::Near;
    /// What the springs of direction `D` from nodes `at…` to nodes `far…` give.
    fn spring<const D: usize>(&mut self, lanes: L, near: Self::Near, at: usize, far: usize) -> [L::F; K];
    /// Takes, at the nodes `at…`, the sum over the springs that begin there and that over those that end there.
    fn node(&mut self, lanes: L, at: usize, begin: [L::F; K], end: [L::F; K]);
}

/// Sweeps `pass` over the lattice.
#[inline(always)]
pub(super) fn sweep<L: Lanes, P: Pass<L, K>, const K: usize, const N: usize>(
    lanes: L,
    lattice: &Lattice<N>,
    given: &mut Given<N>,
    pass: &mut P,
) {
    let [nx, _, nz] = lattice.nodes.map(|n| n as usize);
    let (layer, reach) = (lattice.layer(), lattice.reach());
    let offsets = lattice.offsets();
    let halves = [reach, layer + 3 * reach];
    // No spring ends at the lowest layer from below.
    for by in given.by.iter_mut().skip(EDGES - 1) {
        for numbers in by.iter_mut().take(K) {
            let from = halves[1];
            if let Some(below) = numbers.get_mut(from - reach..from + layer + reach) {
                below.fill(0.0);
            }
        }
    }
    for k in 0..nz {
        let (here, below) = if k % 2 == 0 {
            (halves[0], halves[1])
        } else {
            (halves[1], halves[0])
        };
        for i in (0..layer).step_by(L::WIDTH) {
            springs(lanes, (given, offsets), pass, [k * layer + i, here + i, i], k + 1 == nz);
        }
        for i in (0..layer).step_by(L::WIDTH) {
            let Given { by, lower } = &*given;
            let at = within::<L, N>(k * layer + i);
            let own = within::<L, N>(i);
            let [px, py, pz, pa, pb, pc, pd] = [
                here + i - 1,
                here + i - nx,
                below + i,
                below + i - nx - 1,
                below + i + 1 - nx,
                below + i + nx - 1,
                below + i + nx + 1,
            ]
            .map(within::<L, N>);
            let (mut begin, mut end) = ([lanes.splat(0.0); K], [lanes.splat(0.0); K]);
            for n in 0..K {
                let [x, y, z, a, b, c, d] = by;
                begin[n] = lanes.load(&lower[n], own);
                end[n] = lanes.load(&x[n], px)
                    + lanes.load(&y[n], py)
                    + lanes.load(&z[n], pz)
                    + lanes.load(&a[n], pa)
                    + lanes.load(&b[n], pb)
                    + lanes.load(&c[n], pc)
                    + lanes.load(&d[n], pd);
            }
            pass.node(lanes, at, begin, end);
        }
    }
}

/// All springs that begin at the nodes from index `at`.
#[inline(always)]
fn springs<L: Lanes, P: Pass<L, K>, const K: usize, const N: usize>(
    lanes: L,
    (given, offsets): (&mut Given<N>, [usize; DIRECTIONS]),
    pass: &mut P,
    [at, keep, i]: [usize; 3],
    top: bool,
) {
    let [at, keep, i] = [at, keep, i].map(within::<L, N>);
    let near = pass.near(lanes, at);
    let mut sum = [lanes.splat(0.0); K];
    macro_rules! give {
        ($($direction:literal)*) => {
            $(
                let one = pass.spring::<$direction>(lanes, near, at, within::<L, N>(at + offsets[$direction]));
                for n in 0..K {
                    lanes.store(one[n], &mut given.by[$direction][n], keep);
                    sum[n] = sum[n] + one[n];
                }
            )*
        };
    }
    give!(0 1);
    // Nothing begins at the highest layer but what lies in it.
    if !top {
        give!(2 3 4 5 6);
    }
    for n in 0..K {
        lanes.store(sum[n], &mut given.lower[n], i);
    }
}
