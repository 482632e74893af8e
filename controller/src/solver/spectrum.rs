//! How fast a lattice's fastest mode is, which explicit steps must resolve, and how slow its slowest, which iterations must reach.

use super::be_chebyshev::HIGHEST;
use super::operator::{self, tissue};
use super::sweep::{Pass, sweep};
use super::symmetric::{self, Symmetric};
use super::{Problem, Work, volume};
use crate::lanes::{Lanes, blocks, run_on};
use crate::lattice::{DIRECTIONS, EDGES, Field, Lattice, STEPS};
use crate::law::Breaks;
use crate::math::{DT, sqrt};

/// Rounds of the power iteration; it ends within 1 % of the largest eigenvalue on lattices of any shape.
const ROUNDS: usize = 100;
/// Added to ω for what the iteration falls short of, and for springs that turn and stretch.
const MARGIN: f32 = 1.02;

/// Compression of the body diagonals up to which explicit steps are to be stable: about what a needle does before it goes through.
const LOCKED: f32 = 0.15;

/// The smallest stable number of explicit substeps a tick: h < 2/ω, with β-dashpots h < (√(1 + ζ²) − ζ) 2/ω and ζ = β ω₀²/(2ω).
///
/// ω is that of the lattice at rest with every spring at the steepest slope of its curve, body diagonals also locked by `LOCKED`, and voxels
/// that keep their volume and are held from inverting; ω₀ is that of the first slopes, which dashpots go by. A lock pressed further is
/// steeper still.
pub fn fewest_substeps<const N: usize>(problem: &Problem<'_, N>, work: &mut Work<N>) -> u16 {
    let steepest = |breaks: &Breaks| breaks.steepest().max(breaks.locked(LOCKED));
    let omega = MARGIN * sqrt(run_on!(problem.level, lanes => fastest(lanes, problem, steepest, work)));
    let beta = problem.material.spring_damping;
    let zeta = if beta > 0.0 {
        let first = run_on!(problem.level, lanes => fastest(lanes, problem, |_: &Breaks| 1.0, work));
        0.5 * beta * MARGIN * MARGIN * first / omega
    } else {
        0.0
    };
    let fewest = 0.5 * omega * DT * (sqrt(1.0 + zeta * zeta) + zeta);
    // As a count, which saturates.
    libm::ceilf(fewest).max(1.0) as u16
}

/// Largest eigenvalue of M⁻¹ K over the nodes that move [1/s²], by power iteration.
#[inline(always)]
fn fastest<L: Lanes, const N: usize>(
    lanes: L,
    problem: &Problem<'_, N>,
    slope: impl Fn(&Breaks) -> f32,
    work: &mut Work<N>,
) -> f32 {
    let n = problem.lattice.len();
    stretch(lanes, problem, slope, work);
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

/// The operator's springs at rest, each at its first slope times `slope` of its curve.
#[inline(always)]
fn stretch<L: Lanes, const N: usize>(
    lanes: L,
    problem: &Problem<'_, N>,
    slope: impl Fn(&Breaks) -> f32,
    work: &mut Work<N>,
) {
    let (lattice, material) = (problem.lattice, problem.material);
    for d in 0..DIRECTIONS {
        work.transverse[d].fill(0.0);
        for at in blocks::<L, N>(lattice.len()) {
            let mut stiffness = lanes.splat(0.0);
            for (curve, first) in material.curves.iter().zip(&lattice.stiffness) {
                let breaks = if d < EDGES { &curve.edge } else { &curve.diagonal };
                let slope = if material.stiffening { slope(breaks) } else { 1.0 };
                stiffness = stiffness + lanes.splat(slope) * lanes.load(&first[d], at);
            }
            // Unit directions have parts of 1 along an edge, of ±1/√3 along a diagonal.
            let along = lanes.root(stiffness / lanes.splat(if d < EDGES { 1.0 } else { 3.0 }));
            for c in 0..3 {
                lanes.store(along * lanes.splat(STEPS[d][c] as f32), &mut work.axial[d][c], at);
            }
        }
    }
}

/// Smallest eigenvalue of M⁻¹A at rest, with every spring at its first slope and M the operator's 3 × 3 blocks; from above, by power
/// iteration on 2 − M⁻¹A.
pub(super) fn slowest<const N: usize>(problem: &Problem<'_, N>, work: &mut Work<N>) -> f32 {
    run_on!(problem.level, lanes => lowest(lanes, problem, work))
}

#[inline(always)]
fn lowest<L: Lanes, const N: usize>(lanes: L, problem: &Problem<'_, N>, work: &mut Work<N>) -> f32 {
    let lattice = problem.lattice;
    stretch(lanes, problem, |_| 1.0, work);
    let inertia = operator::inertia(problem);
    work.inverse_block.iter_mut().for_each(|part| part.fill(0.0));
    if problem.material.volume {
        work.place.iter_mut().for_each(|part| part.fill(0.0));
        volume::linearise_blocks(lanes, lattice, work);
    }
    let Work {
        given,
        axial,
        inverse_block,
        ..
    } = &mut *work;
    let mut pass = Invert {
        lattice,
        inertia,
        axial,
        inverse_block,
    };
    sweep(lanes, lattice, given, &mut pass);
    // The slowest mode moves everything one way.
    for search in &mut work.search {
        search.clone_from(&lattice.free);
    }
    let mut value = HIGHEST;
    for _ in 0..ROUNDS {
        let energy = tissue(lanes, problem, inertia, work);
        let mut sum = lanes.nothing();
        for at in blocks::<L, N>(lattice.len()) {
            let product = lanes.vector(&work.product, at);
            let scaled = symmetric::times::<L>(symmetric::load(lanes, &work.inverse_block, at), product);
            for c in 0..3 {
                sum = lanes.add(sum, at, scaled[c] * product[c]);
                let next = lanes.splat(HIGHEST) * lanes.load(&work.search[c], at) - scaled[c];
                lanes.store(lanes.splat(1.0 / HIGHEST) * next, &mut work.search[c], at);
            }
        }
        // The quotient of M⁻¹A in A's own inner product.
        value = if energy > 0.0 { lanes.total(sum) / energy } else { value };
    }
    value
}

/// Inverse blocks of the operator: its voxels' blocks stand in `inverse_block` already.
struct Invert<'a, const N: usize> {
    lattice: &'a Lattice<N>,
    inertia: f32,
    axial: &'a [Field<N>; DIRECTIONS],
    inverse_block: &'a mut Symmetric<N>,
}

impl<L: Lanes, const N: usize> Pass<L, 9> for Invert<'_, N> {
    type Near = ();

    #[inline(always)]
    fn near(&self, _: L, _: usize) {}

    #[inline(always)]
    fn spring<const D: usize>(&mut self, lanes: L, (): (), at: usize, _: usize) -> [L::F; 9] {
        let zero = lanes.splat(0.0);
        let block = symmetric::of_spring::<L>(lanes.vector(&self.axial[D], at), zero);
        symmetric::with_force::<L>([zero; 3], block)
    }

    #[inline(always)]
    fn node(&mut self, lanes: L, at: usize, begin: [L::F; 9], end: [L::F; 9]) {
        let (_, mut block) = symmetric::at_node::<L>(begin, end);
        symmetric::add(&mut block, symmetric::load(lanes, self.inverse_block, at));
        let inertia = lanes.load(&self.lattice.mass, at) * lanes.splat(self.inertia);
        let free = lanes.load(&self.lattice.free, at);
        let inverse = symmetric::invert(lanes, free, symmetric::plus::<L>(block, inertia));
        symmetric::store(lanes, inverse, self.inverse_block, at);
    }
}
