//! A column in uniaxial stress follows the stress–strain curve that its tissue was given.

use super::block::{Block, PITCH, apart, scene, stiffening};
use sutura_shared::scene::{Effect, Law};

/// Skin of the built-in scene: 281, 1,700 and 3,660 kPa with breaks at 30 % and 60 % (Lian & Chen Fig. 3).
const SKIN: [(f32, f32); 3] = [(0.0, 281e3), (0.3, 1.7e6), (0.6, 3.66e6)];

const LAWS: [(Law, f64, f64); 2] = [(Law::Isotropic, 0.8, 0.3), (Law::Axial, 0.816_496_580_927_726, 0.25)];

/// Nominal stress of [`SKIN`] at `strain` [Pa].
fn asked(strain: f64) -> f64 {
    let ends = SKIN
        .iter()
        .skip(1)
        .map(|(from, _)| f64::from(*from))
        .chain([f64::INFINITY]);
    let pieces = SKIN.iter().zip(ends);
    pieces
        .map(|((from, slope), end)| f64::from(*slope) * (strain.min(end) - f64::from(*from)).max(0.0))
        .sum()
}

fn column(law: Law) -> Block {
    Block::filled(&scene([2, 2, 3], law, &[stiffening(&SKIN)], &[Effect::Stiffening]))
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

/// The same of one voxel's springs on their first slope, by hand: k_n ε + 4 k_d e λ/(1 + e) with the diagonals' strain e, where the
/// sides balance, k_n (λ_t − 1) + 4 k_d e λ_t/(1 + e) = 0.
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
    f64::from(SKIN[0].1) * (edge * strain + 4.0 * diagonal * e * along / (1.0 + e))
}

/// Springs stiffen by turning: the diagonals swing towards the pull and add 10 % to the stress at the first break. Beyond it
/// breakpoints of edges and diagonals fall together and the curve is met again.
#[test]
fn skin_follows_its_curve() {
    for (law, edge, diagonal) in LAWS {
        let mut block = column(law);
        for strain in (1..=16).map(|n| 0.05 * f64::from(n)) {
            let measured = stress(&mut block, strain);
            let off = measured / asked(strain) - 1.0;
            eprintln!(
                "{law:?}: {:3.0} %: {measured:.4e} Pa, {:+.1} % of the curve",
                100.0 * strain,
                100.0 * off
            );
            let allowed = match strain {
                0.0..0.06 => 0.02,
                0.0..0.31 => 0.11,
                0.0..0.39 => 0.2,
                0.0..0.61 => 0.03,
                _ => 0.08,
            };
            assert!(off.abs() < allowed, "{law:?} {strain}: {off}");
            if strain < 0.29 {
                let expected = by_hand(edge, diagonal, strain);
                assert!(
                    apart(measured, expected) < 1e-4,
                    "{law:?} {strain}: {measured} for {expected}"
                );
            }
        }
    }
}

/// The locks meet a loss of volume, which uniaxial compression is not.
#[test]
fn compression_to_thirty_percent_keeps_the_first_slope() {
    for (law, edge, diagonal) in LAWS {
        let mut block = column(law);
        for strain in [-0.05, -0.1, -0.15, -0.2, -0.25, -0.3] {
            let measured = stress(&mut block, strain);
            let first = f64::from(SKIN[0].1) * strain;
            let off = measured / first - 1.0;
            eprintln!(
                "{law:?}: {:3.0} %: {measured:.4e} Pa, {:+.1} % of the first slope",
                100.0 * strain,
                100.0 * off
            );
            assert!(off.abs() < 0.1, "{law:?} {strain}: {off}");
            if strain > -0.29 {
                let expected = by_hand(edge, diagonal, strain);
                assert!(
                    apart(measured, expected) < 1e-4,
                    "{law:?} {strain}: {measured} for {expected}"
                );
            }
        }
    }
}
