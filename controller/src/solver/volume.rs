//! The voxels' energy a³ U(J), U = ½ Λ (J − 1)² + ½ B max(0, J_b − J)², J the determinant of a voxel's mean edges E_i over a³.
//!
//! With p = dU/dJ and the faces C_x = E_y × E_z/a² (and cyclic), a mean edge is pulled with p a² C_i, and a corner moves it by ±1/4 of its way.
//! Linearised, a voxel's U″ a³ ∇J ∇Jᵀ stays as it is. p a³ ∇²J is indefinite: with mean edges about as long as a its eigenvalues on them lie within
//! ±|p| a but for growth alike in all directions, which U″ outweighs. It is replaced by ½ |p| a on the mean edges: the operator
//! stays positive definite and is nowhere less than half the true one, which is what steps with it need to converge.

mod shape;

pub(super) use shape::{add_force, energy};

use super::symmetric::{self, Symmetric};
use super::voxel::{DIAGONALS, VoxelPass, along_diagonals, mean_edges, sweep_voxels};
use super::{Problem, Work};
use crate::lanes::{Lanes, blocks};
use crate::lattice::{Field, Lattice};
use shape::{Shape, dot, scaled, shape, times};

/// Adds the voxels' force at `work.place` to the residual and their stiffness to the diagonal, at nodes that move, and fills their operator.
#[inline(always)]
pub(super) fn linearise<L: Lanes, const N: usize>(lanes: L, lattice: &Lattice<N>, work: &mut Work<N>) {
    let Work {
        given,
        place,
        residual,
        inverse_diagonal,
        growth,
        pressure,
        ..
    } = work;
    let mut pass = Linearise {
        lattice,
        place,
        residual,
        inverse_diagonal,
        growth,
        pressure,
    };
    sweep_voxels(lanes, lattice, given, &mut pass);
}

struct Linearise<'a, const N: usize> {
    lattice: &'a Lattice<N>,
    place: &'a Field<N>,
    residual: &'a mut Field<N>,
    inverse_diagonal: &'a mut Field<N>,
    growth: &'a mut [Field<N>; 3],
    pressure: &'a mut [f32; N],
}

/// What voxels give their body diagonals.
struct Tangent<F> {
    /// Force, by diagonal [N].
    pulls: [[F; 3]; DIAGONALS],
    /// Gradient of the volume times the root of its stiffness, by diagonal [√(N/m)].
    slopes: [[F; 3]; DIAGONALS],
    /// |p| a/32 [N/m].
    either: F,
}

/// The voxels from index `at` at displacements `place`; their operator is stored.
#[inline(always)]
fn tangent<L: Lanes, const N: usize>(
    lanes: L,
    lattice: &Lattice<N>,
    (place, at): (&Field<N>, usize),
    (stored, along): (&mut [f32; N], &mut [Field<N>; 3]),
) -> Tangent<L::F> {
    let Shape {
        faces,
        pressure,
        stiffness,
    } = shape(lanes, lattice, place, at);
    let pitch = lattice.pitch;
    let pull = pressure * lanes.splat(0.25 * pitch * pitch);
    let growth = scaled::<L>(faces, lanes.root(stiffness * lanes.splat(pitch / 16.0)));
    let either = lanes.larger(pressure, lanes.splat(0.0) - pressure) * lanes.splat(pitch / 32.0);
    lanes.store(either, stored, at);
    for i in 0..3 {
        for c in 0..3 {
            lanes.store(growth[i][c], &mut along[i][c], at);
        }
    }
    Tangent {
        pulls: along_diagonals(lanes, scaled::<L>(faces, pull)),
        slopes: along_diagonals(lanes, growth),
        either,
    }
}

impl<L: Lanes, const N: usize> VoxelPass<L, 6> for Linearise<'_, N> {
    #[inline(always)]
    fn voxel(&mut self, lanes: L, at: usize) -> [[L::F; 6]; DIAGONALS] {
        let Tangent { pulls, slopes, either } =
            tangent(lanes, self.lattice, (self.place, at), (self.pressure, self.growth));
        let mut give = [[lanes.splat(3.0) * either; 6]; DIAGONALS];
        for m in 0..DIAGONALS {
            for c in 0..3 {
                give[m][c] = pulls[m][c];
                give[m][c + 3] = give[m][c + 3] + slopes[m][c] * slopes[m][c];
            }
        }
        give
    }

    #[inline(always)]
    fn node(&mut self, lanes: L, at: usize, begin: [L::F; 6], end: [L::F; 6]) {
        let free = lanes.load(&self.lattice.free, at);
        for c in 0..3 {
            let force = lanes.load(&self.residual[c], at) + (begin[c] - end[c]) * free;
            lanes.store(force, &mut self.residual[c], at);
            let inverse = lanes.load(&self.inverse_diagonal[c], at);
            let one = lanes.splat(1.0);
            let further = inverse / (one + (begin[c + 3] + end[c + 3]) * inverse);
            lanes.store(further, &mut self.inverse_diagonal[c], at);
        }
    }
}

