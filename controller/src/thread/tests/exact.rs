//! What must hold to rounding: Eq. 11, the Jacobian, the condensation.

use super::super::chain::{Chain, Forces};
use super::super::contact::press;
use super::super::link::{Piece, plain};
use super::behaviour::{NONE, ONE, TWO, TWO_IN_A_LINK};
use super::*;
use crate::math::length;

/// F = Δl / Σ 1/k_i with Σ 1/k_i = 1/1000 + 1/3000 + 1/6000 = 1.5 mm/N: 3 mm pull with 2 N.
#[test]
fn eq_11_is_springs_in_series() {
    let compliance = [1000.0_f32, 3000.0, 6000.0].iter().map(|k| 1.0 / k).sum();
    let elongation = [0.5e-3_f32, 1.5e-3, 1.0e-3].iter().sum();
    assert!((eq11(1.0, elongation, compliance) / 2.0 - 1.0).abs() < 1e-6);
    assert!((eq11(2.5, elongation, compliance) / 5.0 - 1.0).abs() < 1e-6);
    assert_eq!(eq11(1.0, -elongation, compliance).to_bits(), 0.0_f32.to_bits());
}

/// EA (l/l₀ − 1) of a straight thread, a decimetre and more from the origin: 2e-4 from 0.1 N up.
#[test]
fn eq_11_from_positions_is_the_tension_of_a_straight_thread() {
    let params = params(40, 0.005, &[]);
    for tension in [0.1_f64, 0.3, 1.0, 3.0] {
        let from = Vec3::new(0.11, -0.07, 0.13);
        let way = [2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0];
        let mut state = State::laid(&params, from, from + Vec3::x(), Vec3::z());
        for (i, node) in state.nodes.iter_mut().enumerate().take(40) {
            let s = 0.005 * (1.0 + tension / 76.0) * i as f64;
            *node = Place::new(Vec3::from_iterator(
                (0..3).map(|r| (f64::from(from[r]) + way[r] * s) as f32),
            ));
        }
        let pull = super::super::pull::pull(&params, &state, None);
        assert!(
            (f64::from(pull.tension) / tension - 1.0).abs() < 2e-4,
            "{} of {tension}",
            pull.tension
        );
    }
}

/// A chain's first `n` points as one vector of forces and one matrix.
fn dense(forces: &Forces, n: usize) -> (Vec<f32>, Vec<Vec<f32>>) {
    let row = |r: usize| (0..3 * n).map(|c| forces.block(r / 3, c / 3)[(r % 3, c % 3)]).collect();
    let on = (0..3 * n).map(|r| forces.on[r / 3][r % 3]).collect();
    (on, (0..3 * n).map(row).collect())
}

/// Central differences with h = 20 µm: rounding of lengths (0.2 nm · 15 kN/m / 2h) and the third derivative (k h²/6l²) leave
/// about 1e-5 of k; 1e-4 is allowed.
fn against_differences(name: &str, k: f32, points: &[Vec3], forces: impl Fn(&[Vec3]) -> Forces) {
    let h = 2e-5;
    let n = points.len();
    let (_, matrix) = dense(&forces(points), n);
    for c in 0..3 * n {
        let moved = |by: f32| {
            let mut points = points.to_vec();
            points[c / 3][c % 3] += by;
            dense(&forces(&points), n).0
        };
        let (plus, minus) = (moved(h), moved(-h));
        for r in 0..3 * n {
            let difference = (minus[r] - plus[r]) / (2.0 * h);
            assert!(
                (difference - matrix[r][c]).abs() < 1e-4 * k,
                "{name} ({r}, {c}): {} and {difference}",
                matrix[r][c]
            );
        }
    }
}

/// The one link of a thread through these points.
fn chain(points: &[Vec3]) -> Chain {
    let mut nodes = [Place::default(); NODES_MAX];
    let (a, b) = (points[0], points[points.len() - 1]);
    (nodes[0], nodes[1]) = (Place::new(a), Place::new(b));
    let mut course = Course::default();
    for (eyelet, place) in course.eyelets.iter_mut().zip(points[1..points.len() - 1].iter().rev()) {
        eyelet.place = Place::new(*place);
        course.count += 1;
    }
    Chain::new((&nodes, 2), &course, 0, 0..course.count)
}

