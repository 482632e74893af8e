//! Law `volume`: its moduli, its steps and its hard cases.

use super::block::{Block, CONVERGED, N, PITCH, Random, apart, linear, scene, stiffening};
use super::reference::{V, error, wide};
use super::swelling::Whole;
use sutura_controller::coupling::Coupling;
use sutura_controller::lanes::Level;
use sutura_controller::solver::{BePcg, Explicit, Problem, Solver, fewest_substeps};
use sutura_shared::scene::Effect;
use sutura_shared::scene::Law;

const YOUNG: f64 = 100e3;
const NUS: [f32; 4] = [0.25, 0.3, 0.45, 0.49];

fn block(cells: [u16; 3], poisson: f32) -> Block {
    Block::filled(&scene(cells, Law::Volume { poisson }, &[linear(YOUNG as f32)], &[]))
}

/// Every node out of place by up to `shift` [m].
fn shake(block: &mut Block, shift: f32, seed: u64) {
    let mut random = Random::new(seed);
    for (n, _) in block.nodes() {
        for c in 0..3 {
            block.tissue.displacement[c][n] = shift * random.next() * block.lattice.free[n];
        }
    }
}

/// By central differences along each coordinate of every node; the larger shift inverts voxels.
#[test]
fn the_force_is_the_slope_of_the_energy() {
    for (poisson, shift) in NUS.iter().flat_map(|nu| [(*nu, 2e-4), (*nu, 3e-3)]) {
        let mut block = block([3, 2, 4], poisson);
        block.release();
        shake(&mut block, shift, 5);
        let whole = Whole::new(&block, f64::from(poisson), YOUNG);
        let n = block.lattice.len();
        let mut u = wide(&block.tissue.displacement, n);
        if shift > 1e-3 {
            assert!(whole.voxels.iter().any(|voxel| Whole::growth(voxel, &u) < 0.0));
        }
        let force = wide(&block.elastic(None), n);
        let largest = force.iter().map(V::norm).fold(0.0, f64::max);
        for (node, _) in block.nodes() {
            for c in 0..3 {
                let (place, step) = (u[node][c], 1e-8);
                let [plus, minus] = [step, -step].map(|step| {
                    u[node][c] = place + step;
                    whole.energy(&u)
                });
                u[node][c] = place;
                let expected = -(plus - minus) / (2.0 * step);
                let off = (force[node][c] - expected).abs() / largest;
                assert!(off < 2e-5, "{poisson} {shift} {node} {c}: {off:e}");
            }
        }
    }
}

/// Mean stress on the upper face across z [Pa] and how the sides have stretched, at a strain along z with sides that pull no more.
fn stretched(block: &mut Block, strain: f64) -> [f64; 2] {
    let (mut low, mut high) = (-0.3, 0.5);
    let mut across = 0.0;
    for _ in 0..50 {
        across = 0.5 * (low + high);
        block.impose(|[x, y, z]| [x * across, y * across, z * strain]);
        let [pull, ..] = block.pull(0);
        if pull > 0.0 {
            high = across;
        } else {
            low = across;
        }
    }
    let [nx, ny, _] = block.lattice.nodes;
    let area = f64::from((nx - 1) * (ny - 1)) * f64::from(PITCH).powi(2);
    [block.pull(2)[2] / area, across]
}

/// E and ν in uniaxial stress and G in simple shear, within 0.1 % on a block of any size.
#[test]
fn a_block_of_any_size_has_the_moduli_asked_for() {
    for poisson in NUS {
        for cells in [[1, 1, 1], [2, 3, 4], [6, 5, 4]] {
            let mut block = block(cells, poisson);
            let strain = 1e-3;
            let [[up, wide], [down, narrow]] = [strain, -strain].map(|strain| stretched(&mut block, strain));
            let young = (up - down) / (2.0 * strain);
            let measured = (narrow - wide) / (2.0 * strain);
            let [plus, minus] = [strain, -strain].map(|strain| {
                block.impose(|[_, _, z]| [z * strain, 0.0, 0.0]);
                block.pull(2)[0]
            });
            let area = f64::from(cells[0] * cells[1]) * f64::from(PITCH).powi(2);
            let shear = (plus - minus) / (2.0 * strain * area);
            let nu = f64::from(poisson);
            let moduli = [(young, YOUNG), (measured, nu), (shear, 0.5 * YOUNG / (1.0 + nu))];
            for (measured, expected) in moduli {
                assert!(
                    apart(measured, expected) < 1e-3,
                    "{poisson} {cells:?}: {measured} for {expected}"
                );
            }
        }
    }
}

