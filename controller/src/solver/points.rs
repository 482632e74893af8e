//! What needle and thread hold, within a solver: the points' part of the operator D + WᵀSW and of its inverse.

use super::symmetric::Symmetric;
use crate::coupling::{Coupling, POINTS, product};
use crate::lattice::{Field, add, at};
use crate::math::{Mat3, Vec3};
use nalgebra::SMatrix;

/// Unknowns of the coupling points.
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
    /// (I + S G)⁻¹.
    inverse: [[Mat3; POINTS]; POINTS],
    /// T = (I + S G)⁻¹ S.
    schur: [[Mat3; POINTS]; POINTS],
}

impl<'a> Points<'a> {
    /// Factors the points' part, one elimination of three unknowns a point; `None` where nothing holds the tissue.
    pub(super) fn new(coupling: &'a Coupling, inverse: &impl Inverse) -> Option<Self> {
        if coupling.is_idle() {
            return None;
        }
        let mut stiffness = SMatrix::<f32, UNKNOWNS, UNKNOWNS>::zeros();
        let mut compliance = stiffness;
        for p in 0..POINTS {
            for q in 0..POINTS {
                stiffness
                    .fixed_view_mut::<3, 3>(3 * p, 3 * q)
                    .copy_from(&coupling.stiffness[p][q]);
                let shared = overlap(coupling, [p, q], inverse);
                compliance.fixed_view_mut::<3, 3>(3 * p, 3 * q).copy_from(&shared);
            }
        }
        let system = SMatrix::<f32, UNKNOWNS, UNKNOWNS>::identity() + stiffness * compliance;
        let inverse = system.lu().try_inverse().unwrap_or_else(SMatrix::zeros);
        Some(Self {
            coupling,
            inverse: blocks(&inverse),
            schur: blocks(&(inverse * stiffness)),
        })
    }
}

/// A matrix over the points by point and point.
fn blocks(matrix: &SMatrix<f32, UNKNOWNS, UNKNOWNS>) -> [[Mat3; POINTS]; POINTS] {
    core::array::from_fn(|p| core::array::from_fn(|q| matrix.fixed_view::<3, 3>(3 * p, 3 * q).into_owned()))
}

impl Points<'_> {
    /// The force on the points once they have moved by `free` from their predicted places and, under that force, by G of it more:
    /// λ = f − S (u + G λ).
    pub(super) fn force(&self, free: &[Vec3; POINTS]) -> [Vec3; POINTS] {
        let mut force = self.coupling.force;
        let held = self.coupling.product(free);
        force.iter_mut().zip(&held).for_each(|(f, s)| *f -= s);
        product(&self.inverse, &force)
    }

    /// What the points take of D⁻¹ r to make M⁻¹ r = D⁻¹ r − D⁻¹ Wᵀ b: b, and rᵀ D⁻¹ Wᵀ b.
    pub(super) fn take<const N: usize>(&self, residual: &Field<N>, inverse: &impl Inverse) -> ([Vec3; POINTS], f32) {
        let scaled = self.coupling.kernels.each_ref().map(|kernel| {
            let of = |(node, w)| inverse.times(node, at(residual, node)) * w;
            kernel.iter().map(of).sum::<Vec3>()
        });
        let back = product(&self.schur, &scaled);
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
