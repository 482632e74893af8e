//! What tissue that nobody touches may never do: gain. Vertex block descent against the incremental potential of backward Euler, computed apart in double precision:
//! Φ(u) = Σ m (|u − dt v|² + α dt |u|²)/(2 dt²) + Σ W(spring), with W the integral of its curve.

use super::block::{Block, Hold, N, PITCH, Random, scene, stiffening};
use super::reference::{DT, V, wide};
use sutura_controller::coupling::Coupling;
use sutura_controller::lattice::{DIRECTIONS, EDGES, STEPS};
use sutura_controller::law::Breaks;
use sutura_controller::math::Vec3;
use sutura_controller::solver::Vbd;
use sutura_shared::scene::{Effect, Law};

const DAMPING: f64 = 50.0;

/// ∫ T dε/(k L) of a spring with slopes of 1, rises, falls and a lock.
fn stored(breaks: &Breaks, strain: f64) -> f64 {
    let rises = breaks.strain.iter().zip(&breaks.rise).map(|(at, rise)| {
        let past = strain - f64::from(*at);
        let past = if *at < 0.0 { past.min(0.0) } else { past.max(0.0) };
        0.5 * f64::from(*rise) * past * past
    });
    let under = (-strain - f64::from(breaks.lock.0)).max(0.0);
    0.5 * strain * strain + rises.sum::<f64>() + f64::from(breaks.lock.1) * under.powi(3) / 6.0
}

/// Elastic energy of one tissue's springs [J].
fn elastic(block: &Block, u: &[V]) -> f64 {
    let (curve, [first, ..]) = (&block.material.curves[0], &block.lattice.stiffness);
    let offsets = block.lattice.offsets();
    let of = |direction: usize| {
        let rest = V::from(STEPS[direction].map(f64::from)) * f64::from(PITCH);
        let breaks = if direction < EDGES {
            &curve.edge
        } else {
            &curve.diagonal
        };
        let springs = (0..u.len()).filter(move |low| first[direction][*low] > 0.0);
        let energy = springs.map(move |low| {
            let length = (rest + u[low + offsets[direction]] - u[low]).norm();
            let strain = length / rest.norm() - 1.0;
            f64::from(first[direction][low]) * rest.norm_squared() * stored(breaks, strain)
        });
        energy.sum::<f64>()
    };
    (0..DIRECTIONS).map(of).sum()
}

/// Φ of the step from `before`, displacement and velocity, to `after`.
fn potential(block: &Block, [x, v]: [&[V]; 2], after: &[V]) -> f64 {
    let inertia = |((a, x), v): ((&V, &V), &V)| {
        let u = a - x;
        ((u - v * DT).norm_squared() + DAMPING * DT * u.norm_squared()) / (2.0 * DT * DT)
    };
    let parts = after.iter().zip(x).zip(v).map(inertia);
    let kinetic: f64 = parts.zip(&block.lattice.mass).map(|(e, m)| e * f64::from(*m)).sum();
    kinetic + elastic(block, after)
}

/// Slopes over the first one of skin, and of something steeper than any tissue.
const SKIN: [f32; 2] = [4.0, 10.0];
const STEEP: [f32; 2] = [100.0, 1000.0];

/// Every node out of place by up to `shift` of the pitch and in motion by up to `speed` [m/s]; springs on both sides of their breaks.
fn shaken(young: f32, slopes: [f32; 2], (shift, speed): (f32, f32), seed: u64) -> Block {
    let [second, third] = slopes.map(|slope| slope * young);
    let tissue = stiffening(&[(0.0, young), (0.03, second), (0.06, third)]);
    let mut scene = scene([6, 5, 4], Law::Isotropic, &[tissue], &[Effect::Stiffening]);
    scene.lattice.damping_per_s = DAMPING as f32;
    let mut block = Block::filled(&scene);
    let mut random = Random::new(seed);
    for (n, _) in block.nodes() {
        for c in 0..3 {
            block.tissue.displacement[c][n] = shift * PITCH * random.next() * block.lattice.free[n];
            block.tissue.velocity[c][n] = speed * random.next() * block.lattice.free[n];
        }
    }
    block
}