/// From a random state in motion.
#[test]
fn a_tick_is_the_backward_euler_step_of_the_reference() {
    for poisson in NUS {
        let mut block = block([6, 5, 5], poisson);
        block.material.mass_damping = 50.0;
        shake(&mut block, 5e-5, 3);
        let mut random = Random::new(4);
        for (n, _) in block.nodes() {
            for c in 0..3 {
                block.tissue.velocity[c][n] = 5e-2 * random.next() * block.lattice.free[n];
            }
        }
        let n = block.lattice.len();
        let [start, velocity] = [&block.tissue.displacement, &block.tissue.velocity].map(|field| wide(field, n));
        let expected = Whole::new(&block, f64::from(poisson), YOUNG).step(&start, &velocity, 50.0);
        block.tick(CONVERGED, &Coupling::default(), None);
        assert!(block.is_finite(), "{poisson}");
        let way = |after: &[V]| -> Vec<V> { after.iter().zip(&start).map(|(a, b)| a - b).collect() };
        let off = error(&way(&wide(&block.tissue.displacement, n)), &way(&expected));
        eprintln!("nu = {poisson}: step off by {off:.1e} of the largest");
        assert!(off < 1e-4, "{poisson}: {off:e}");
    }
}

/// Pressed together by 30 % within 0.3 s between plates that hold it.
#[test]
fn thirty_percent_of_compression_inverts_no_voxel() {
    for poisson in NUS {
        let mut block = block([8, 8, 6], poisson);
        block.material.mass_damping = 50.0;
        block.release();
        let [_, _, nz] = block.lattice.nodes;
        let height = (nz - 1) as f32 * PITCH;
        let plates: Vec<_> = block.nodes().filter(|(_, [_, _, k])| *k == 0 || k + 1 == nz).collect();
        for (n, [_, _, k]) in plates {
            block.lattice.free[n] = 0.0;
            // Held nodes glide on.
            block.tissue.velocity[2][n] = if k == 0 { 0.0 } else { -0.3 * height / 0.3 };
        }
        let mut least = 1.0_f32;
        for _ in 0..300 {
            block.tick(TWENTY, &Coupling::default(), None);
            least = least.min(block.least_volume());
        }
        eprintln!("nu = {poisson}: the worst corner keeps {least:.2} of its volume");
        assert!(block.is_finite() && least > 0.0, "{poisson}: {least}");
    }
}

/// The scenes' solver with iterations for a nearly incompressible block.
const TWENTY: BePcg = BePcg {
    iterations: 20,
    newton: 1,
};

/// Least J of any voxel a second after `start`, and the largest displacement left [m].
fn left(law: Law, effects: &[Effect], start: impl Fn(&mut Block)) -> [f64; 2] {
    let tissue = stiffening(&[(0.0, 1e5), (0.03, 4e5), (0.06, 1e6)]);
    let mut block = Block::filled(&scene([6, 6, 5], law, &[tissue], effects));
    block.material.mass_damping = 50.0;
    start(&mut block);
    for _ in 0..1000 {
        block.tick(TWENTY, &Coupling::default(), None);
        assert!(block.is_finite());
    }
    let u = wide(&block.tissue.displacement, block.lattice.len());
    let whole = Whole::new(&block, 0.25, YOUNG);
    let growths = whole.voxels.iter().map(|voxel| Whole::growth(voxel, &u));
    [growths.fold(f64::INFINITY, f64::min), f64::from(block.largest())]
}

/// Every node up to four voxels out of place. That springs alone may rest inside out is shown by one mirrored voxel, below.
#[test]
fn no_voxel_rests_inverted() {
    for effects in [vec![], vec![Effect::Stiffening]] {
        for (shift, seed) in [(2e-3, 1), (4e-3, 2), (4e-3, 3), (8e-3, 4), (8e-3, 5)] {
            let crumpled = |block: &mut Block| shake(block, shift, seed);
            for poisson in NUS {
                let [least, far] = left(Law::Volume { poisson }, &effects, crumpled);
                assert!(
                    least > 0.99 && far < 5e-5,
                    "nu = {poisson}, {effects:?}, {shift} m, seed {seed}: J {least:.3}, {far:.1e} m left"
                );
            }
            let [least, far] = left(Law::Isotropic, &effects, crumpled);
            eprintln!("springs alone, {effects:?}, {shift} m, seed {seed}: J {least:.3}, {far:.1e} m left");
        }
    }
}

