//! What needle and thread hold, within a solver: the points' part of the operator D + WᵀSW and of its inverse.

use super::symmetric::Symmetric;
use crate::coupling::{Coupling, POINTS, product};
use crate::lattice::{Field, add, at};
use crate::math::{Mat3, Vec3};

/// Most unknowns of the coupling points.
const UNKNOWNS: usize = 3 * POINTS;

/// D⁻¹, node by node; zero at held nodes.
pub(super) trait Inverse {
    /// D⁻¹ v at a node.
    fn times(&self, node: usize, v: Vec3) -> Vec3;
    /// D⁻¹ at a node.
    fn block(&self, node: usize) -> Mat3;
    /// Adds a stiffness along x to D at a node [N/m].
    fn stiffen(&mut self, node: usize, stiffness: f32);
}

/// The diagonal itself.
impl<const N: usize> Inverse for Field<N> {
    #[inline]
    fn times(&self, node: usize, v: Vec3) -> Vec3 {
        at(self, node).component_mul(&v)
    }

    fn block(&self, node: usize) -> Mat3 {
        Mat3::from_diagonal(&at(self, node))
    }

    fn stiffen(&mut self, node: usize, stiffness: f32) {
        let [x, ..] = self;
        if let Some(inverse) = x.get_mut(node) {
            *inverse /= 1.0 + stiffness * *inverse;
        }
    }
}

/// The 3 × 3 blocks on the diagonal.
impl<const N: usize> Inverse for Symmetric<N> {
    #[inline]
    fn times(&self, node: usize, v: Vec3) -> Vec3 {
        self.block(node) * v
    }

    #[inline]
    fn block(&self, node: usize) -> Mat3 {
        let [xx, xy, xz, yy, yz, zz] = self.each_ref().map(|part| part.get(node).copied().unwrap_or(0.0));
        Mat3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// Sherman and Morrison's formula.
    fn stiffen(&mut self, node: usize, stiffness: f32) {
        let [xx, xy, xz, ..] = self.each_ref().map(|part| part.get(node).copied().unwrap_or(0.0));
        let scale = stiffness / (1.0 + stiffness * xx);
        let less = [xx * xx, xx * xy, xx * xz, xy * xy, xy * xz, xz * xz];
        for (part, less) in self.iter_mut().zip(less) {
            if let Some(x) = part.get_mut(node) {
                *x -= scale * less;
            }
        }
    }
}

/// The points' part of the operator and of its preconditioner.
///
/// M = D + WᵀSW with D the operator's diagonal. By Woodbury M⁻¹ = D⁻¹ − D⁻¹Wᵀ T W D⁻¹ with T = (I + S G)⁻¹ S and
/// G = W D⁻¹ Wᵀ: S may be singular (a slack thread) and as stiff as a link.
pub(super) struct Points<'a> {
    /// What holds the tissue.
    pub(super) coupling: &'a Coupling,
    /// Points that there are.
    len: usize,
    /// (I + S G)⁻¹.
    inverse: [[Mat3; POINTS]; POINTS],
    /// T = (I + S G)⁻¹ S.
    schur: [[Mat3; POINTS]; POINTS],
}

impl<'a> Points<'a> {
    /// Factors the points' part, one elimination over the points that there are; `None` where nothing holds the tissue.
    pub(super) fn new(coupling: &'a Coupling, inverse: &impl Inverse) -> Option<Self> {
        if coupling.is_idle() {
            return None;
        }
        let len = coupling.points().min(POINTS);
        let mut compliance = [[Mat3::zeros(); POINTS]; POINTS];
        for p in 0..len {
            for q in 0..=p {
                let shared = overlap(coupling, [p, q], inverse);
                compliance[p][q] = shared;
                compliance[q][p] = shared.transpose();
            }
        }
        // I + S G, and beside it I and S, which the elimination turns into the two inverses.
        let mut system = Dense::default();
        for p in 0..len {
            for q in 0..len {
                let both = coupling.stiffness[p].iter().zip(&compliance).take(len);
                let sum: Mat3 = both.map(|(s, row)| s * row[q]).sum();
                let unit = if p == q { Mat3::identity() } else { Mat3::zeros() };
                let stiffness = coupling.stiffness[p][q];
                for (side, block) in [sum + unit, unit, stiffness].into_iter().enumerate() {
                    system.put([p, side * len + q], &block);
                }
            }
        }
        system.reduce(3 * len);
        let blocks = |side: usize| {
            core::array::from_fn(|p| {
                core::array::from_fn(|q| {
                    let there = p < len && q < len;
                    if there {
                        system.block([p, side * len + q])
                    } else {
                        Mat3::zeros()
                    }
                })
            })
        };
        Some(Self {
            coupling,
            len,
            inverse: blocks(1),
            schur: blocks(2),
        })
    }
}

