//! A column in uniaxial stress follows the stress–strain curve that its tissue was given.

use super::block::{Block, PITCH, scene, stiffening};
use sutura_shared::scene::{Effect, Law};

/// Strain at which a segment begins, and its slope [Pa].
type Curve = [(f32, f32)];

/// Skin and muscle of the built-in scene (Lian & Chen Fig. 3), a line, and a curve that is steep early.
const CURVES: [(&str, &Curve); 4] = [
    ("skin", &[(0.0, 281e3), (0.3, 1.7e6), (0.6, 3.66e6)]),
    (
        "muscle",
        &[(0.0, 26e3), (0.1, 43e3), (0.2, 70e3), (0.3, 117e3), (0.4, 192e3)],
    ),
    ("line", &[(0.0, 100e3)]),
    ("early", &[(0.0, 100e3), (0.03, 400e3), (0.06, 1e6)]),
];

/// Laws, and their Young's modulus over the nominal one: (C11 − C12)(C11 + 2 C12)/(C11 + C12).
const LAWS: [(Law, f64); 6] = [
    (Law::Isotropic, 1.0),
    (Law::Axial, 1.0),
    (Law::Paper, 0.584_302),
    (Law::Volume { poisson: 0.3 }, 1.0),
    (Law::Volume { poisson: 0.45 }, 1.0),
    (Law::Volume { poisson: 0.49 }, 1.0),
];

/// Nominal stress of a curve at `strain` [Pa].
fn asked(curve: &Curve, strain: f64) -> f64 {
    let ends = curve
        .iter()
        .skip(1)
        .map(|(from, _)| f64::from(*from))
        .chain([f64::INFINITY]);
    let pieces = curve.iter().zip(ends);
    pieces
        .map(|((from, slope), end)| f64::from(*slope) * (strain.min(end) - f64::from(*from)).max(0.0))
        .sum()
}

fn column(law: Law, curve: &Curve) -> Block {
    Block::filled(&scene([2, 2, 3], law, &[stiffening(curve)], &[Effect::Stiffening]))
}

/// Nominal stress along z at `strain` with free sides [Pa]: the sideways stretch is halved in until the sides pull no more.
fn stress(block: &mut Block, strain: f64) -> f64 {
    let (mut low, mut high) = (0.4, 1.5);
    for _ in 0..40 {
        let across = 0.5 * (low + high);
        block.impose(|[x, y, z]| [x * (across - 1.0), y * (across - 1.0), z * strain]);
        let [pull, ..] = block.pull(0);
        if pull > 0.0 {
            high = across;
        } else {
            low = across;
        }
    }
    let side = f64::from(PITCH) * 2.0;
    block.pull(2)[2] / (side * side)
}

/// Largest relative difference from the asked stress over strains a hundredth apart.
fn worst(block: &mut Block, hundredths: impl Iterator<Item = i8>, asked: impl Fn(f64) -> f64) -> f64 {
    let strains = hundredths.map(|n| 0.01 * f64::from(n));
    strains
        .map(|strain| (stress(block, strain) / asked(strain) - 1.0).abs())
        .fold(0.0, f64::max)
}

/// Within 3 % up to 60 %, at the curve's breakpoints and between them.
#[test]
fn a_column_follows_its_curve() {
    for (name, curve) in CURVES {
        for (law, modulus) in LAWS {
            let worst = worst(&mut column(law, curve), 1..=60, |strain| modulus * asked(curve, strain));
            eprintln!("{name}, {law:?}: within {:.1} %", 100.0 * worst);
            assert!(worst < 0.03, "{name}, {law:?}: {worst}");
        }
    }
}

/// The locks meet a loss of volume, which uniaxial compression is not.
#[test]
fn compression_to_thirty_percent_keeps_the_first_slope() {
    for (name, curve) in CURVES {
        for (law, modulus) in LAWS {
            let first = modulus * f64::from(curve[0].1);
            let worst = worst(&mut column(law, curve), -30..=-1, |strain| first * strain);
            eprintln!("{name}, {law:?}: within {:.1} % of the first slope", 100.0 * worst);
            assert!(worst < allowed_in_compression(name, law), "{name}, {law:?}: {worst}");
        }
    }
}

/// What nearly incompressible voxels cannot do: their sides are stretched, against springs that follow the asked curve there, and a spring in
/// compression has no more to give up than its own force.
fn allowed_in_compression(name: &str, law: Law) -> f64 {
    match (name, law) {
        ("muscle", Law::Volume { poisson: 0.45 }) => 0.18,
        ("early", Law::Volume { poisson: 0.45.. }) | (_, Law::Volume { poisson: 0.49 }) => f64::INFINITY,
        _ => 0.1,
    }
}

/// Linear springs stiffen by turning: they are what they are where a scene does not ask for curves.
#[test]
fn without_the_effect_springs_are_linear() {
    for (edge, diagonal, law) in [(0.8, 0.3, Law::Isotropic), (0.45, 0.25, Law::Paper)] {
        let mut block = Block::filled(&scene([2, 2, 3], law, &[stiffening(CURVES[0].1)], &[]));
        for strain in [-0.25, -0.1, 0.1, 0.3, 0.6] {
            let (measured, expected) = (stress(&mut block, strain), by_hand(edge, diagonal, strain));
            let error = (measured / expected - 1.0).abs();
            assert!(error < 1e-4, "{law:?} {strain}: {measured} for {expected}");
        }
    }
}

/// One voxel's linear springs by hand: k_n ε + 4 k_d e λ/(1 + e) with the diagonals' strain e, where the sides balance,
/// k_n (λ_t − 1) + 4 k_d e λ_t/(1 + e) = 0.
fn by_hand(edge: f64, diagonal: f64, strain: f64) -> f64 {
    let along = 1.0 + strain;
    let (mut low, mut high) = (0.4_f64, 1.5_f64);
    let of = |across: f64| ((along * along + 2.0 * across * across) / 3.0).sqrt() - 1.0;
    for _ in 0..60 {
        let across = 0.5 * (low + high);
        let e = of(across);
        if edge * (across - 1.0) + 4.0 * diagonal * e * across / (1.0 + e) > 0.0 {
            high = across;
        } else {
            low = across;
        }
    }
    let e = of(low);
    f64::from(CURVES[0].1[0].1) * (edge * strain + 4.0 * diagonal * e * along / (1.0 + e))
}
