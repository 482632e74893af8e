//! A cantilever under a load on its end: half of a beam on two supports, loaded in its middle.
//!
//! The near face keeps its plane and may widen in it; the far face carries an even load, the near one its reaction. A face that is held
//! in all its components would stiffen the beam by the half of a per cent, which is no error of the lattice.

use super::{CANTILEVER, Force, POISSON, YOUNG, body, voxels};
use crate::study::double::V;
use crate::study::poke;

/// Length, width and thickness [mm]: eight times as long as thick.
const SIZE_MM: [f64; 3] = [96.0, 12.0, 12.0];
/// Deflection whose force is compared [m].
const DEFLECTION: f64 = 1e-3;

/// F of δ = F L³/(3 E I) + F L/(κ G A), κ = 10(1 + ν)/(12 + 11ν) (Timoshenko; Cowper 1966). Fibres lumped at the nodes give a beam of
/// h voxels 1 + 2/h² of its second moment, which makes the second order.
pub(super) fn forces(pitch_m: f64) -> Result<Vec<Force>, poke::Error> {
    let mut body = body(SIZE_MM, pitch_m)?;
    let [last, across, up] = voxels(SIZE_MM, pitch_m);
    // Two corners keep the face from drifting and turning in its plane; as the loads are in balance, they bear nothing.
    let first = [0, 0, 0];
    let second = [0, across, 0];
    body.hold(|node| [node[0] == 0, node == first, node == first || node == second]);
    let rim = |n: u32, last: u32| if n == 0 || n == last { 0.5 } else { 1.0 } / f64::from(last);
    // Of an even unit load on the far face, and of its reaction on the near one.
    let share = |[i, j, k]: [u32; 3]| {
        let even = rim(j, across) * rim(k, up);
        match i {
            0 => -even,
            i if i == last => even,
            _ => 0.0,
        }
    };
    let load = body.field(|node| V::z() * share(node));
    let mut at = body.field(|_| V::zeros());
    body.model.relax_under(&load, &mut at)?;
    let nodes = body.nodes.iter();
    let under_one_newton: f64 = nodes.map(|(node, index)| share(*node) * at.get(*index).z).sum();
    let forces = [DEFLECTION / under_one_newton, DEFLECTION / timoshenko()];
    Ok(vec![Force::linear(CANTILEVER, forces, pitch_m, body.nodes.len())])
}

/// Deflection under a unit load on the end [m/N].
fn timoshenko() -> f64 {
    let [length, width, thick] = SIZE_MM.map(|size| size * 1e-3);
    let kappa = 10.0 * (1.0 + POISSON) / (12.0 + 11.0 * POISSON);
    let shear = YOUNG / (2.0 * (1.0 + POISSON));
    let bending = length.powi(3) / (3.0 * YOUNG * width * thick.powi(3) / 12.0);
    bending + length / (kappa * shear * width * thick)
}
