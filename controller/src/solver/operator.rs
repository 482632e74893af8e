//! The linearised operator A = m(1/dt² + α/dt) + K + WᵀSW + wound contact, applied in passes, and its preconditioner.

#![allow(
    clippy::needless_range_loop,
    reason = "lanes of several arrays advance together; an index says so best"
)]

use super::blocks::{BLOCK, window, window_mut};
use super::{Problem, Work};
use crate::coupling::{Coupling, POINTS};
use crate::lattice::{DIRECTIONS, Field, Lattice};
use crate::math::{DT, Mat3, Vec3};
use crate::wound::Faces;
use nalgebra::{SMatrix, SVector};

/// Unknowns of the coupling points.
const UNKNOWNS: usize = 3 * POINTS;

/// `work.product` = A · `work.search`.
pub(super) fn apply<const N: usize>(problem: &Problem<'_, N>, points: Option<&Points<'_>>, work: &mut Work<N>) {
    let lattice = problem.lattice;
    let n = lattice.len();
    let inertia = 1.0 / (DT * DT) + problem.material.mass_damping / DT;
    for (product, search) in work.product.iter_mut().zip(&work.search) {
        for ((q, p), m) in product.iter_mut().zip(search).zip(&lattice.mass).take(n) {
            *q = m * inertia * p;
        }
    }
    springs(lattice, work);
    if let Some(faces) = problem.faces {
        let [search, ..] = &work.search;
        let [product, ..] = &mut work.product;
        for ((left, right), penalty) in faces.pairs().zip(&work.contact) {
            let (Some(a), Some(b)) = (search.get(left), search.get(right)) else {
                continue;
            };
            let push = penalty * (b - a);
            add_at(product, left, -push);
            add_at(product, right, push);
        }
    }
    if let Some(Points { coupling, .. }) = points {
        let pull = coupling.product(&coupling.gather(&work.search));
        coupling.scatter(&pull, &mut work.product);
    }
}

fn add_at<const N: usize>(values: &mut [f32; N], index: usize, add: f32) {
    if let Some(value) = values.get_mut(index) {
        *value += add;
    }
}

/// Adds the springs' part: (g gᵀ + b I) on the difference of a spring's two ends.
fn springs<const N: usize>(lattice: &Lattice<N>, work: &mut Work<N>) {
    let offsets = lattice.offsets();
    for low in (0..lattice.len()).step_by(BLOCK) {
        let [ax, ay, az] = work.search.each_ref().map(|p| *window(p, low));
        let mut own = [[0.0; BLOCK]; 3];
        for direction in 0..DIRECTIONS {
            let far = low + offsets[direction];
            let [bx, by, bz] = work.search.each_ref().map(|p| window(p, far));
            let [gx, gy, gz] = work.axial[direction].each_ref().map(|g| window(g, low));
            let across = window(&work.transverse[direction], low);
            let [qx, qy, qz] = &mut work.product;
            let (Some(qx), Some(qy), Some(qz)) = (window_mut(qx, far), window_mut(qy, far), window_mut(qz, far)) else {
                continue;
            };
            let [ox, oy, oz] = &mut own;
            for l in 0..BLOCK {
                let (x, y, z) = (bx[l] - ax[l], by[l] - ay[l], bz[l] - az[l]);
                let stretch = gx[l] * x + gy[l] * y + gz[l] * z;
                let tx = gx[l] * stretch + across[l] * x;
                let ty = gy[l] * stretch + across[l] * y;
                let tz = gz[l] * stretch + across[l] * z;
                ox[l] -= tx;
                oy[l] -= ty;
                oz[l] -= tz;
                qx[l] += tx;
                qy[l] += ty;
                qz[l] += tz;
            }
        }
        for (product, own) in work.product.iter_mut().zip(&own) {
            if let Some(product) = window_mut(product, low) {
                product.iter_mut().zip(own).for_each(|(q, o)| *q += o);
            }
        }
    }
}

/// Finds the wound's pairs that meet at the linearisation, adds their force to the residual and their stiffness to the diagonal.
pub(super) fn meet<const N: usize>(faces: &Faces, work: &mut Work<N>) {
    let [place, ..] = &work.place;
    let ([residual, ..], [diagonal, ..]) = (&mut work.residual, &mut work.inverse_diagonal);
    for ((left, right), penalty) in faces.pairs().zip(&mut work.contact) {
        let (Some(a), Some(b)) = (place.get(left), place.get(right)) else {
            continue;
        };
        let width = faces.width(*a, *b);
        *penalty = if width < 0.0 { faces.penalty } else { 0.0 };
        let push = -*penalty * width;
        add_at(residual, left, -push);
        add_at(residual, right, push);
        add_at(diagonal, left, *penalty);
        add_at(diagonal, right, *penalty);
    }
}

/// Adds the points' force to the residual.
pub(super) fn load_points<const N: usize>(coupling: &Coupling, work: &mut Work<N>) {
    coupling.scatter(&coupling.force, &mut work.residual);
}

/// The points' part of the operator and of its preconditioner.
///
/// M = D + WᵀSW with D the operator's diagonal. By Woodbury M⁻¹ = D⁻¹ − D⁻¹Wᵀ T W D⁻¹ with T = (I + S G)⁻¹ S and
/// G = W D⁻¹ Wᵀ: S may be singular (a slack thread) and as stiff as a link.
pub(super) struct Points<'a> {
    coupling: &'a Coupling,
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
        let schur = system.lu().solve(&stiffness).unwrap_or_else(SMatrix::zeros);
        Some(Self {
            coupling,
            schur: core::array::from_fn(|p| {
                core::array::from_fn(|q| schur.fixed_view::<3, 3>(3 * p, 3 * q).into_owned())
            }),
        })
    }
}

/// `work.scaled` = M⁻¹ · `work.residual`.
pub(super) fn precondition<const N: usize>(points: Option<&Points<'_>>, n: usize, work: &mut Work<N>) {
    let parts = work.scaled.iter_mut().zip(&work.inverse_diagonal).zip(&work.residual);
    for ((scaled, inverse), residual) in parts {
        for ((z, d), r) in scaled.iter_mut().zip(inverse).zip(residual).take(n) {
            *z = d * r;
        }
    }
    let Some(Points { coupling, schur }) = points else {
        return;
    };
    let back = crate::coupling::product(schur, &coupling.gather(&work.scaled));
    for (kernel, back) in coupling.kernels.iter().zip(&back) {
        for (node, w) in kernel.iter() {
            let inverse = crate::lattice::at(&work.inverse_diagonal, node);
            crate::lattice::add(&mut work.scaled, node, -inverse.component_mul(back) * w);
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
            sum += crate::lattice::at(inverse_diagonal, node) * (w * v);
        }
    }
    sum
}
