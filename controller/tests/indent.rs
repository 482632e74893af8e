//! Indentation to the puncture force: the depth does not depend on the pitch, and no voxel inverts on the way.

mod common;

use common::{inverted, memory, scene};
use sutura_controller::coupling::Coupling;
use sutura_controller::lattice::PC_NODES;
use sutura_controller::math::{Mat3, Pose, Vec3};
use sutura_controller::needle::{self, Arc, Params};
use sutura_controller::solver::{BePcg, Problem, Solver};
use sutura_controller::tissue;

/// Presses the tip along the nominal arc's entry tangent at 8 mm/s until the puncture; gives its depth.
fn depth_at_f0(cells: [u16; 3], pitch: f32, gap: u16) -> f32 {
    let (scene, bytes) = scene(cells, pitch, gap, (18e-3 / pitch) as u16);
    let (mut lattice, mut tissue, mut work) = memory();
    let material = tissue::assemble(&scene, &bytes, &mut lattice).unwrap();
    let params = Params::new(&scene);
    let mut state = needle::State::default();
    let faces = tissue::faces(&scene, &lattice);
    let site = scene.stitch.unwrap().right_m[0];
    let radius = 0.026 / std::f32::consts::PI;
    let load = Box::new([[0.0; PC_NODES]; 3]);
    let centre = Vec3::new(0.0, 0.0, (radius * radius - site * site).sqrt());
    let entry = Vec3::new(-site, 0.0, 0.0);
    let along = Vec3::new(centre.z, 0.0, -site) / radius;
    let out = (entry - centre) / radius;
    // Tip angle ahead of the grasp point: 2L/3R = 2π/3.
    let turn = -2.0 * std::f32::consts::FRAC_PI_3;
    let axis = Vec3::new(0.0, -1.0, 0.0);
    let back = sutura_controller::math::rotation(axis, turn);
    let (x, y) = (back * out, back * along);
    let rotation = Mat3::from_columns(&[x, y, x.cross(&y)]);
    for tick in 0..2000 {
        let pushed = along * (8e-3 * 1e-3 * tick as f32 - 0.5e-3);
        let arc = Arc::new(
            scene.tool,
            Pose {
                position: centre + x * radius + pushed,
                rotation,
            },
        );
        needle::detect(&params, &mut state, &arc, &lattice, &tissue);
        let mut coupling = Coupling::default();
        let holds = needle::couple(&params, &mut state, &arc, &tissue, &mut coupling);
        let problem = Problem {
            lattice: &lattice,
            material: &material,
            coupling: &coupling,
            faces: faces.as_ref(),
        };
        let moved = BePcg {
            iterations: 10,
            newton: 1,
        }
        .advance(&problem, &load, &mut tissue, &mut work);
        let grip = needle::settle(&params, &mut state, &arc, (&holds, &moved), &tissue);
        assert_eq!(inverted(&lattice, &tissue, cells, &bytes), 0, "tick {tick}");

        if let Some(puncture) = grip.puncture {
            assert!((puncture.force / puncture.f0 - 1.0).abs() < 0.03);
            return puncture.depth;
        }
    }
    panic!("no puncture");
}

#[test]
fn the_depth_at_f0_does_not_depend_on_the_pitch() {
    let coarse = depth_at_f0([20, 15, 6], 2e-3, 2);
    let fine = depth_at_f0([27, 20, 8], 1.5e-3, 3);
    eprintln!(
        "depth at F0: {:.2} mm at 2 mm, {:.2} mm at 1.5 mm",
        coarse * 1e3,
        fine * 1e3
    );
    assert!((fine / coarse - 1.0).abs() < 0.15);
}