/// From the prediction x + dt v on, sweep by sweep, at ω = 1.
#[test]
fn no_sweep_raises_the_incremental_potential() {
    let states = [20e3, 200e3, 2e6]
        .into_iter()
        .flat_map(|young| [0.01, 0.05, 0.15, 0.4].map(|shift| (young, shift)));
    for (young, shift) in states {
        for seed in 1..4 {
            let mut block = shaken(young, SKIN, (shift, 0.05), seed);
            let n = block.lattice.len().min(N);
            let [x, v] = [&block.tissue.displacement, &block.tissue.velocity].map(|field| wide(field, n));
            let start = block.tissue.clone();
            let predicted: Vec<V> = x.iter().zip(&v).map(|(x, v)| x + v * DT).collect();
            let mut last = potential(&block, [&x, &v], &predicted);
            let first = last;
            for sweeps in 1..=12 {
                block.tissue.clone_from(&start);
                block.tick(Vbd { sweeps, omega: 1.0 }, &Coupling::default(), None);
                let now = potential(&block, [&x, &v], &wide(&block.tissue.displacement, n));
                // Single precision leaves a millionth of the largest.
                assert!(
                    now <= last + 1e-6 * first,
                    "{young} Pa, {shift}, seed {seed}, sweep {sweeps}: {last:e} to {now:e} J"
                );
                last = now;
            }
            eprintln!("{young} Pa, {shift} of the pitch, seed {seed}: {first:.3e} J to {last:.3e} J");
            assert!(
                last < 0.9 * first,
                "{young} Pa, {shift}, seed {seed}: {first:e} to {last:e} J"
            );
        }
    }
}

/// Kinetic and elastic energy [J].
fn energy(block: &Block) -> f64 {
    let n = block.lattice.len().min(N);
    let [x, v] = [&block.tissue.displacement, &block.tissue.velocity].map(|field| wide(field, n));
    let moving = v.iter().zip(&block.lattice.mass);
    let kinetic: f64 = moving.map(|(v, m)| 0.5 * f64::from(*m) * v.norm_squared()).sum();
    kinetic + elastic(block, &x)
}

/// Blows after which a plain linearised step throws the tissue back with more than it came with.
#[test]
fn no_tick_gains_energy_after_a_blow() {
    let blows = [
        (SKIN, (0.0, 1.0)),
        (SKIN, (0.5, 0.0)),
        (STEEP, (0.0, 0.3)),
        (STEEP, (0.1, 0.05)),
    ];
    for solver in ["be-pcg:10:1", "be-pcg:10:2", "be-chebyshev:10"] {
        for (slopes, blow) in blows {
            let mut block = shaken(1e5, slopes, blow, 7);
            let choice = block.solver(solver);
            let first = energy(&block);
            let mut last = first;
            for tick in 0..500 {
                block.tick(choice, &Coupling::default(), None);
                let now = energy(&block);
                // Twice what a tick may gain of its own.
                assert!(
                    now <= last * (1.0 + 4e-4) + 1e-9 * first,
                    "{solver}, {slopes:?}, {blow:?}, tick {tick}: {last:e} to {now:e} J"
                );
                last = now;
            }
            eprintln!("{solver}, {slopes:?}, {blow:?}: {first:.3e} J to {last:.3e} J");
            assert!(
                last < 0.01 * first,
                "{solver}, {slopes:?}, {blow:?}: {first:e} to {last:e} J"
            );
        }
    }
}

/// What a tool does is work, not a gain: tissue that is pressed at 0.2 m/s, faster than a hand sews, follows in full.
#[test]
fn a_tissue_that_is_pressed_is_not_held_back() {
    for solver in ["be-pcg:10:1", "be-chebyshev:10"] {
        let mut block = shaken(1e5, SKIN, (0.0, 0.0), 1);
        let mut tool = Hold::on_top(&block, 400.0, Vec3::zeros());
        let choice = block.solver(solver);
        for tick in 0..500_u16 {
            tool.anchor.z = -2e-4 * f32::from(tick.min(10));
            let coupling = tool.coupling(&block.tissue);
            block.tick(choice, &coupling, None);
            let caution = block.tissue.balance.caution;
            assert!(caution < f32::MIN_POSITIVE, "{solver}, tick {tick}: {caution}");
        }
    }
}
