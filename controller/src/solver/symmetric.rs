//! A symmetric 3 × 3 block at every node: xx, xy, xz, yy, yz, zz.

use crate::lanes::Lanes;

/// Numbers of a symmetric block.
pub(super) const SYMMETRIC: usize = 6;

/// A symmetric block at every node.
pub(super) type Symmetric<const N: usize> = [[f32; N]; SYMMETRIC];

/// The blocks from index `at`.
#[inline(always)]
pub(super) fn load<L: Lanes, const N: usize>(lanes: L, blocks: &Symmetric<N>, at: usize) -> [L::F; SYMMETRIC] {
    let [xx, xy, xz, yy, yz, zz] = blocks;
    [
        lanes.load(xx, at),
        lanes.load(xy, at),
        lanes.load(xz, at),
        lanes.load(yy, at),
        lanes.load(yz, at),
        lanes.load(zz, at),
    ]
}

/// Stores blocks at index `at`.
#[inline(always)]
pub(super) fn store<L: Lanes, const N: usize>(lanes: L, from: [L::F; SYMMETRIC], blocks: &mut Symmetric<N>, at: usize) {
    for n in 0..SYMMETRIC {
        lanes.store(from[n], &mut blocks[n], at);
    }
}

/// g gᵀ + t I of a spring, from its axial part g and its transverse stiffness t.
#[inline(always)]
pub(super) fn of_spring<L: Lanes>([x, y, z]: [L::F; 3], across: L::F) -> [L::F; SYMMETRIC] {
    [x * x + across, x * y, x * z, y * y + across, y * z, z * z + across]
}

/// A spring's force and block, as a sweep passes them on.
#[inline(always)]
pub(super) fn with_force<L: Lanes>([fx, fy, fz]: [L::F; 3], [xx, xy, xz, yy, yz, zz]: [L::F; SYMMETRIC]) -> [L::F; 9] {
    [fx, fy, fz, xx, xy, xz, yy, yz, zz]
}

/// Force on nodes and their block, from the sums over the springs that begin and end there.
#[inline(always)]
pub(super) fn at_node<L: Lanes>(begin: [L::F; 9], end: [L::F; 9]) -> ([L::F; 3], [L::F; SYMMETRIC]) {
    (
        [begin[0] - end[0], begin[1] - end[1], begin[2] - end[2]],
        [
            begin[3] + end[3],
            begin[4] + end[4],
            begin[5] + end[5],
            begin[6] + end[6],
            begin[7] + end[7],
            begin[8] + end[8],
        ],
    )
}

/// Adds numbers one by one.
#[inline(always)]
pub(super) fn add<F: Copy + core::ops::Add<Output = F>, const K: usize>(sum: &mut [F; K], more: [F; K]) {
    for n in 0..K {
        sum[n] = sum[n] + more[n];
    }
}

/// A block with `more` on its diagonal.
#[inline(always)]
pub(super) fn plus<L: Lanes>([xx, xy, xz, yy, yz, zz]: [L::F; SYMMETRIC], more: L::F) -> [L::F; SYMMETRIC] {
    [xx + more, xy, xz, yy + more, yz, zz + more]
}

/// Block times vector.
#[inline(always)]
pub(super) fn times<L: Lanes>([xx, xy, xz, yy, yz, zz]: [L::F; SYMMETRIC], [x, y, z]: [L::F; 3]) -> [L::F; 3] {
    [
        xx * x + xy * y + xz * z,
        xy * x + yy * y + yz * z,
        xz * x + yz * y + zz * z,
    ]
}

/// Inverse of a positive definite block where `free` > 0, else zero.
///
/// By LDLᵀ: each pivot keeps its own digits, where a determinant would lose those of the softest direction; a pivot that is not positive
/// leaves its direction out, so the result is never indefinite.
#[inline(always)]
pub(super) fn invert<L: Lanes>(lanes: L, free: L::F, [xx, xy, xz, yy, yz, zz]: [L::F; SYMMETRIC]) -> [L::F; SYMMETRIC] {
    let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
    let first = lanes.where_positive(xx, one / xx);
    let (a, b) = (xy * first, xz * first);
    let pivot = yy - a * xy;
    let second = lanes.where_positive(pivot, one / pivot);
    let rest = yz - b * xy;
    let c = rest * second;
    let pivot = zz - b * xz - c * rest;
    let third = lanes.where_positive(pivot, one / pivot);
    let e = a * c - b;
    let (second_a, third_c, third_e) = (a * second, c * third, e * third);
    [
        lanes.where_positive(free, first + a * second_a + e * third_e),
        lanes.where_positive(free, zero - second_a - c * third_e),
        lanes.where_positive(free, third_e),
        lanes.where_positive(free, second + c * third_c),
        lanes.where_positive(free, zero - third_c),
        lanes.where_positive(free, third),
    ]
}
