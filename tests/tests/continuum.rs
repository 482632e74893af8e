//! The lattice at rest against the continuum: pitches down to 1 mm and meshes finer than the study's own; minutes, so with SUTURA_FULL=1 only.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used)]

use sutura::study::accuracy::statics::Extent;
use sutura::study::accuracy::{model, pitch};
use sutura::study::double::Field;
use sutura::study::fem::{Elastic, Solid};
use sutura_tests::full;

/// Bending is too stiff by 2/h² of h voxels (fibres lumped at the nodes), a punch too soft by the first order (its pressure is infinite at
/// the edge), a sphere off by more than that order, as Hertz's pressure ends at zero.
#[test]
fn errors_keep_falling_at_the_finest_pitches() {
    if !full("errors_keep_falling_at_the_finest_pitches") {
        return;
    }
    let rows = pitch::run(Extent::Whole, &|| Ok(()), &|_| ()).unwrap();
    let of = |case| {
        let finest = rows.iter().rfind(|row| row.case == case).unwrap();
        eprintln!("{finest:?}");
        assert!((finest.pitch_mm - 1.0).abs() < 1e-9);
        (finest.order, finest.error)
    };
    let (order, stiffer) = of("cantilever");
    assert!(
        (order - 2.0).abs() < 0.05 && (stiffer - 2.0 / 144.0).abs() < 0.004,
        "{order} {stiffer}"
    );
    let (order, softer) = of("punch");
    assert!(
        (order - 1.0).abs() < 0.15 && (-0.02..0.0).contains(&softer),
        "{order} {softer}"
    );
    let (order, error) = of("hertz");
    assert!(order > 2.0 && error.abs() < 0.001, "{order} {error}");
}

/// Isotropic laws, assembled per voxel, cost nothing but their pitch; and the elements that say so are converged: a mesh of 0.25 mm, twice
/// as fine as the study's finest, is where its three meshes say.
#[test]
fn isotropic_laws_are_the_continuum_but_for_their_pitch() {
    if !full("isotropic_laws_are_the_continuum_but_for_their_pitch") {
        return;
    }
    let rows = model::run(Extent::Whole, &|| Ok(()), &|_| ()).unwrap();
    let isotropic = |row: &&model::Row| ["isotropic", "volume"].contains(&row.law) && row.assembly == "per-voxel";
    for row in rows.iter().filter(isotropic) {
        eprintln!("{row:?}");
        assert!(row.law_error.is_some_and(|error| error.abs() < 0.01), "{row:?}");
    }
    let pressed = |row: &&model::Row| row.law == "isotropic" && row.load == "press";
    let row = rows.iter().find(pressed).unwrap();
    // Each mesh leaves about half of the error.
    let foretold = row.fem_n * (1.0 + row.fem_left / 2.0);
    let finer = pressed_square(8);
    eprintln!("{finer:.5} N, foretold {foretold:.5} N");
    assert!((finer / foretold - 1.0).abs() < 0.003, "{finer} for {foretold}");
}

/// Force of the study's body in cubes of 2 mm over `refinement`: a quarter of 24 × 24 × 12 mm with a square of 8 mm, pressed by 0.5 mm [N].
fn pressed_square(refinement: usize) -> f64 {
    let [side, top, square] = [6, 6, 2].map(|voxels| voxels * refinement);
    let material = Elastic {
        young_pa: 1e5,
        poisson: 0.25,
    };
    let mut solid = Solid::new([side, side, top], 2e-3 / refinement as f64, material);
    let under = |[i, j, k]: [usize; 3]| k == top && i <= square && j <= square;
    solid.hold(|node| {
        let all = node[2] == 0 || under(node);
        [all || node[0] == 0, all || node[1] == 0, all]
    });
    let mut at = solid.field(|node| [0.0, 0.0, if under(node) { -0.5e-3 } else { 0.0 }]);
    let energy = solid.relax(&Field::zeros(at.len()), &mut at).unwrap();
    4.0 * 2.0 * energy / 0.5e-3
}
