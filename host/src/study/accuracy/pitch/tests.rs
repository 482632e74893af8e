//! The closed forms stand in the rows; here, what the rows must show of them.

use super::*;

/// Errors of a · pitch^p have the order p.
#[test]
fn the_order_is_the_exponent() {
    let points = [4.0, 3.0, 2.0, 1.0_f64].map(|pitch| (pitch, 0.3 * pitch.powf(1.7)));
    assert!((order(&points) - 1.7).abs() < 1e-12);
}

/// Lumped fibres make a beam of h voxels stiffer in bending by 2/h², of the second order; the infinite pressure at a punch's edge is blunted
/// by a pitch, of the first; Hertz's pressure ends at zero, so its order is higher than that.
#[test]
fn errors_fall_with_the_orders_of_their_causes() {
    let rows = run(Extent::Quick, &|| Ok(()), &|_| ()).unwrap();
    let of = |case| {
        let finest = rows.iter().rfind(|row| row.case == case).unwrap();
        eprintln!("{finest:?}");
        (finest.order, finest.error)
    };
    let (order, stiffer) = of(CANTILEVER);
    assert!((order - 2.0).abs() < 0.1, "{order}");
    // Six voxels; a fiftieth of the deflection is shear, which is not stiffer.
    assert!((stiffer - 2.0 / 36.0).abs() < 0.02, "{stiffer}");
    let (order, softer) = of(PUNCH);
    assert!(
        (order - 1.0).abs() < 0.3 && (-0.05..0.0).contains(&softer),
        "{order} {softer}"
    );
    let (order, error) = of(HERTZ);
    assert!(order > 1.5 && error.abs() < 0.005, "{order} {error}");
}