/// Makes `work.residual` the voxels' force at `work.place` and `work.inverse_block` their blocks, not inverted, and fills their operator.
///
/// A block is four times the voxels' part of the operator there: eight corners move a voxel's volume, and half of them, one colour of the
/// lattice, four times as much together as the sum of what each does alone.
#[inline(always)]
pub(super) fn linearise_blocks<L: Lanes, const N: usize>(lanes: L, lattice: &Lattice<N>, work: &mut Work<N>) {
    let Work {
        given,
        place,
        residual,
        inverse_block,
        growth,
        pressure,
        ..
    } = work;
    let mut pass = LineariseBlocks {
        lattice,
        place,
        residual,
        block: inverse_block,
        growth,
        pressure,
    };
    sweep_voxels(lanes, lattice, given, &mut pass);
}

struct LineariseBlocks<'a, const N: usize> {
    lattice: &'a Lattice<N>,
    place: &'a Field<N>,
    residual: &'a mut Field<N>,
    block: &'a mut Symmetric<N>,
    growth: &'a mut [Field<N>; 3],
    pressure: &'a mut [f32; N],
}

impl<L: Lanes, const N: usize> VoxelPass<L, 9> for LineariseBlocks<'_, N> {
    #[inline(always)]
    fn voxel(&mut self, lanes: L, at: usize) -> [[L::F; 9]; DIAGONALS] {
        let Tangent { pulls, slopes, either } =
            tangent(lanes, self.lattice, (self.place, at), (self.pressure, self.growth));
        let mut give = [[either; 9]; DIAGONALS];
        for m in 0..DIAGONALS {
            let slope = times::<L>(slopes[m], lanes.splat(2.0));
            let block = symmetric::of_spring::<L>(slope, lanes.splat(4.0) * either);
            give[m] = symmetric::with_force::<L>(pulls[m], block);
        }
        give
    }

    #[inline(always)]
    fn node(&mut self, lanes: L, at: usize, begin: [L::F; 9], end: [L::F; 9]) {
        let (pull, block) = symmetric::at_node::<L>(begin, end);
        for c in 0..3 {
            lanes.store(pull[c], &mut self.residual[c], at);
        }
        symmetric::store(lanes, block, self.block, at);
    }
}

/// Adds the voxels' part of the operator to `work.product`; gives `search`ᵀ times it.
#[inline(always)]
pub(super) fn apply<L: Lanes, const N: usize>(lanes: L, lattice: &Lattice<N>, work: &mut Work<N>) -> f32 {
    let Work {
        given,
        search,
        product,
        growth,
        pressure,
        ..
    } = work;
    let mut pass = Apply {
        lattice,
        search,
        sum: product,
        sign: 1.0,
        growth,
        pressure,
        curvature: lanes.nothing(),
    };
    sweep_voxels(lanes, lattice, given, &mut pass);
    lanes.total(pass.curvature)
}

/// Takes the voxels' part of the operator times `work.search` from `work.residual`.
#[inline(always)]
pub(super) fn reduce<L: Lanes, const N: usize>(lanes: L, lattice: &Lattice<N>, work: &mut Work<N>) {
    let Work {
        given,
        search,
        residual,
        growth,
        pressure,
        ..
    } = work;
    let mut pass = Apply {
        lattice,
        search,
        sum: residual,
        sign: -1.0,
        growth,
        pressure,
        curvature: lanes.nothing(),
    };
    sweep_voxels(lanes, lattice, given, &mut pass);
}

/// g gᵀ + b I on the nine components of a voxel's mean edges, each four times its way.
struct Apply<'a, L: Lanes, const N: usize> {
    lattice: &'a Lattice<N>,
    search: &'a Field<N>,
    /// Takes the product with this sign.
    sum: &'a mut Field<N>,
    sign: f32,
    growth: &'a [Field<N>; 3],
    pressure: &'a [f32; N],
    curvature: L::Sum,
}

impl<L: Lanes, const N: usize> VoxelPass<L, 3> for Apply<'_, L, N> {
    #[inline(always)]
    fn voxel(&mut self, lanes: L, at: usize) -> [[L::F; 3]; DIAGONALS] {
        let mut edges = mean_edges(lanes, self.lattice, self.search, at);
        let zero = lanes.splat(0.0);
        let (mut swelling, mut square) = (zero, zero);
        for i in 0..3 {
            swelling = swelling + dot::<L>(lanes.vector(&self.growth[i], at), edges[i]);
            square = square + dot::<L>(edges[i], edges[i]);
        }
        let either = lanes.load(self.pressure, at);
        self.curvature = lanes.add(self.curvature, at, swelling * swelling + either * square);
        for i in 0..3 {
            for c in 0..3 {
                edges[i][c] = lanes.load(&self.growth[i][c], at) * swelling + either * edges[i][c];
            }
        }
        along_diagonals(lanes, edges)
    }

    #[inline(always)]
    fn node(&mut self, lanes: L, at: usize, begin: [L::F; 3], end: [L::F; 3]) {
        for c in 0..3 {
            let sum = lanes.load(&self.sum[c], at) - lanes.splat(self.sign) * (begin[c] - end[c]);
            lanes.store(sum, &mut self.sum[c], at);
        }
    }
}

