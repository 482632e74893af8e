//! What needle and thread hold, within a solver: the points' part of the operator D + WᵀSW and of its inverse.

use crate::coupling::{Coupling, POINTS, product};
use crate::lattice::{Field, add, at};
use crate::math::{Mat3, Vec3};
use nalgebra::{SMatrix, SVector};

/// Unknowns of the coupling points.
const UNKNOWNS: usize = 3 * POINTS;

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
    /// Factors the points' part, one 9 × 9 elimination; `None` where nothing holds the tissue.
    pub(super) fn new<const N: usize>(coupling: &'a Coupling, inverse_diagonal: &Field<N>) -> Option<Self> {
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
                let shared = overlap(coupling, [p, q], inverse_diagonal);
                compliance.fixed_view_mut::<3, 3>(3 * p, 3 * q).set_diagonal(&shared);
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
    pub(super) fn take<const N: usize>(
        &self,
        residual: &Field<N>,
        inverse_diagonal: &Field<N>,
    ) -> ([Vec3; POINTS], f32) {
        let scaled = self.coupling.kernels.each_ref().map(|kernel| {
            let of = |(node, w)| at(residual, node).component_mul(&at(inverse_diagonal, node)) * w;
            kernel.iter().map(of).sum::<Vec3>()
        });
        let back = product(&self.schur, &scaled);
        let taken = inner(&scaled, &back);
        (back, taken)
    }

    /// Takes D⁻¹ Wᵀ b from `scaled`.
    pub(super) fn give<const N: usize>(
        &self,
        back: &[Vec3; POINTS],
        inverse_diagonal: &Field<N>,
        scaled: &mut Field<N>,
    ) {
        for (kernel, back) in self.coupling.kernels.iter().zip(back) {
            for (node, w) in kernel.iter() {
                let inverse = at(inverse_diagonal, node);
                add(scaled, node, -inverse.component_mul(back) * w);
            }
        }
    }
}

/// Diagonal of W_p D⁻¹ W_qᵀ: both kernels are in ascending order.
fn overlap<const N: usize>(coupling: &Coupling, [p, q]: [usize; 2], inverse_diagonal: &Field<N>) -> SVector<f32, 3> {
    let (a, b) = (&coupling.kernels[p], &coupling.kernels[q]);
    let mut sum = Vec3::zeros();
    let mut others = b.iter().peekable();
    for (node, w) in a.iter() {
        while others.next_if(|(other, _)| *other < node).is_some() {}
        if let Some((_, v)) = others.next_if(|(other, _)| *other == node) {
            sum += at(inverse_diagonal, node) * (w * v);
        }
    }
    sum
}

/// Inner product of vectors at the points.
pub(super) fn inner(a: &[Vec3; POINTS], b: &[Vec3; POINTS]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}
