//! The solver against the same springs solved apart in double precision: at rest under a load, and over one tick.

use super::block::{Block, Hold, Random, linear, scene};
use super::reference::{Before, Springs, V, error, wide};
use sutura_controller::math::Vec3;
use sutura_shared::scene::Law;

const YOUNG: f32 = 100e3;
/// Every solver with dials that a scene might have.
const SOLVERS: [&str; 4] = ["be-pcg:10", "be-chebyshev:10", "vbd:8:1.5", "explicit"];
/// Converged solvers of the backward Euler step, and the size of the motion over that of the full test: one Newton step leaves out how the
/// springs turn within the tick, which goes by the square of the motion.
const CONVERGED: [(&str, f32); 4] = [
    ("be-pcg:400:20", 1.0),
    ("vbd:600:1.7", 1.0),
    ("be-pcg:400:1", 1e-4),
    ("be-chebyshev:400", 1e-4),
];

fn pressed() -> (Block, Springs, Hold) {
    let block = Block::filled(&scene([8, 7, 5], Law::Isotropic, &[linear(YOUNG)], &[]));
    let springs = Springs::new(&block, Law::Isotropic, f64::from(YOUNG));
    let hold = Hold::on_top(&block, 2000.0, Vec3::new(3e-4, 1e-4, -6e-4));
    (block, springs, hold)
}

/// Pressed and dragged by 0.7 mm through a stiff spring until it rests.
#[test]
fn a_block_under_a_load_comes_to_rest_where_the_reference_does() {
    for name in SOLVERS {
        let (mut block, springs, hold) = pressed();
        block.material.mass_damping = 50.0;
        let solver = block.solver(name);
        for _ in 0..1500 {
            let coupling = hold.coupling(&block.tissue);
            block.tick(solver, &coupling, None);
        }
        let n = block.lattice.len();
        let rest = springs.solve(&vec![V::zeros(); n], &hold, None);
        let off = error(&wide(&block.tissue.displacement, n), &rest);
        eprintln!("{name}: static displacement off by {off:.2e} of the largest");
        assert!(off < 2e-4, "{name}: {off:e}");
    }
}

/// From a random state in motion, with a stiff spring that pulls.
#[test]
fn a_tick_is_the_backward_euler_step_of_the_reference() {
    for (name, size) in CONVERGED {
        for seed in 1..4 {
            let (mut block, springs, mut hold) = pressed();
            hold.anchor *= size;
            block.material.mass_damping = 50.0;
            let mut random = Random::new(seed);
            for (n, _) in block.nodes() {
                if block.lattice.free[n] > 0.0 {
                    for c in 0..3 {
                        block.tissue.displacement[c][n] = 5e-5 * size * random.next();
                        block.tissue.velocity[c][n] = 5e-2 * size * random.next();
                    }
                }
            }
            let n = block.lattice.len();
            let [displacement, velocity] =
                [&block.tissue.displacement, &block.tissue.velocity].map(|field| wide(field, n));
            let before = Before {
                displacement: &displacement,
                velocity: &velocity,
                damping: 50.0,
            };
            let expected = springs.solve(&displacement, &hold, Some(&before));
            let step = |after: &[V]| -> Vec<V> { after.iter().zip(&displacement).map(|(a, b)| a - b).collect() };
            let coupling = hold.coupling(&block.tissue);
            let solver = block.solver(name);
            block.tick(solver, &coupling, None);
            let off = error(&step(&wide(&block.tissue.displacement, n)), &step(&expected));
            eprintln!("{name}, seed {seed}: step off by {off:.2e} of the largest");
            assert!(off < 1e-4, "{name}, seed {seed}: {off:e}");
        }
    }
}
