//! A bar pulled, a block sheared and a beam bent, against Hooke and Timoshenko.

use super::block::{Block, PITCH, apart, linear, scene};
use super::reference::DT;
use sutura_controller::coupling::Coupling;
use sutura_controller::lattice::at;
use sutura_controller::solver::BePcg;
use sutura_shared::scene::Law;

const YOUNG: f64 = 100e3;

/// Share of an even traction on a face across `axis` that a node of the face carries.
fn share(nodes: [u32; 3], node: [u32; 3], axis: usize) -> f64 {
    let along = (0..3).filter(|a| *a != axis).map(|a| {
        let rim = node[a] == 0 || node[a] + 1 == nodes[a];
        (if rim { 0.5 } else { 1.0 }) / f64::from(nodes[a] - 1)
    });
    along.product()
}

/// Nodes of the lower or upper face across `axis`, with their share of it.
fn face(block: &Block, axis: usize, upper: bool) -> Vec<(usize, f64)> {
    let nodes = block.lattice.nodes;
    let layer = if upper { nodes[axis] - 1 } else { 0 };
    let of = block.nodes().filter(|(_, node)| node[axis] == layer);
    of.map(|(n, node)| (n, share(nodes, node, axis))).collect()
}

/// Mean displacement of a face along `component` [m].
fn mean(block: &Block, face: &[(usize, f64)], component: usize) -> f64 {
    face.iter()
        .map(|(n, share)| share * f64::from(block.tissue.displacement[component][*n]))
        .sum()
}

/// Ticks until no node moves by more than `still` of the largest displacement in one.
fn settle(block: &mut Block, iterations: u16, still: f64) {
    let solver = BePcg { iterations, newton: 1 };
    let moves = |block: &Block| {
        let speeds = block.nodes().map(|(n, _)| at(&block.tissue.velocity, n).norm());
        DT * f64::from(speeds.fold(0.0, f32::max)) > still * f64::from(block.largest())
    };
    block.tick(solver, &Coupling::default(), None);
    for _ in 0..1000 {
        if !moves(block) {
            return;
        }
        block.tick(solver, &Coupling::default(), None);
    }
    panic!("the block does not come to rest");
}

/// Strains of a free bar of `cells` voxels along x, y and z under `force` [N] at both ends of z.
fn strains(cells: [u16; 3], law: Law, force: f64) -> [f64; 3] {
    let mut block = Block::filled(&scene(cells, law, &[linear(YOUNG as f32)], &[]));
    block.release();
    // Nothing holds the bar: what the loads' rounding leaves of a force may not carry it off.
    block.material.mass_damping = 100.0;
    for (upper, pull) in [(true, force), (false, -force)] {
        for (n, share) in face(&block, 2, upper) {
            block.load[2][n] = (share * pull) as f32;
        }
    }
    settle(&mut block, 200, 1e-6);
    [0, 1, 2].map(|axis| {
        let [low, high] = [false, true].map(|upper| mean(&block, &face(&block, axis, upper), axis));
        (high - low) / (f64::from(cells[axis]) * f64::from(PITCH))
    })
}

/// F = E A ε, and the sides narrow by ν ε. Two pulls extrapolate to none, where the lattice is linear; single precision leaves less than
/// 1e-5.
///
/// The pulls are slight, for a free bar slips: edges across the pull are compressed, and nothing else keeps columns of even i + j
/// from sliding along those of odd.
#[test]
fn a_bar_stretches_by_young_and_narrows_by_poisson() {
    let cells = [3, 2, 8];
    let area = 6.0 * f64::from(PITCH).powi(2);
    for (law, poisson) in [(Law::Isotropic, 0.25), (Law::Axial, 0.224_744_871)] {
        let [pull, twice] = [1.0, 2.0].map(|pull| strains(cells, law, pull * 1e-5 * YOUNG * area));
        let [x, y, z] = [0, 1, 2].map(|axis| 2.0 * pull[axis] - 0.5 * twice[axis]);
        let young = 1e-5 * YOUNG / z;
        eprintln!("{law:?}: E {young:.2} Pa, nu {:.6} and {:.6}", -x / z, -y / z);
        assert!(apart(young, YOUNG) < 1e-5, "{law:?}: {young}");
        for across in [x, y] {
            assert!(apart(-across / z, poisson) < 1e-5, "{law:?}: {across} of {z}");
        }
    }
}

/// Every node follows u = γ z: F = G γ A, G = 4k_d/(3a). The springs' turning adds some γ² to it.
#[test]
fn a_block_in_simple_shear_pulls_with_g() {
    for (law, shear) in [(Law::Isotropic, 0.4), (Law::Axial, 1.0 / 3.0)] {
        let mut block = Block::filled(&scene([4, 3, 5], law, &[linear(YOUNG as f32)], &[]));
        for gamma in [1e-4, 1e-3] {
            block.impose(|[_, _, z]| [gamma * z, 0.0, 0.0]);
            let [force, ..] = block.pull(2);
            let expected = shear * YOUNG * gamma * 12.0 * f64::from(PITCH).powi(2);
            eprintln!("{law:?} {gamma}: off by {:.2e}", apart(force, expected));
            assert!(apart(force, expected) < 1e-5, "{law:?} {gamma}: {force} for {expected}");
        }
    }
}

/// Deflection under a load on the end of a cantilever two voxels wide and eight times as long as it is high, and what
/// Timoshenko's beam has of it by bending, P L³/(3 E I), and by shear, P L/(κ G A) with κ = 10(1 + ν)/(12 + 11ν) [m].
///
/// So stiff a solid rests within tens of ticks.
fn cantilever(height: u16) -> [f64; 3] {
    let (young, poisson) = (1e9, 0.25);
    let cells = [2, height, 8 * height];
    let [width, thick, length] = cells.map(|n| f64::from(n) * f64::from(PITCH));
    let mut block = Block::filled(&scene(cells, Law::Isotropic, &[linear(young as f32)], &[]));
    block.release();
    for (n, _) in face(&block, 2, false) {
        block.lattice.free[n] = 0.0;
    }
    let rigidity = young * width * thick.powi(3) / 12.0;
    let load = 3e-3 * rigidity / (length * length);
    let end = face(&block, 2, true);
    for (n, share) in &end {
        block.load[1][*n] = (share * load) as f32;
    }
    settle(&mut block, 1000, 1e-5);
    let kappa = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson);
    let shear = load * length / (kappa * young / (2.0 * (1.0 + poisson)) * width * thick);
    [mean(&block, &end, 1), load * length.powi(3) / (3.0 * rigidity), shear]
}

/// Fibres lumped at the nodes give a beam of h voxels 1 + 2/h² of its second moment, so its bending is as much stiffer, by
/// the second order of 1/h.
#[test]
fn a_cantilever_bends_as_timoshenko_says_of_lumped_fibres() {
    let stiffness = [2, 4, 6, 8].map(|height| {
        let [deflection, bending, shear] = cantilever(height);
        let lumped = bending / (1.0 + 2.0 / f64::from(height * height));
        eprintln!(
            "{height} voxels: {:.4} of Timoshenko, {:.4} with lumped fibres",
            deflection / (bending + shear),
            deflection / (lumped + shear)
        );
        if height >= 6 {
            assert!(apart(deflection, lumped + shear) < 0.05, "{height}: {deflection}");
        }
        bending / (deflection - shear)
    });
    let [two, four, _, eight] = stiffness;
    let order = ((two - four) / (four - eight)).log2();
    eprintln!("bending stiffness {stiffness:.4?}, order {order:.2}");
    assert!((order - 2.0).abs() < 0.2, "{order}");
}