#[test]
fn the_jacobian_agrees_with_central_differences() {
    let params = params(40, 0.005, &[]);
    let k = params.stiffness();
    let a = Vec3::new(1.0e-3, 2.5e-3, 2.2e-3);
    let b = Vec3::new(-1.5e-3, 0.5e-3, -1.8e-3);
    let (p, q) = (Vec3::new(0.1e-3, 0.2e-3, 0.3e-3), Vec3::new(-2.0e-3, 2.6e-3, -1.2e-3));
    against_differences("plain", k, &[a, b], |points| {
        let link = plain(&params, points[1] - points[0], 0.0);
        let mut forces = Forces::default();
        (forces.on[0], forces.on[1]) = (link.on_a, -link.on_a);
        (forces.blocks[0][0], forces.blocks[1][1]) = (link.block, link.block);
        (forces.blocks[0][1], forces.blocks[1][0]) = (-link.block, -link.block);
        forces
    });
    let longer = super::params(40, 0.008, &[]);
    let chains = [
        ("one eyelet", vec![a, p, b], params, None),
        ("knot", vec![a, p, b], params, Some([2.5e-3; 2])),
        ("two eyelets", vec![a, p, q, b], longer, None),
        ("knot and eyelet", vec![a, p, q, b], longer, Some([2.8e-3, 5.2e-3])),
    ];
    for (name, points, params, knot) in chains {
        against_differences(name, 2.0 * k, &points, |points| {
            let chain = chain(points);
            chain.forces(&chain.strain(&params, 0.0, knot))
        });
    }
    let touch = Touch {
        gap: -1e-3,
        normal: Vec3::new(2.0, 3.0, 6.0) / 7.0,
    };
    against_differences("ground", 200.0, &[a], |points| {
        let (on_a, aa) = press(&touch, 200.0, points[0] * 0.1);
        let mut forces = Forces::default();
        (forces.on[0], forces.blocks[0][0]) = (on_a, aa * 0.1);
        forces
    });
}

/// Eyelets that meet: length and gradient of the piece between them are the antiderivatives of its gradient and its bend, and have no
/// step where the rounding begins.
#[test]
fn the_piece_between_two_eyelets_is_smooth_as_they_meet() {
    let way = Vec3::new(3.0, 0.0, 4.0) / 5.0;
    let (inside, outside) = (Piece::between(way * 0.999_99e-4), Piece::between(way * 1.000_01e-4));
    assert!((outside.length - inside.length).abs() < 1e-8 && length(outside.along - inside.along) < 1e-4);
    let (d, h) = (Vec3::new(2e-5, 1e-5, 3e-5), 1e-5);
    for c in 0..3 {
        let mut step = Vec3::zeros();
        step[c] = h;
        let (plus, minus) = (Piece::between(d + step), Piece::between(d - step));
        let piece = Piece::between(d);
        assert!(((plus.length - minus.length) / (2.0 * h) - piece.along[c]).abs() < 1e-4);
        assert!(length((plus.along - minus.along) / (2.0 * h) - piece.bend.column(c)) < 1e-3 * piece.bend.abs().max());
    }
}

/// A node within a tenth of a millimetre of the eyelet: the tangent is given, and the piece keeps its Jacobian, also where its
/// length is below zero.
#[test]
fn the_jacobian_at_the_eyelet_agrees_with_central_differences() {
    let tangent = Vec3::new(3.0, 0.0, 4.0) / 5.0;
    let h = 1e-5;
    for d in [Vec3::new(2e-5, 1e-5, 3e-5), Vec3::new(-3e-5, 1e-5, -2e-5)] {
        let piece = Piece::at_eyelet(d, tangent);
        for c in 0..3 {
            let mut step = Vec3::zeros();
            step[c] = h;
            let (plus, minus) = (Piece::at_eyelet(d + step, tangent), Piece::at_eyelet(d - step, tangent));
            assert!(((plus.length - minus.length) / (2.0 * h) - piece.along[c]).abs() < 1e-4);
            assert!(
                length((plus.along - minus.along) / (2.0 * h) - piece.bend.column(c)) < 1e-3 * piece.bend.abs().max()
            );
        }
    }
}

/// The condensed force and stiffness of a taut thread against the Schur complement of the dense double-precision system.
#[test]
fn the_condensed_response_is_the_schur_complement() {
    let effects = [Effect::Knot, Effect::ThreadBending];
    for (effect, eyelets) in effects
        .iter()
        .flat_map(|e| [NONE, ONE, TWO, TWO_IN_A_LINK].map(|eyelets| (*e, eyelets)))
    {
        let (params, mut tissue, mut thread) = super::behaviour::straight_with(effect, eyelets);
        let swage = thread.state.nodes[0].point() + super::behaviour::way(eyelets) * 5e-3;
        for _ in 0..400 {
            tissue.tick(&params, &mut thread, swage, &Air);
        }
        tissue.velocity.iter_mut().for_each(|v| *v = Vec3::zeros());
        let ends = tissue.ends(swage);
        let ours = *condense(&params, &thread.state, &ends, &Air, &mut thread.work);
        let mut dense = super::behaviour::monolith(&params, &thread.state, &tissue);
        dense.tissue_mass = 0.0;
        dense.tissue_stiffness = 0.0;
        let (force, stiffness) = dense.condensed(super::behaviour::wide(swage));
        let scale = stiffness.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
        for (r, row) in stiffness.iter().enumerate() {
            assert!(
                (f64::from(ours.force[r / 3][r % 3]) - force[r]).abs() < 1e-3,
                "{effect:?} {eyelets:?} force {r}: {} and {}",
                ours.force[r / 3][r % 3],
                force[r]
            );
            for (c, exact) in row.iter().enumerate() {
                let block = f64::from(ours.stiffness[r / 3][c / 3][(r % 3, c % 3)]);
                assert!(
                    (block - exact).abs() < 1e-4 * scale,
                    "{effect:?} {eyelets:?} {r} {c}: {block} and {exact}"
                );
            }
        }
    }
}