/// The operator's voxels at their stiffest: with the faces they have at rest and the barrier's stiffness beside the volume's.
#[inline(always)]
pub(super) fn stiffen<L: Lanes, const N: usize>(lanes: L, problem: &Problem<'_, N>, work: &mut Work<N>) {
    let lattice = problem.lattice;
    work.pressure.fill(0.0);
    work.growth.iter_mut().flatten().for_each(|part| part.fill(0.0));
    for (axis, growth) in work.growth.iter_mut().enumerate() {
        for at in blocks::<L, N>(lattice.len()) {
            let stiffness = lanes.load(&lattice.volume, at) + lanes.load(&lattice.barrier, at);
            let stiffness = stiffness * lanes.splat(lattice.pitch / 16.0);
            lanes.store(lanes.root(stiffness), &mut growth[axis], at);
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::lanes::Single;
    use std::boxed::Box;

    const N: usize = Lattice::<0>::guard([5, 4, 4]) as usize;

    /// Numbers from −1 to 1 without a pattern, at nodes of the box.
    fn rough(lattice: &Lattice<N>, scale: f32, seed: f64) -> Box<Field<N>> {
        let mut field: Box<Field<N>> = bytemuck::zeroed_box();
        for (c, part) in field.iter_mut().enumerate() {
            for (_, n) in lattice.nodes() {
                part[n] = scale * libm::sin((n * 3 + c) as f64 * 12.9898 + seed) as f32;
            }
        }
        field
    }

    fn dot(a: &Field<N>, b: &Field<N>) -> f64 {
        let pairs = a.iter().flatten().zip(b.iter().flatten());
        pairs.map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
    }

    /// Voxels of 2 mm with Λ = 276 kPa and B = 800 kPa, a third of the lowest layer of nodes held.
    fn lattice() -> Box<Lattice<N>> {
        let mut lattice: Box<Lattice<N>> = bytemuck::zeroed_box();
        (lattice.nodes, lattice.pitch) = ([5, 4, 4], 2e-3);
        for ([i, j, k], n) in lattice.nodes() {
            lattice.mass[n] = 1e-6;
            lattice.free[n] = if k == 0 && i % 3 == 0 { 0.0 } else { 1.0 };
            if i < 4 && j < 3 && k < 3 {
                (lattice.volume[n], lattice.barrier[n]) = (276e3, 800e3);
            }
        }
        lattice
    }

    /// aᵀ K b = bᵀ K a and aᵀ K a ≥ 0, near rest and where voxels are inverted; the diagonal is that of K.
    #[test]
    fn the_operator_is_symmetric_and_positive() {
        let lattice = lattice();
        let mut work: Box<Work<N>> = bytemuck::zeroed_box();
        for shift in [1e-5, 2e-3, 6e-3] {
            work.place = *rough(&lattice, shift, 0.5);
            work.inverse_diagonal
                .iter_mut()
                .for_each(|part| part.copy_from_slice(&lattice.free));
            linearise(Single, &lattice, &mut work);
            let inverse_diagonal = work.inverse_diagonal;
            let mut product = |p: &Field<N>| {
                work.search = *p;
                work.product = [[0.0; N]; 3];
                let curvature = apply(Single, &lattice, &mut work);
                (work.product, f64::from(curvature))
            };
            for seed in 1..20_u8 {
                let [a, b] = [0.0, 0.3].map(|more| rough(&lattice, 1.0, f64::from(seed) + more));
                let ((ka, aka), (kb, _)) = (product(&a), product(&b));
                let scale = libm::sqrt(dot(&ka, &ka) * dot(&b, &b));
                assert!((dot(&b, &ka) - dot(&a, &kb)).abs() < 1e-5 * scale);
                assert!(aka > 0.0 && (dot(&a, &ka) / aka - 1.0).abs() < 1e-4);
            }
            for (_, n) in lattice.nodes().filter(|(_, n)| lattice.free[*n] > 0.0) {
                for c in 0..3 {
                    let mut unit: Box<Field<N>> = bytemuck::zeroed_box();
                    unit[c][n] = 1.0;
                    let (_, own) = product(&unit);
                    let expected = 1.0 / (1.0 + own);
                    let inverse = f64::from(inverse_diagonal[c][n]);
                    assert!(
                        (inverse / expected - 1.0).abs() < 1e-5,
                        "{n} {c}: {inverse} for {expected}"
                    );
                }
            }
        }
    }
}
