//! The tissue's outer surface as a height over the rest lattice's columns.
//!
//! The surface under a point is the bilinear interpolation of the four column tops around it. Columns are found at rest,
//! so a lookup is index arithmetic; the sideways motion of the tops is left out, which errs by slope × sideways motion.

use crate::coupling::Kernel;
use crate::lattice::{Lattice, Tissue, at};
use crate::math::{Vec3, length};
use core::ops::RangeInclusive;

/// Height difference at rest of neighbouring tops from which it is a wall, such as the wound's, and no surface [pitches].
const WALL: f32 = 1.5;

/// The column to the lower left of a point, and how far between it and the next the point is; `None` beyond the patch.
fn cell<const N: usize>(lattice: &Lattice<N>, p: Vec3) -> Option<([u32; 2], [f32; 2])> {
    let [ox, oy, _] = lattice.origin;
    let (x, y) = ((p.x - ox) / lattice.pitch, (p.y - oy) / lattice.pitch);
    let inside = x >= 0.0 && y >= 0.0;
    inside.then_some(([x as u32, y as u32], [x - (x as u32) as f32, y - (y as u32) as f32]))
}

/// The four column tops around a point and their weights, the wound's floor among them; `None` beyond the patch.
fn corners<const N: usize>(lattice: &Lattice<N>, p: Vec3) -> Option<[(usize, f32); 4]> {
    let tops = ground_around(lattice, None, p)?;
    Some(tops.map(|([(node, _), _], w)| (node, w)))
}

/// Height of the skin at (x, y) of `p` [m]; `None` at the wound's walls and beyond the patch.
#[must_use]
pub fn height<const N: usize>(lattice: &Lattice<N>, tissue: &Tissue<N>, p: Vec3) -> Option<f32> {
    let tops = corners(lattice, p)?;
    let rest = tops.map(|(node, _)| lattice.rest_place(node).z);
    let [low, high] = [rest.into_iter().reduce(f32::min)?, rest.into_iter().reduce(f32::max)?];
    if high - low > WALL * lattice.pitch {
        return None;
    }
    Some(tops.iter().map(|(node, w)| w * lattice.place(tissue, *node).z).sum())
}

/// Strain of the skin around a point: the mean of the four edges that join the tops around it; `None` beyond the patch.
#[must_use]
pub fn strain<const N: usize>(lattice: &Lattice<N>, tissue: &Tissue<N>, p: Vec3) -> Option<f32> {
    let [(a, _), (b, _), (c, _), (d, _)] = corners(lattice, p)?;
    let of = |(from, to): (usize, usize)| {
        let rest = length(lattice.rest_place(to) - lattice.rest_place(from));
        length(lattice.place(tissue, to) - lattice.place(tissue, from)) / rest - 1.0
    };
    Some(0.25 * [(a, b), (c, d), (a, c), (b, d)].map(of).iter().sum::<f32>())
}

/// The wound as a thread crosses it: columns of its two faces and its rows. Between them the thread's ground goes from rim to rim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bridge {
    /// Columns of the left and the right face.
    pub columns: [u32; 2],
    /// First and last row.
    pub rows: [u32; 2],
}

/// Nodes with weights that sum to one; the second may weigh nothing.
type Pair = [(usize, f32); 2];

/// A column's top as the thread's ground has it: one node, or the two rims on either side of the wound, with weights.
fn ground<const N: usize>(lattice: &Lattice<N>, bridge: Option<&Bridge>, i: u32, j: u32) -> Option<Pair> {
    if let Some(Bridge {
        columns: [left, right],
        rows: [first, last],
    }) = bridge
        && (left + 1..*right).contains(&i)
        && (first..=last).contains(&&j)
    {
        let part = (i - left) as f32 / (right - left) as f32;
        return Some([(lattice.top(*left, j)?, 1.0 - part), (lattice.top(*right, j)?, part)]);
    }
    let top = lattice.top(i, j)?;
    Some([(top, 1.0), (top, 0.0)])
}

/// The thread's ground around a point: the four columns' tops, each with its weight and its own one or two nodes.
fn ground_around<const N: usize>(lattice: &Lattice<N>, bridge: Option<&Bridge>, p: Vec3) -> Option<[(Pair, f32); 4]> {
    let ([i, j], [fx, fy]) = cell(lattice, p)?;
    Some([
        (ground(lattice, bridge, i, j)?, (1.0 - fx) * (1.0 - fy)),
        (ground(lattice, bridge, i + 1, j)?, fx * (1.0 - fy)),
        (ground(lattice, bridge, i, j + 1)?, (1.0 - fx) * fy),
        (ground(lattice, bridge, i + 1, j + 1)?, fx * fy),
    ])
}

/// Height [m] and outward normal of the thread's ground at (x, y) of `p`; `None` beyond the patch.
#[must_use]
pub fn surface<const N: usize>(
    lattice: &Lattice<N>,
    tissue: &Tissue<N>,
    bridge: Option<&Bridge>,
    p: Vec3,
) -> Option<(f32, Vec3)> {
    let tops = ground_around(lattice, bridge, p)?;
    let heights = tops.map(|(nodes, _)| {
        nodes
            .map(|(node, w)| w * lattice.place(tissue, node).z)
            .iter()
            .sum::<f32>()
    });
    let height = tops.iter().zip(heights).map(|((_, w), z)| w * z).sum();
    let [a, b, c, d] = heights;
    let slope = 0.5 / lattice.pitch;
    let normal = Vec3::new(-slope * (b - a + d - c), -slope * (c - a + d - b), 1.0);
    Some((height, normal / length(normal)))
}

/// Spreads `force` at `p` over the nodes of the thread's ground.
pub fn lifted<const N: usize>(
    lattice: &Lattice<N>,
    bridge: Option<&Bridge>,
    p: Vec3,
    force: Vec3,
    out: &mut crate::lattice::Field<N>,
) {
    for (nodes, share) in ground_around(lattice, bridge, p).into_iter().flatten() {
        for (node, w) in nodes {
            crate::lattice::add(out, node, force * (w * share));
        }
    }
}

/// The tip's kernel at `p`: nodes within `radius` with weights (1 − r²/R²)², normalised.
///
/// It reaches into the depth as well, so that a tip loads more than the top nodes. Held nodes take no part.
/// Bounded: one pass over the nodes, in the tick in which a tip meets the skin.
#[must_use]
pub fn kernel_at<const N: usize>(lattice: &Lattice<N>, tissue: &Tissue<N>, p: Vec3, radius: f32) -> Kernel {
    kernel_among(lattice, tissue, (p, radius), &(0..=u32::MAX))
}

/// The same among the nodes of some `columns`, such as those on one side of the wound.
#[must_use]
pub fn kernel_among<const N: usize>(
    lattice: &Lattice<N>,
    tissue: &Tissue<N>,
    (p, radius): (Vec3, f32),
    columns: &RangeInclusive<u32>,
) -> Kernel {
    let mut kernel = Kernel::default();
    for node in 0..lattice.len() {
        if lattice.free.get(node).is_none_or(|free| *free <= 0.0) || !columns.contains(&lattice.column(node)) {
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
