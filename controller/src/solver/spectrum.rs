//! How fast a lattice's fastest mode is: what explicit steps must resolve.

use super::operator::tissue;
use super::{Problem, Work, volume};
use crate::lanes::{Lanes, blocks, run_on};
use crate::lattice::{DIRECTIONS, EDGES, STEPS};
use crate::math::{DT, sqrt};

/// Rounds of the power iteration; it ends within 1 % of the largest eigenvalue on lattices of any shape.
const ROUNDS: usize = 100;
/// Added to ω for what the iteration falls short of, and for springs that turn and stretch.
const MARGIN: f32 = 1.02;

/// Compression of the body diagonals up to which explicit steps are to be stable: about what a needle does before it goes through.
const LOCKED: f32 = 0.15;

/// The smallest stable number of explicit substeps a tick: h < 2/ω, with β-dashpots h < (√(1 + ζ²) − ζ) 2/ω and ζ = β ω/2.
///
/// ω is that of the lattice at rest with every spring at the steepest slope of its curve, body diagonals also locked by [`LOCKED`], and voxels
/// that keep their volume. A lock pressed further, and the barrier of a voxel about to invert, are steeper still.
pub fn fewest_substeps<const N: usize>(problem: &Problem<'_, N>, work: &mut Work<N>) -> u16 {
    let omega = MARGIN * sqrt(run_on!(problem.level, lanes => fastest(lanes, problem, work)));
    let zeta = 0.5 * problem.material.spring_damping * omega;
    let fewest = 0.5 * omega * DT * (sqrt(1.0 + zeta * zeta) + zeta);
    // As a count, which saturates.
    libm::ceilf(fewest).max(1.0) as u16
}

/// Largest eigenvalue of M⁻¹ K over the nodes that move [1/s²], by power iteration.
#[inline(always)]
fn fastest<L: Lanes, const N: usize>(lanes: L, problem: &Problem<'_, N>, work: &mut Work<N>) -> f32 {
    let n = problem.lattice.len();
    stiffen(lanes, problem, work);
    if problem.material.volume {
        volume::stiffen(lanes, problem, work);
    }
    // A start that holds something of every mode, and of the fastest, which alternate, most.
    let mut seed = 1_u32;
    for c in 0..3 {
        for (x, free) in work.search[c].iter_mut().zip(&problem.lattice.free).take(n) {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *x = free * ((seed >> 8) as f32 / (1 << 23) as f32 - 1.0);
        }
    }
    let mut value = 0.0;
    for _ in 0..ROUNDS {
        let stiff = tissue(lanes, problem, 0.0, work);
        let heavy = weigh(lanes, problem, work);
        value = if heavy > 0.0 { stiff / heavy } else { 0.0 };
        divide(lanes, problem, value, work);
    }
    value
}

/// xᵀ M x of `work.search`.
#[inline(always)]
fn weigh<L: Lanes, const N: usize>(lanes: L, problem: &Problem<'_, N>, work: &Work<N>) -> f32 {
    let mut sum = lanes.nothing();
    for search in &work.search {
        for at in blocks::<L, N>(problem.lattice.len()) {
            let x = lanes.load(search, at);
            sum = lanes.add(sum, at, lanes.load(&problem.lattice.mass, at) * x * x);
        }
    }
    lanes.total(sum)
}

/// `work.search` = M⁻¹ `work.product` over `value` at the nodes that move.
#[inline(always)]
fn divide<L: Lanes, const N: usize>(lanes: L, problem: &Problem<'_, N>, value: f32, work: &mut Work<N>) {
    let lattice = problem.lattice;
    for (search, product) in work.search.iter_mut().zip(&work.product) {
        for at in blocks::<L, N>(lattice.len()) {
            let quotient = lanes.load(product, at) / (lanes.load(&lattice.mass, at) * lanes.splat(value));
            lanes.store(
                lanes.where_positive(lanes.load(&lattice.free, at), quotient),
                search,
                at,
            );
        }
    }
}

/// The operator's springs at rest, at their steepest.
#[inline(always)]
fn stiffen<L: Lanes, const N: usize>(lanes: L, problem: &Problem<'_, N>, work: &mut Work<N>) {
    let (lattice, material) = (problem.lattice, problem.material);
    for d in 0..DIRECTIONS {
        work.transverse[d].fill(0.0);
        for at in blocks::<L, N>(lattice.len()) {
            let mut stiffness = lanes.splat(0.0);
            for (curve, first) in material.curves.iter().zip(&lattice.stiffness) {
                let breaks = if d < EDGES { &curve.edge } else { &curve.diagonal };
                let steepest = if material.stiffening {
                    breaks.steepest().max(breaks.locked(LOCKED))
                } else {
                    1.0
                };
                stiffness = stiffness + lanes.splat(steepest) * lanes.load(&first[d], at);
            }
            // Unit directions have parts of 1 along an edge, of ±1/√3 along a diagonal.
            let along = lanes.root(stiffness / lanes.splat(if d < EDGES { 1.0 } else { 3.0 }));
            for c in 0..3 {
                lanes.store(along * lanes.splat(STEPS[d][c] as f32), &mut work.axial[d][c], at);
            }
        }
    }
}