/// A small matrix with as many columns of right sides behind it as it has itself, twice.
struct Dense([[f32; 3 * UNKNOWNS]; UNKNOWNS]);

impl Default for Dense {
    fn default() -> Self {
        Self([[0.0; 3 * UNKNOWNS]; UNKNOWNS])
    }
}

impl Dense {
    /// Writes a block, counted in blocks.
    fn put(&mut self, [p, q]: [usize; 2], block: &Mat3) {
        for (row, values) in self.0.iter_mut().skip(3 * p).zip(block.row_iter()) {
            for (cell, value) in row.iter_mut().skip(3 * q).zip(values.iter()) {
                *cell = *value;
            }
        }
    }

    fn block(&self, [p, q]: [usize; 2]) -> Mat3 {
        let rows = self.0.iter().skip(3 * p).take(3);
        Mat3::from_row_iterator(rows.flat_map(|row| row.iter().skip(3 * q).take(3).copied()))
    }

    /// Gauss and Jordan's elimination of the first `n` columns with partial pivoting: what stands behind them becomes their inverse times it.
    fn reduce(&mut self, n: usize) {
        let width = (3 * n).min(3 * UNKNOWNS);
        for k in 0..n.min(UNKNOWNS) {
            let mut best = k;
            for i in k + 1..n.min(UNKNOWNS) {
                if self.0[i][k].abs() > self.0[best][k].abs() {
                    best = i;
                }
            }
            self.0.swap(k, best);
            // I + S G has no eigenvalue below one.
            let scale = 1.0 / self.0[k][k];
            let pivot = self.0[k].map(|x| x * scale);
            self.0[k] = pivot;
            for (i, row) in self.0.iter_mut().enumerate().take(n) {
                let factor = if i == k { 0.0 } else { row[k] };
                for (cell, x) in row.iter_mut().zip(&pivot).take(width).skip(k) {
                    *cell -= factor * x;
                }
            }
        }
    }
}

impl Points<'_> {
    /// The force on the points once they have moved by `free` from their predicted places and, under that force, by G of it more:
    /// λ = f − S (u + G λ).
    pub(super) fn force(&self, free: &[Vec3; POINTS]) -> [Vec3; POINTS] {
        let mut force = self.coupling.force;
        let held = self.coupling.product(free);
        force.iter_mut().zip(&held).for_each(|(f, s)| *f -= s);
        product(&self.inverse, self.len, &force)
    }

    /// What the points take of D⁻¹ r to make M⁻¹ r = D⁻¹ r − D⁻¹ Wᵀ b: b, and rᵀ D⁻¹ Wᵀ b.
    pub(super) fn take<const N: usize>(&self, residual: &Field<N>, inverse: &impl Inverse) -> ([Vec3; POINTS], f32) {
        let scaled = self.coupling.kernels.each_ref().map(|kernel| {
            let of = |(node, w)| inverse.times(node, at(residual, node)) * w;
            kernel.iter().map(of).sum::<Vec3>()
        });
        let back = product(&self.schur, self.len, &scaled);
        let taken = inner(&scaled, &back);
        (back, taken)
    }

    /// Takes D⁻¹ Wᵀ b from `scaled`.
    pub(super) fn give<const N: usize>(&self, back: &[Vec3; POINTS], inverse: &impl Inverse, scaled: &mut Field<N>) {
        for (kernel, back) in self.coupling.kernels.iter().zip(back) {
            for (node, w) in kernel.iter() {
                add(scaled, node, -inverse.times(node, *back) * w);
            }
        }
    }
}

/// W_p D⁻¹ W_qᵀ: both kernels are in ascending order.
fn overlap(coupling: &Coupling, [p, q]: [usize; 2], inverse: &impl Inverse) -> Mat3 {
    let (a, b) = (&coupling.kernels[p], &coupling.kernels[q]);
    let mut sum = Mat3::zeros();
    let mut others = b.iter().peekable();
    for (node, w) in a.iter() {
        while others.next_if(|(other, _)| *other < node).is_some() {}
        if let Some((_, v)) = others.next_if(|(other, _)| *other == node) {
            sum += inverse.block(node) * (w * v);
        }
    }
    sum
}

/// Inner product of vectors at the points.
pub(super) fn inner(a: &[Vec3; POINTS], b: &[Vec3; POINTS]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}