/// One voxel from a mirrored, inside-out or crumpled state, down the slope of its energy in small steps: only springs alone stay inverted.
#[test]
fn one_voxel_turns_right_side_out() {
    // How rough, and the displacement over the place.
    let states = [(0.1, [0.0, 0.0, -2.0]), (0.1, [-2.0, -2.0, -2.0]), (1.4, [0.0; 3])];
    let rest = |whole: &Whole, start: &[V]| {
        let mut u = start.to_vec();
        // Below twice the inverse of the largest stiffness, which is of the order of (k_n + Λ + B) a.
        let stiffness = (1.0 + whole.stiffness.iter().sum::<f64>() / YOUNG) * YOUNG * f64::from(PITCH);
        for _ in 0..20_000 {
            let force = whole.force(&u);
            u.iter_mut().zip(&force).for_each(|(u, f)| *u += f * (0.1 / stiffness));
        }
        Whole::growth(&whole.voxels[0], &u)
    };
    for poisson in NUS {
        let mut block = block([1, 1, 1], poisson);
        block.release();
        let mut whole = Whole::new(&block, f64::from(poisson), YOUNG);
        let mut random = Random::new(11);
        for ((rough, state), seed) in states
            .into_iter()
            .flat_map(|state| [(state, 0), (state, 1), (state, 2)])
        {
            let half = 0.5 * f64::from(PITCH);
            block.impose(|place| core::array::from_fn(|axis| state[axis] * (place[axis] - half)));
            let mut u = wide(&block.tissue.displacement, block.lattice.len());
            for (node, _) in block.nodes() {
                u[node] += V::from_fn(|_, _| f64::from(random.next()) * rough * half);
            }
            let growth = rest(&whole, &u);
            assert!(growth > 0.9, "{poisson}, {rough} {seed}: {growth}");
            let inverted = rough < 1.0;
            if inverted && poisson < 0.26 {
                let barrier = core::mem::replace(&mut whole.stiffness[1], 0.0);
                assert!(rest(&whole, &u) < -0.9);
                whole.stiffness[1] = barrier;
            }
        }
    }
}

/// What the processor offers changes no bit, in either family of solvers.
#[test]
fn every_level_gives_the_same_bits() {
    let mut block = block([6, 5, 4], 0.45);
    shake(&mut block, 2e-3, 9);
    let start = block.tissue.clone();
    let explicit = Explicit { substeps: 40 };
    let solvers: [&dyn Solver<N>; 2] = [&TWENTY, &explicit];
    for solver in solvers {
        let mut ends = Vec::new();
        for level in Level::all() {
            block.tissue.clone_from(&start);
            for _ in 0..5 {
                let problem = Problem {
                    lattice: &block.lattice,
                    material: &block.material,
                    coupling: &Coupling::default(),
                    faces: None,
                    level,
                };
                solver.advance(&problem, &block.load, &mut block.tissue, &mut block.work);
            }
            assert!(block.is_finite());
            ends.push(block.tissue.clone());
        }
        assert!(ends.windows(2).all(|pair| pair[0] == pair[1]));
    }
}

/// The smallest stable count of substeps, of a block that is shaken a little for half a second: its energy goes.
#[test]
fn explicit_steps_are_stable_at_their_limit() {
    for poisson in NUS {
        let mut block = block([5, 5, 4], poisson);
        block.material.mass_damping = 50.0;
        shake(&mut block, 2e-5, 1);
        let mut counts = [0, 0];
        for (count, volume) in counts.iter_mut().zip([false, true]) {
            block.material.volume = volume;
            let problem = Problem {
                lattice: &block.lattice,
                material: &block.material,
                coupling: &Coupling::default(),
                faces: None,
                level: Level::best(),
            };
            *count = fewest_substeps(&problem, &mut block.work);
        }
        let [springs, substeps] = counts;
        for _ in 0..500 {
            let problem = Problem {
                lattice: &block.lattice,
                material: &block.material,
                coupling: &Coupling::default(),
                faces: None,
                level: Level::best(),
            };
            Explicit { substeps }.advance(&problem, &block.load, &mut block.tissue, &mut block.work);
        }
        eprintln!(
            "nu = {poisson}: {substeps} substeps, {springs} of the springs alone, {:.1e} m left",
            block.largest()
        );
        assert!(block.largest() < 1e-6);
    }
}
