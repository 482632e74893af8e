//! What a free block keeps, and what it may only lose.

use super::block::{Block, DEFAULT, Random, linear, scene};
use super::reference::{Springs, wide};
use sutura_controller::coupling::Coupling;
use sutura_controller::solver::BePcg;
use sutura_shared::scene::Law;

const YOUNG: f32 = 100e3;
/// Enough for the linear solve to add nothing of its own.
const MANY: BePcg = BePcg {
    iterations: 120,
    newton: 2,
};

/// A block that nothing holds, every node out of place by up to `shift` [m] and in motion by up to `speed` [m/s].
fn shaken(shift: f32, speed: f32) -> (Block, Springs) {
    let mut block = Block::filled(&scene([7, 6, 5], Law::Isotropic, &[linear(YOUNG)], &[]));
    block.release();
    let mut random = Random::new(7);
    for (n, _) in block.nodes() {
        for c in 0..3 {
            block.tissue.displacement[c][n] = shift * random.next();
            block.tissue.velocity[c][n] = speed * random.next();
        }
    }
    let springs = Springs::new(&block, Law::Isotropic, f64::from(YOUNG));
    (block, springs)
}

/// Elastic and kinetic energy [J].
fn energy(block: &Block, springs: &Springs) -> f64 {
    let [u, v] = [&block.tissue.displacement, &block.tissue.velocity].map(|field| wide(field, block.lattice.len()));
    springs.energy(&u) + springs.kinetic(&v)
}

/// Largest change of the momentum over the momentum in 100 ticks.
fn momentum_lost(solver: BePcg) -> f64 {
    let (mut block, springs) = shaken(5e-5, 0.05);
    block.tissue.velocity[0].iter_mut().for_each(|v| *v += 0.02);
    let momentum = |block: &Block| springs.momentum(&wide(&block.tissue.velocity, block.lattice.len()));
    let before = momentum(&block);
    let after = (0..100).map(|_| {
        block.tick(solver, &Coupling::default(), None);
        (momentum(&block) - before).norm() / before.norm()
    });
    after.fold(0.0, f64::max)
}

/// Inner forces cancel, so what is lost is the linear solver's error.
#[test]
fn a_free_block_keeps_its_momentum() {
    let [lost, own] = [MANY, DEFAULT].map(momentum_lost);
    eprintln!("momentum lost in 100 ticks: {lost:.2e}; with the scenes' own dials {own:.2e}");
    assert!(lost < 1e-6, "{lost:e}");
}

/// Largest rise of the energy in one tick over the energy before it and over the first, in 1000 ticks.
fn energy_gained(solver: BePcg) -> [f64; 2] {
    let (mut block, springs) = shaken(1e-4, 0.1);
    let first = energy(&block, &springs);
    let mut last = first;
    let mut gained = [0.0_f64; 2];
    for _ in 0..1000 {
        block.tick(solver, &Coupling::default(), None);
        let now = energy(&block, &springs);
        gained = [gained[0].max((now - last) / last), gained[1].max((now - last) / first)];
        last = now;
    }
    eprintln!("{solver:?}: {first:.3e} J to {last:.3e} J, gained {gained:?} of the tick before and of the first");
    gained
}

/// Backward Euler dissipates: without a tool and without damping, elastic and kinetic energy together never grow.
/// Ten iterations leave an error in the linear solve, which may show once nearly all energy is gone.
#[test]
fn a_free_block_gains_no_energy() {
    let [of_last, _] = energy_gained(MANY);
    assert!(of_last < 1e-6, "{of_last:e}");
    let [_, of_first] = energy_gained(DEFAULT);
    assert!(of_first < 1e-6, "{of_first:e}");
}
