//! Which link is in the eyelet, as the thread slides through it.

use super::config::Params;
use super::link::Piece;
use super::state::{NODES_MAX, Place, Run};
use crate::math::{Vec3, direction};

/// The pieces of link `link` on both sides of `eyelet`.
pub(super) fn pieces(nodes: &[Place; NODES_MAX], n: usize, link: usize, eyelet: &Place) -> [Piece; 2] {
    let seen = |index: usize| nodes.get(index).map_or_else(Vec3::zeros, |node| eyelet.to(node));
    let (a, b) = (seen(link), seen(link + 1));
    let behind_b = if link + 2 < n { seen(link + 2) } else { -a };
    let behind_a = if link > 0 { seen(link - 1) } else { -b };
    [
        Piece::at_eyelet(a, direction(behind_a, 1e-9)),
        Piece::at_eyelet(b, direction(behind_b, 1e-9)),
    ]
}

/// Passes one node through the eyelet where the taut link has drawn it past: the node's signed distance from the eyelet,
/// along `pieces` as they were when the step was made, is below zero. It is put as far on the other side, on the line to its
/// neighbour there, so each link keeps its length and its tension.
pub(super) fn slide(
    params: &Params,
    nodes: &mut [Place; NODES_MAX],
    run: &mut Run,
    eyelet: &Place,
    pieces: &[Piece; 2],
) {
    let Run::Sliding { link } = run else { return };
    let (Some(a), Some(b)) = (nodes.get(*link).copied(), nodes.get(*link + 1).copied()) else {
        return;
    };
    let (to_a, to_b) = (eyelet.to(&a), eyelet.to(&b));
    let [at_a, at_b] = pieces;
    let (left_a, left_b) = (at_a.tangent.dot(&to_a), at_b.tangent.dot(&to_b));
    if left_a + left_b <= params.rest {
        return;
    }
    let (passing, past, towards, next) = if left_b < 0.0 && *link + 2 < params.nodes {
        (*link + 1, -left_b, to_a, *link + 1)
    } else if left_a < 0.0 && *link > 0 {
        (*link, -left_a, to_b, *link - 1)
    } else {
        return;
    };
    if let Some(node) = nodes.get_mut(passing) {
        let beyond = direction(towards, 1e-9) * past.min(0.5 * params.rest);
        // Relative to the node's own coarse part, from which its displacement is measured.
        node.fine = (eyelet.coarse - node.coarse) + (eyelet.fine + beyond);
        *link = next;
    }
}
