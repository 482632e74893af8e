//! The solver against the same springs solved apart in double precision: at rest under a load, and over one tick.

use super::block::{Block, CONVERGED, DEFAULT, Hold, Random, linear, scene};
use super::reference::{Before, Springs, V, error, wide};
use sutura_controller::math::Vec3;
use sutura_shared::scene::Law;

const YOUNG: f32 = 100e3;

fn pressed() -> (Block, Springs, Hold) {
    let block = Block::filled(&scene([8, 7, 5], Law::Isotropic, &[linear(YOUNG)], &[]));
    let springs = Springs::new(&block, Law::Isotropic, f64::from(YOUNG));
    let hold = Hold::on_top(&block, 2000.0, Vec3::new(3e-4, 1e-4, -6e-4));
    (block, springs, hold)
}

/// Pressed and dragged by 0.7 mm through a stiff spring until it rests.
#[test]
fn a_block_under_a_load_comes_to_rest_where_the_reference_does() {
    let (mut block, springs, hold) = pressed();
    block.material.mass_damping = 50.0;
    for _ in 0..1500 {
        let coupling = hold.coupling(&block.tissue);
        block.tick(DEFAULT, &coupling, None);
    }
    let n = block.lattice.len();
    let rest = springs.solve(&vec![V::zeros(); n], &hold, None);
    let off = error(&wide(&block.tissue.displacement, n), &rest);
    eprintln!("static displacement off by {off:.2e} of the largest");
    assert!(off < 2e-4, "{off:e}");
}

/// From a random state in motion, with a stiff spring that pulls.
#[test]
fn a_tick_is_the_backward_euler_step_of_the_reference() {
    for seed in 1..4 {
        let (mut block, springs, hold) = pressed();
        block.material.mass_damping = 50.0;
        let mut random = Random::new(seed);
        for (n, _) in block.nodes() {
            if block.lattice.free[n] > 0.0 {
                for c in 0..3 {
                    block.tissue.displacement[c][n] = 5e-5 * random.next();
                    block.tissue.velocity[c][n] = 5e-2 * random.next();
                }
            }
        }
        let n = block.lattice.len();
        let [displacement, velocity] = [&block.tissue.displacement, &block.tissue.velocity].map(|field| wide(field, n));
        let before = Before {
            displacement: &displacement,
            velocity: &velocity,
            damping: 50.0,
        };
        let expected = springs.solve(&displacement, &hold, Some(&before));
        let step = |after: &[V]| -> Vec<V> { after.iter().zip(&displacement).map(|(a, b)| a - b).collect() };
        let coupling = hold.coupling(&block.tissue);
        let start = block.tissue.clone();
        let mut off = Vec::new();
        for solver in [CONVERGED, DEFAULT] {
            block.tissue.clone_from(&start);
            block.tick(solver, &coupling, None);
            off.push(error(&step(&wide(&block.tissue.displacement, n)), &step(&expected)));
        }
        eprintln!(
            "step off by {:.2e} of the largest; with the scenes' own dials {:.2e}",
            off[0], off[1]
        );
        assert!(off[0] < 1e-4, "seed {seed}: {:e}", off[0]);
    }
}
