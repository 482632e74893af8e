//! The tissue's outer surface as a height over the rest lattice's columns.
//!
//! The surface under a point is the bilinear interpolation of the four column tops around it. Columns are found at rest,
//! so a lookup is index arithmetic; the sideways motion of the tops is left out, which errs by slope × sideways motion.

use crate::coupling::Kernel;
use crate::lattice::{Lattice, Tissue, at};
use crate::math::{Vec3, length};

/// The four column tops around a point and their weights; `None` over the wound, beyond the patch or at its rim.
fn corners<const N: usize>(lattice: &Lattice<N>, p: Vec3) -> Option<[(usize, f32); 4]> {
    let [ox, oy, _] = lattice.origin;
    let (x, y) = ((p.x - ox) / lattice.pitch, (p.y - oy) / lattice.pitch);
    if x.is_nan() || y.is_nan() || x < 0.0 || y < 0.0 {
        return None;
    }
    let (i, j) = (x as u32, y as u32);
    let (fx, fy) = (x - i as f32, y - j as f32);
    Some([
        (lattice.top(i, j)?, (1.0 - fx) * (1.0 - fy)),
        (lattice.top(i + 1, j)?, fx * (1.0 - fy)),
        (lattice.top(i, j + 1)?, (1.0 - fx) * fy),
        (lattice.top(i + 1, j + 1)?, fx * fy),
    ])
}

/// Height of the surface at (x, y) of `p` [m]; `None` where there is none.
#[must_use]
pub fn height<const N: usize>(lattice: &Lattice<N>, tissue: &Tissue<N>, p: Vec3) -> Option<f32> {
    let tops = corners(lattice, p)?;
    Some(tops.iter().map(|(node, w)| w * lattice.place(tissue, *node).z).sum())
}

/// Height [m] and outward normal of the surface at (x, y) of `p`; `None` where there is none.
#[must_use]
pub fn surface<const N: usize>(lattice: &Lattice<N>, tissue: &Tissue<N>, p: Vec3) -> Option<(f32, Vec3)> {
    let tops = corners(lattice, p)?;
    let [a, b, c, d] = tops.map(|(node, _)| lattice.place(tissue, node).z);
    let height = tops.iter().zip([a, b, c, d]).map(|((_, w), z)| w * z).sum();
    let slope = 0.5 / lattice.pitch;
    let normal = Vec3::new(-slope * (b - a + d - c), -slope * (c - a + d - b), 1.0);
    Some((height, normal / length(normal)))
}

/// Spreads `force` at `p` over the column tops around it.
pub fn lifted<const N: usize>(lattice: &Lattice<N>, p: Vec3, force: Vec3, out: &mut crate::lattice::Field<N>) {
    for (node, w) in corners(lattice, p).into_iter().flatten() {
        crate::lattice::add(out, node, force * w);
    }
}

/// The tip's kernel at `p`: nodes within `radius` with weights (1 − r²/R²)², normalised.
///
/// It reaches into the depth as well, so that a tip loads more than the top nodes. Held nodes take no part.
/// Bounded: one pass over the nodes, in the tick in which a tip meets the skin.
#[must_use]
pub fn kernel_at<const N: usize>(lattice: &Lattice<N>, tissue: &Tissue<N>, p: Vec3, radius: f32) -> Kernel {
    let mut kernel = Kernel::default();
    for node in 0..lattice.len() {
        if lattice.free.get(node).is_none_or(|free| *free <= 0.0) {
            continue;
        }
        let place = lattice.rest_place(node) + at(&tissue.displacement, node) - p;
        let inside = 1.0 - place.dot(&place) / (radius * radius);
        if inside > 0.0 {
            kernel.push(node as u32, inside * inside);
        }
    }
    kernel.normalised()
}
