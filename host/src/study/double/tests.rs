//! The model against closed forms and against itself.

use super::*;
use crate::study::block::{Block, Spec};
use sutura_shared::scene::{Assembly, Law};

const SPEC: Spec = Spec {
    nodes: [6, 5, 4],
    pitch_m: 2e-3,
    young_pa: 1e5,
    density_kg_m3: 1000.0,
    law: Law::Paper,
    assembly: Assembly::EveryEdge,
    stiffening: true,
    damping_per_s: 50.0,
};

/// The same with an energy of volume.
const SWELLING: Spec = Spec {
    law: Law::Volume { poisson: 0.45 },
    assembly: Assembly::PerVoxel,
    ..SPEC
};

/// A displacement that inverts voxels [m].
const INVERTING: f64 = 3e-3;

fn model(spec: &Spec) -> Model {
    let mut block = Block::new(spec).unwrap();
    block.hold_bottom();
    Model::new(&block.lattice, &block.material)
}

/// Numbers from −1 to 1 without a pattern.
fn rough(n: usize, scale: f64) -> Field {
    let mut field = Field::zeros(n);
    for (axis, part) in field.parts.iter_mut().enumerate() {
        for (node, value) in part.iter_mut().enumerate() {
            *value = scale * ((node * 3 + axis + 1) as f64 * 12.9898).sin();
        }
    }
    field
}

/// Force and energy belong together: f · δ = −(E(u + δ) − E(u − δ))/2 for a small δ.
#[test]
fn the_force_is_the_slope_of_the_energy() {
    for (spec, scale) in [(SPEC, 2e-4), (SWELLING, 2e-4), (SWELLING, INVERTING)] {
        check_force(&model(&spec), scale);
    }
}

fn check_force(model: &Model, scale: f64) {
    let (at, delta) = (rough(model.len(), scale), rough(model.len(), 1e-8));
    let [mut force, mut scratch] = [0; 2].map(|_| Field::zeros(model.len()));
    model.elastic(&at, &mut force);
    let mut energy = |sign: f64| {
        let mut there = at.clone();
        there.blend(1.0, sign, &delta);
        model.elastic(&there, &mut scratch)
    };
    let work = -0.5 * (energy(1.0) - energy(-1.0));
    assert!((force.dot(&delta) / work - 1.0).abs() < 1e-5, "{work}");
}

/// K δ = f(u − δ/2) − f(u + δ/2) for a small δ that carries no spring across a breakpoint.
#[test]
fn the_tangent_is_the_slope_of_the_force() {
    for (spec, scale) in [(SPEC, 2e-4), (SWELLING, 2e-4), (SWELLING, INVERTING)] {
        check_tangent(&model(&spec), scale);
    }
}

fn check_tangent(model: &Model, scale: f64) {
    let (at, delta) = (rough(model.len(), scale), rough(model.len(), 1e-9));
    let [mut low, mut high, mut product] = [0; 3].map(|_| Field::zeros(model.len()));
    for (sign, force) in [(-0.5, &mut low), (0.5, &mut high)] {
        let mut there = at.clone();
        there.blend(1.0, sign, &delta);
        model.elastic(&there, force);
    }
    low.blend(1.0, -1.0, &high);
    low.clear_held(&model.free);
    tangent::Tangent::new(model, &at, 0.0, tangent::Form::Exact).apply(&delta, &mut product);
    product.clear_held(&model.free);
    product.blend(1.0, -1.0, &low);
    assert!(product.largest() < 1e-5 * low.largest());
}

/// The reaction of one node is what the whole pass gives there.
#[test]
fn a_reaction_is_the_force_on_its_node() {
    let model = model(&SWELLING);
    let at = rough(model.len(), 3e-4);
    let mut force = Field::zeros(model.len());
    model.elastic(&at, &mut force);
    for node in [0, 17, 63, 119] {
        assert!((model.reaction(node, |n| at.get(n)) - force.get(node)).norm() < 1e-12);
    }
}

/// Backward Euler leaves m (v⁺ − v)/dt = f(x⁺) − α m v⁺ at the free nodes.
#[test]
fn a_tick_of_backward_euler_satisfies_its_equation() {
    let mut model = model(&SPEC);
    model.free.iter_mut().for_each(|free| free[100] = false);
    let mut march = March::new(&model);
    let moved = |place| Moved { node: 100, place };
    march.backward_euler(moved(V::new(0.0, 0.0, 2e-4))).unwrap();
    let x = march.displacement.clone();
    march.backward_euler(moved(V::new(1e-4, 0.0, 5e-4))).unwrap();
    let mut force = Field::zeros(model.len());
    model.elastic(&march.displacement, &mut force);
    for node in (0..model.len()).filter(|node| model.moves(*node) && *node != 100) {
        let after = (march.displacement.get(node) - x.get(node)) / 1e-3;
        // The first tick began at rest.
        let before = x.get(node) / 1e-3;
        let inertia = ((after - before) / 1e-3 + after * 50.0) * model.mass[node];
        assert!((force.get(node) - inertia).norm() < 1e-9);
    }
}

/// A mass on one spring: ω² = k/m.
#[test]
fn the_fastest_vibration_of_one_spring_is_its_own() {
    let spec = Spec {
        nodes: [2, 2, 2],
        assembly: Assembly::PerVoxel,
        stiffening: false,
        ..SPEC
    };
    let mut model = model(&spec);
    // Upright edges only.
    for (direction, family) in model.families.iter_mut().enumerate() {
        if direction != 2 {
            family.stiffness.fill(0.0);
        }
    }
    let mass = model.mass.iter().copied().fold(0.0, f64::max);
    let expected = (0.25 * 0.45 * 1e5 * 2e-3 / mass).sqrt();
    assert!((model.fastest() / expected - 1.0).abs() < 1e-5);
}

/// Moved so slowly that inertia is nothing, both schemes give the same reaction.
#[test]
fn a_slow_lift_is_the_same_in_both_schemes() {
    let mut model = model(&SPEC);
    let node = 100;
    model.free.iter_mut().for_each(|free| free[node] = false);
    let reaction = |substeps: Option<u32>| {
        let mut march = March::new(&model);
        for tick in 1..=200 {
            let moved = Moved {
                node,
                place: V::new(0.0, 0.0, 1e-6 * f64::from(tick)),
            };
            match substeps {
                Some(substeps) => march.symplectic_euler(moved, substeps),
                None => march.backward_euler(moved).unwrap(),
            }
        }
        model.reaction(node, |n| march.displacement.get(n))
    };
    let (explicit, implicit) = (reaction(Some(40)), reaction(None));
    assert!(
        (explicit - implicit).norm() < 5e-3 * implicit.norm(),
        "{explicit} {implicit}"
    );
}
