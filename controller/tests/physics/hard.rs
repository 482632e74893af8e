//! Hard cases: whatever happens, the tissue stays finite and comes back to rest.

use super::block::{Block, DEFAULT, Hold, PITCH, Random, scene, stiffening};
use sutura_controller::coupling::Coupling;
use sutura_controller::math::Vec3;
use sutura_controller::solver::Choice;
use sutura_shared::scene::{Effect, Law};

const YOUNGS: [f32; 3] = [20e3, 200e3, 2e6];
/// The implicit solvers, as scenes have them.
const SOLVERS: [&str; 3] = ["be-pcg:10", "be-chebyshev:10", "vbd:8:1.5"];

/// A patch held at its sides and bottom, slopes 1 : 4 : 10 with breaks at 3 % and 6 %.
fn patch(young: f32) -> Block {
    let tissue = stiffening(&[(0.0, young), (0.03, 4.0 * young), (0.06, 10.0 * young)]);
    let mut scene = scene([8, 8, 5], Law::Isotropic, &[tissue], &[Effect::Stiffening]);
    scene.lattice.damping_per_s = 50.0;
    Block::filled(&scene)
}

/// Lets the block go for a second; the displacement left [m].
fn left_after_a_second(block: &mut Block, solver: Choice) -> f32 {
    for _ in 0..1000 {
        block.tick(solver, &Coupling::default(), None);
        assert!(block.is_finite());
    }
    block.largest()
}

/// A blow that presses the tip into the tissue, drags it or lifts it, by up to ten voxels for 50 ms.
#[test]
fn a_tool_that_jumps_away_and_back_leaves_the_tissue_at_rest() {
    let jumps = [
        (5e-3, -Vec3::z()),
        (10e-3, -Vec3::z()),
        (20e-3, -Vec3::z()),
        (20e-3, Vec3::x()),
        (20e-3, Vec3::z()),
    ];
    let youngs = [20e3, 100e3, 281e3, 500e3, 1e6, 2e6];
    for (name, young) in SOLVERS.into_iter().flat_map(|name| youngs.map(|young| (name, young))) {
        for (far, direction) in jumps {
            let mut block = patch(young);
            let solver = block.solver(name);
            let mut hold = Hold::on_top(&block, 1000.0, Vec3::zeros());
            for tick in 0..100 {
                hold.anchor = if tick < 50 { direction * far } else { Vec3::zeros() };
                let coupling = hold.coupling(&block.tissue);
                block.tick(solver, &coupling, None);
                assert!(block.is_finite(), "{name}, {young} Pa, tick {tick}");
            }
            let left = left_after_a_second(&mut block, solver);
            assert!(
                left < 5e-5,
                "{name}, {young} Pa, {far} m along {:?}: {left} m",
                direction.as_slice()
            );
        }
    }
}

/// Skin on muscle under the tip's kernel of the built-in scenes, pressed at 8 mm/s until the skin would give way.
#[test]
fn a_tip_pressed_to_f0_inverts_no_voxel() {
    let skin = stiffening(&[(0.0, 281e3), (0.3, 1.7e6), (0.6, 3.66e6)]);
    let muscle = stiffening(&[(0.0, 26e3), (0.1, 43e3), (0.2, 70e3), (0.3, 117e3), (0.4, 192e3)]);
    let mut scene = scene([14, 12, 6], Law::Isotropic, &[skin, muscle], &[Effect::Stiffening]);
    scene.lattice.damping_per_s = 50.0;
    let cells: Vec<u8> = (0..14 * 12 * 6)
        .map(|n| if n / (14 * 12) == 5 { 1 } else { 2 })
        .collect();
    let mut block = Block::new(&scene, &cells);
    let mut hold = Hold::within(&block, 1.75 * PITCH, 1000.0, Vec3::zeros());
    let mut least = 1.0_f32;
    let mut pull = Vec3::zeros();
    while pull.norm() < 0.95 {
        hold.anchor.z -= 8e-6;
        assert!(hold.anchor.z > -0.01, "{} N only", pull.norm());
        let coupling = hold.coupling(&block.tissue);
        block.tick(DEFAULT, &coupling, None);
        pull = hold.pull(&block.tissue);
        least = least.min(block.least_volume());
    }
    let depth = pull.norm() / hold.stiffness + hold.anchor.z;
    eprintln!(
        "0.95 N: skin {:.2} mm down, the worst corner keeps {least:.2} of its volume",
        -1e3 * depth
    );
    assert!(least > 0.0, "{least}");
}

#[test]
fn tissue_with_every_node_out_of_place_comes_back() {
    for (name, young) in SOLVERS.into_iter().flat_map(|name| YOUNGS.map(|young| (name, young))) {
        for seed in 1..4 {
            let mut block = patch(young);
            let solver = block.solver(name);
            let mut random = Random::new(seed);
            for (n, _) in block.nodes() {
                for c in 0..3 {
                    block.tissue.displacement[c][n] = 1e-3 * random.next() * block.lattice.free[n];
                }
            }
            let left = left_after_a_second(&mut block, solver);
            eprintln!("crumpled, {name}, {young:e} Pa, seed {seed}: {left:.1e} m left");
            assert!(left < 5e-5, "{name}, {young} Pa, seed {seed}: {left} m");
        }
    }
}

/// Subnormal numbers cost a hundred times the time of others.
#[test]
fn tissue_at_rest_holds_no_subnormal_number() {
    for young in YOUNGS {
        let mut block = patch(young);
        let hold = Hold::on_top(&block, 1000.0, Vec3::new(5e-4, 0.0, -1e-3));
        for _ in 0..50 {
            let coupling = hold.coupling(&block.tissue);
            block.tick(DEFAULT, &coupling, None);
        }
        for tick in 0..2000 {
            block.tick(DEFAULT, &Coupling::default(), None);
            let fields = [&block.tissue.displacement, &block.tissue.velocity];
            let subnormal = fields
                .into_iter()
                .flatten()
                .flatten()
                .filter(|x| x.is_subnormal())
                .count();
            assert!(subnormal == 0, "{young} Pa: {subnormal} after {tick} ticks");
        }
    }
}
