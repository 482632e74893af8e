//! What must hold to rounding: Eq. 11, the Jacobian, the condensation.

use super::super::contact::press;
use super::super::link::{Link, Piece, plain, sliding, tied};
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

/// Forces on a, b, p and their blocks as one 9-vector and one 9 × 9 matrix.
fn dense(link: &Link) -> ([f32; 9], [[f32; 9]; 9]) {
    let through = link.through.unwrap_or_default();
    let (ap, bp) = (through.ap, through.bp);
    let blocks = [
        [link.aa, link.ab, ap],
        [link.ab.transpose(), link.bb, bp],
        [ap.transpose(), bp.transpose(), through.pp],
    ];
    let forces = [link.on_a, link.on_b, through.on_p];
    let mut matrix = [[0.0; 9]; 9];
    for (r, row) in matrix.iter_mut().enumerate() {
        for (c, cell) in row.iter_mut().enumerate() {
            *cell = blocks[r / 3][c / 3][(r % 3, c % 3)];
        }
    }
    (core::array::from_fn(|i| forces[i / 3][i % 3]), matrix)
}

/// Central differences with h = 20 µm: rounding of lengths (0.2 nm · 15 kN/m / 2h) and the third derivative (k h²/6l²) leave
/// about 1e-5 of k; 1e-4 is allowed.
fn against_differences(name: &str, k: f32, link: impl Fn(&[Vec3; 3]) -> Link) {
    let points = [
        Vec3::new(1.0e-3, 2.5e-3, 2.2e-3),
        Vec3::new(-1.5e-3, 0.5e-3, -1.8e-3),
        Vec3::new(0.1e-3, 0.2e-3, 0.3e-3),
    ];
    let h = 2e-5;
    let (_, matrix) = dense(&link(&points));
    for c in 0..9 {
        let moved = |by: f32| {
            let mut points = points;
            points[c / 3][c % 3] += by;
            dense(&link(&points)).0
        };
        let (plus, minus) = (moved(h), moved(-h));
        for r in 0..9 {
            let difference = (minus[r] - plus[r]) / (2.0 * h);
            assert!(
                (difference - matrix[r][c]).abs() < 1e-4 * k,
                "{name} ({r}, {c}): {} and {difference}",
                matrix[r][c]
            );
        }
    }
}

#[test]
fn the_jacobian_agrees_with_central_differences() {
    let params = params(40, 0.005, &[]);
    let k = params.stiffness();
    let seen = |points: &[Vec3; 3]| {
        let [a, b, p] = *points;
        [Piece::at_eyelet(a - p, Vec3::x()), Piece::at_eyelet(b - p, Vec3::x())]
    };
    against_differences("plain", k, |points| plain(&params, points[1] - points[0], 0.0));
    against_differences("sliding", k, |points| sliding(&params, &seen(points), 0.0));
    against_differences("tied", k * 2.0, |points| tied(&params, &seen(points), [2.5e-3; 2]));
    let touch = Touch {
        gap: -1e-3,
        normal: Vec3::new(2.0, 3.0, 6.0) / 7.0,
    };
    against_differences("ground", 200.0, |points| {
        let (on_a, aa) = press(&touch, 200.0, points[0] * 0.1);
        Link {
            on_a,
            aa: aa * 0.1,
            ..Link::default()
        }
    });
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
    for through in [None, Some(8)] {
        let (params, mut tissue, mut thread) = super::behaviour::straight(through);
        let swage = thread.state.nodes[0].point() + super::behaviour::way(through) * 5e-3;
        for _ in 0..400 {
            tissue.tick(&params, &mut thread, swage, &Air);
        }
        let ends = Ends {
            swage: Some(swage),
            tail: Some(tissue.at[0]),
            eyelet: through.map(|_| tissue.at[1]),
            end_stiffness: 258.0,
        };
        let ours = condense(&params, &thread.state, &ends, &Air, &mut thread.work);
        let mut dense = super::behaviour::monolith(&params, &thread.state, &tissue);
        dense.tissue_mass = 0.0;
        dense.tissue_stiffness = 0.0;
        let (force, stiffness) = dense.condensed(super::behaviour::wide(swage));
        let points = if through.is_some() { 6 } else { 3 };
        let scale = stiffness.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
        for (r, row) in stiffness.iter().enumerate().take(points) {
            assert!(
                (f64::from(ours.force[r / 3][r % 3]) - force[r]).abs() < 1e-3,
                "{through:?} force {r}"
            );
            for (c, exact) in row.iter().enumerate().take(points) {
                let block = f64::from(ours.stiffness[r / 3][c / 3][(r % 3, c % 3)]);
                assert!(
                    (block - exact).abs() < 1e-4 * scale,
                    "{through:?} {r} {c}: {block} and {exact}"
                );
            }
        }
    }
}
