//! The linearised operator A = m(1/dt² + α/dt) + K + WᵀSW + wound contact, applied in passes, and its preconditioner.

use super::points::{Inverse, Points, inner};
use super::spring::Ends;
use super::sweep::{Pass, sweep};
use super::{Problem, Work, volume};
use crate::coupling::POINTS;
use crate::lanes::Lanes;
use crate::lattice::{DIRECTIONS, Field, Lattice};
use crate::math::{DT, Vec3};
use crate::wound::{Faces, PAIRS_MAX};

/// 1/dt² + α/dt [1/s²].
pub(super) fn inertia<const N: usize>(problem: &Problem<'_, N>) -> f32 {
    1.0 / (DT * DT) + problem.material.mass_damping / DT
}

/// `work.product` = A · `work.search`; gives `search`ᵀ A `search`.
#[inline(always)]
pub(super) fn apply<L: Lanes, const N: usize>(
    lanes: L,
    problem: &Problem<'_, N>,
    points: Option<&Points<'_>>,
    work: &mut Work<N>,
) -> f32 {
    let curvature = tissue(lanes, problem, inertia(problem), work);
    let Work {
        search,
        product,
        contact,
        ..
    } = work;
    curvature + tie(problem, points, (search, contact), (1.0, product))
}

/// Adds `scale` times what wound contact and points answer `search` with to `sum`; gives the answer's inner product with `search`.
pub(super) fn tie<const N: usize>(
    problem: &Problem<'_, N>,
    points: Option<&Points<'_>>,
    (search, contact): (&Field<N>, &[f32; PAIRS_MAX]),
    (scale, sum): (f32, &mut Field<N>),
) -> f32 {
    let mut curvature = 0.0;
    if let Some(faces) = problem.faces {
        let ([search, ..], [sum, ..]) = (search, &mut *sum);
        for ((left, right), penalty) in faces.pairs().zip(contact) {
            let (Some(a), Some(b)) = (search.get(left), search.get(right)) else {
                continue;
            };
            let push = penalty * (b - a);
            add_at(sum, left, -scale * push);
            add_at(sum, right, scale * push);
            curvature += push * (b - a);
        }
    }
    if let Some(coupling) = points.map(|points| points.coupling) {
        let moved = coupling.gather(search);
        let pull = coupling.product(&moved);
        coupling.scatter(&pull.map(|pull| pull * scale), sum);
        curvature += inner(&moved, &pull);
    }
    curvature
}

/// `work.product` = (`inertia` M + K) · `work.search`, springs and voxels alone; gives its inner product with `search`.
#[inline(always)]
pub(super) fn tissue<L: Lanes, const N: usize>(
    lanes: L,
    problem: &Problem<'_, N>,
    inertia: f32,
    work: &mut Work<N>,
) -> f32 {
    let springs = springs(lanes, problem.lattice, inertia, work);
    if problem.material.volume {
        springs + volume::apply(lanes, problem.lattice, work)
    } else {
        springs
    }
}

/// The same of the springs alone.
#[inline(always)]
fn springs<L: Lanes, const N: usize>(lanes: L, lattice: &Lattice<N>, inertia: f32, work: &mut Work<N>) -> f32 {
    let Work {
        given,
        search,
        product,
        axial,
        transverse,
        ..
    } = work;
    let mut pass = Apply {
        mass: &lattice.mass,
        inertia,
        search,
        product,
        axial,
        transverse,
        curvature: lanes.nothing(),
    };
    sweep(lanes, lattice, given, &mut pass);
    lanes.total(pass.curvature)
}

/// Mass and springs: (g gᵀ + b I) on the difference of a spring's two ends.
struct Apply<'a, L: Lanes, const N: usize> {
    mass: &'a [f32; N],
    inertia: f32,
    search: &'a Field<N>,
    product: &'a mut Field<N>,
    axial: &'a [Field<N>; DIRECTIONS],
    transverse: &'a [[f32; N]; DIRECTIONS],
    curvature: L::Sum,
}

impl<L: Lanes, const N: usize> Pass<L, 3> for Apply<'_, L, N> {
    type Near = [L::F; 3];

    #[inline(always)]
    fn near(&self, lanes: L, at: usize) -> Self::Near {
        lanes.vector(self.search, at)
    }

    #[inline(always)]
    fn spring<const D: usize>(&mut self, lanes: L, near: Self::Near, at: usize, far: usize) -> [L::F; 3] {
        let ends = [near, lanes.vector(self.search, far)];
        answer::<L, D, N>(lanes, (self.axial, self.transverse), at, ends)
    }

    #[inline(always)]
    fn node(&mut self, lanes: L, at: usize, begin: [L::F; 3], end: [L::F; 3]) {
        let inertia = lanes.load(self.mass, at) * lanes.splat(self.inertia);
        for c in 0..3 {
            let search = lanes.load(&self.search[c], at);
            let product = inertia * search - (begin[c] - end[c]);
            lanes.store(product, &mut self.product[c], at);
            self.curvature = lanes.add(self.curvature, at, search * product);
        }
    }
}

/// What the springs of direction `D` from nodes `at…` pull their lower nodes with, to first order, where their ends move by `ends`.
#[inline(always)]
pub(super) fn answer<L: Lanes, const D: usize, const N: usize>(
    lanes: L,
    (axial, transverse): (&[Field<N>; DIRECTIONS], &[[f32; N]; DIRECTIONS]),
    at: usize,
    [[ax, ay, az], [bx, by, bz]]: Ends<L::F>,
) -> [L::F; 3] {
    let (x, y, z) = (bx - ax, by - ay, bz - az);
    let [gx, gy, gz] = lanes.vector(&axial[D], at);
    let across = lanes.load(&transverse[D], at);
    let stretch = gx * x + gy * y + gz * z;
    [
        gx * stretch + across * x,
        gy * stretch + across * y,
        gz * stretch + across * z,
    ]
}

fn add_at<const N: usize>(values: &mut [f32; N], index: usize, add: f32) {
    if let Some(value) = values.get_mut(index) {
        *value += add;
    }
}

/// Finds the wound's pairs that meet at `place`, adds their force to the residual and their stiffness to the inverse of the diagonal.
pub(super) fn meet<const N: usize>(
    faces: &Faces,
    [place, ..]: &Field<N>,
    ([residual, ..], contact): (&mut Field<N>, &mut [f32; PAIRS_MAX]),
    inverse: &mut impl Inverse,
) {
    for ((left, right), penalty) in faces.pairs().zip(contact) {
        let (Some(a), Some(b)) = (place.get(left), place.get(right)) else {
            continue;
        };
        let width = faces.width(*a, *b);
        *penalty = if width < 0.0 { faces.penalty } else { 0.0 };
        let push = -*penalty * width;
        add_at(residual, left, -push);
        add_at(residual, right, push);
        inverse.stiffen(left, *penalty);
        inverse.stiffen(right, *penalty);
    }
}

/// Adds the points' force, once they have `moved` from their predicted places, to the residual of the nodes that move.
pub(super) fn load_points<const N: usize>(problem: &Problem<'_, N>, moved: &[Vec3; POINTS], work: &mut Work<N>) {
    let Problem { lattice, coupling, .. } = problem;
    for (kernel, force) in coupling.kernels.iter().zip(coupling.at(moved)) {
        let moving = |(node, _): &(usize, f32)| lattice.free.get(*node).is_some_and(|free| *free > 0.0);
        for (node, w) in kernel.iter().filter(moving) {
            crate::lattice::add(&mut work.residual, node, force * w);
        }
    }
}
