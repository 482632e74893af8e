//! The elements against closed forms, and against the order with which they must converge.

use super::*;
use crate::study::double::V;

const YOUNG: f64 = 1e5;

fn solid(cells: [usize; 3], pitch_m: f64, poisson: f64) -> Solid {
    Solid::new(
        cells,
        pitch_m,
        Elastic {
            young_pa: YOUNG,
            poisson,
        },
    )
}

/// Moved affinely, a body is in balance inside, and its energy is ½ (2G ε : ε + λ (tr ε)²) V (Irons' patch test).
#[test]
fn an_affine_motion_is_in_balance() {
    let (cells, pitch) = ([4, 3, 5], 2e-3);
    let gradient = nalgebra::Matrix3::new(0.3, 0.7, -0.2, 0.1, -0.5, 0.4, 0.6, -0.3, 0.8) * 1e-2;
    let affine = |node: [usize; 3]| <[f64; 3]>::from(gradient * V::from(node.map(|i| i as f64 * pitch)));
    for poisson in [0.0, 0.25, 0.499] {
        let solid = solid(cells, pitch, poisson);
        let at = solid.field(affine);
        let mut pull = Field::zeros(at.len());
        solid.apply(&at, &mut pull);
        let inside = |node: [usize; 3]| node.iter().zip(&cells).all(|(n, cells)| (1..*cells).contains(n));
        let forces = || solid.nodes().map(|(node, n)| (inside(node), pull.get(n).norm()));
        let largest = |within| {
            forces()
                .filter(|(inside, _)| *inside == within)
                .fold(0.0, |most, (_, f)| f64::max(most, f))
        };
        assert!(
            largest(true) < 1e-10 * largest(false),
            "{poisson}: {:e} of {:e}",
            largest(true),
            largest(false)
        );
        let strain = (gradient + gradient.transpose()) / 2.0;
        let shear = YOUNG / (2.0 * (1.0 + poisson));
        let lame = 2.0 * shear * poisson / (1.0 - 2.0 * poisson);
        let density = shear * strain.norm_squared() + 0.5 * lame * strain.trace().powi(2);
        let volume = 60.0 * pitch.powi(3);
        let energy = 0.5 * at.dot(&pull);
        assert!((energy / (density * volume) - 1.0).abs() < 1e-10, "{poisson}: {energy}");
    }
}

/// Energy of a bar of square section, twice as long as thick, whose ends turn against each other at unit curvature: ½ E I L of
/// u = (x z, −ν y z, −(x² + ν z² − ν y²)/2), which satisfies the equations with free sides. Over it, for `cells` across the thickness.
fn bending(cells: usize, poisson: f64) -> f64 {
    let (length, thick) = (20e-3, 10e-3);
    let pitch = thick / cells as f64;
    let mut solid = solid([2 * cells, cells, cells], pitch, poisson);
    let place = |node: [usize; 3]| V::from(node.map(|i| i as f64 * pitch)) - V::new(length, thick, thick) / 2.0;
    let exact = |node: [usize; 3]| {
        let at = place(node);
        let down = -0.5 * (at.x * at.x + poisson * (at.z * at.z - at.y * at.y));
        [at.x * at.z, -poisson * at.y * at.z, down]
    };
    let last = 2 * cells;
    solid.hold(|node| [node[0] == 0 || node[0] == last; 3]);
    let mut at = solid.field(exact);
    let energy = solid.relax(&Field::zeros(at.len()), &mut at).unwrap();
    energy / (0.5 * YOUNG * thick.powi(4) / 12.0 * length)
}

/// Too stiff by the second order of the cubes' edge.
#[test]
fn bending_converges_with_the_second_order() {
    let error = [4, 8, 16].map(|cells| bending(cells, 0.3) - 1.0);
    let order = (error[1] / error[2]).log2();
    eprintln!("bending too stiff by {error:.4?}, order {order:.3}");
    assert!((order - 2.0).abs() < 0.1, "{order}");
    assert!(error[2] > 0.0 && error[2] < 0.02, "{error:?}");
}

/// Near ν = 1/2 as close as at ν = 0.3, where cubes integrated in full would be several times too stiff.
#[test]
fn cubes_do_not_lock() {
    let [soft, tight] = [0.3, 0.499].map(|poisson| bending(4, poisson) - 1.0);
    eprintln!("bending too stiff by {soft:.4} at 0.3, {tight:.4} at 0.499");
    assert!(tight.abs() < 2.0 * soft, "{tight} for {soft}");
}
