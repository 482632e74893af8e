//! What holds for every solver alike.

use super::block::{Block, Hold, PITCH, Random, scene, stiffening};
use sutura_controller::lanes::Level;
use sutura_controller::lattice::Field;
use sutura_controller::math::Vec3;
use sutura_controller::wound::{self, Faces};
use sutura_shared::scene::{Effect, Law, Wound};

const SOLVERS: [&str; 4] = ["explicit", "be-pcg:6:2", "be-chebyshev:7", "vbd:3:1.5"];

/// A cut block of stiffening springs with dashpots, out of place and in motion, and its wound half shut.
fn torn(level: Level) -> (Block, Faces) {
    let tissue = stiffening(&[(0.0, 50e3), (0.03, 200e3), (0.06, 500e3)]);
    let effects = [Effect::Stiffening, Effect::SpringDamping, Effect::WoundContact];
    let mut scene = scene([9, 6, 4], Law::Isotropic, &[tissue], &effects);
    scene.lattice.damping_per_s = 50.0;
    scene.lattice.spring_damping_s = 1e-4;
    let wound = Wound {
        faces: [4, 5],
        rows: [1, 5],
        floor: 2,
        penalty_n_per_m: 2000.0,
    };
    scene.wound = Some(wound);
    let missing = |n: usize| n % 9 == 4 && (1..5).contains(&(n / 9 % 6)) && n / 54 >= 2;
    let cells: Vec<u8> = (0..scene.lattice.count()).map(|n| u8::from(!missing(n))).collect();
    let mut block = Block::new(&scene, &cells);
    block.level = level;
    let faces = wound::faces(scene.wound.as_ref().unwrap(), None, &block.lattice).unwrap();
    let mut random = Random::new(3);
    for (n, [i, ..]) in block.nodes() {
        if block.lattice.free[n] > 0.0 {
            let shut = if i <= 4 { 0.5 } else { -0.5 };
            block.tissue.displacement[0][n] = PITCH * (shut + 0.1 * random.next());
            for c in 0..3 {
                block.tissue.displacement[c][n] += 0.02 * PITCH * random.next();
                block.tissue.velocity[c][n] = 0.05 * random.next();
            }
        }
    }
    (block, faces)
}

fn bits<const N: usize>(field: &Field<N>) -> Vec<u32> {
    field.iter().flatten().map(|x| x.to_bits()).collect()
}

/// The instructions that the passes run on change their time and not one bit.
#[test]
fn every_level_gives_the_same_bits() {
    for name in SOLVERS {
        let ends = Level::all().map(|level| {
            let (mut block, faces) = torn(level);
            let solver = block.solver(name);
            let hold = Hold::within(&block, 2.5 * PITCH, 15e3, Vec3::new(1e-3, 0.0, -1e-3));
            for _ in 0..20 {
                let coupling = hold.coupling(&block.tissue);
                block.tick(solver, &coupling, Some(&faces));
            }
            assert!(block.is_finite() && block.largest() > 1e-4, "{name} {}", level.name());
            (
                level.name(),
                bits(&block.tissue.displacement),
                bits(&block.tissue.velocity),
            )
        });
        let ends: Vec<_> = ends.collect();
        let (_, place, velocity) = &ends[0];
        for (level_name, other_place, other_velocity) in &ends {
            assert!(
                place == other_place && velocity == other_velocity,
                "{name}: {level_name} differs"
            );
        }
    }
}
