//! Where the thread runs: through which punctures, and by which of its links.

use core::ops::Range;

use super::chain::Chain;
use super::config::{EYELET, Params};
use super::friction::Grip;
use super::state::{NODES_MAX, Place};
use crate::coupling::PUNCTURES;
use crate::math::{Vec3, direction, length};

/// A puncture that the thread runs through.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Eyelet {
    /// Where it is.
    pub place: Place,
    /// The link in it: from N₍link₎ on the needle's side to the next node on the tail's.
    pub link: usize,
    /// How the thread holds in it; of use with effect `thread-friction`.
    pub grip: Grip,
}

/// The punctures in the order in which the needle passed them: the first is the nearest to the tail.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Course {
    /// The punctures; those from `count` on have no meaning.
    pub eyelets: [Eyelet; PUNCTURES],
    /// How many there are.
    pub count: usize,
    /// Tied at the last puncture: rest lengths of the needle's and of the tail's part of the link in it [m].
    pub knot: Option<[f32; 2]>,
}

impl Course {
    /// The punctures that there are.
    #[must_use]
    pub fn through(&self) -> &[Eyelet] {
        self.eyelets.get(..self.count).unwrap_or_default()
    }

    /// The punctures in `link`, if those from `newer` on are in links before it.
    pub(super) fn within(&self, link: usize, newer: usize) -> Range<usize> {
        let older = self.through().iter().take(newer).rev();
        newer - older.take_while(|eyelet| eyelet.link == link).count()..newer
    }

    /// The neighbour of node `link` towards the needle: the last puncture in the link before, or that link's other node.
    pub(super) fn before<'a>(
        &'a self,
        nodes: &'a [Place; NODES_MAX],
        link: usize,
        eyelets: &Range<usize>,
    ) -> Option<&'a Place> {
        let index = link.checked_sub(1)?;
        let eyelet = self.through().get(eyelets.end).filter(|eyelet| eyelet.link == index);
        eyelet.map(|eyelet| &eyelet.place).or_else(|| nodes.get(index))
    }

    /// The neighbour of node `link + 1` towards the tail, of `n` nodes, likewise.
    pub(super) fn after<'a>(
        &'a self,
        (nodes, n): (&'a [Place; NODES_MAX], usize),
        link: usize,
        eyelets: &Range<usize>,
    ) -> Option<&'a Place> {
        let older = eyelets.start.checked_sub(1).and_then(|index| self.through().get(index));
        let eyelet = older.filter(|eyelet| eyelet.link == link + 1);
        let node = || nodes.get(link + 2).filter(|_| link + 2 < n);
        eyelet.map(|eyelet| &eyelet.place).or_else(node)
    }
}

/// Passes one node through the eyelet at either end of a taut link that has drawn it past: the node's signed distance from the eyelet,
/// along `tangents` as they were when the step was made, is below zero. It is put as far on the other side, on the line to its
/// neighbour there, so each link keeps its length and its tension.
pub(super) fn slide(
    params: &Params,
    nodes: &mut [Place; NODES_MAX],
    course: &mut Course,
    (link, eyelets): (usize, Range<usize>),
    tangents: [Vec3; 2],
) {
    let chain = Chain::new((nodes, params.nodes), course, link, eyelets.clone());
    let (Some(first), Some(last)) = (chain.point(1), chain.point(chain.eyelets())) else {
        return;
    };
    let [at_a, at_b] = tangents;
    let (to_a, to_b) = (first.to(&chain.a()), last.to(&chain.b()));
    let (left_a, left_b) = (at_a.dot(&to_a), at_b.dot(&to_b));
    if left_a + chain.between() + left_b <= params.rest {
        return;
    }
    let inner = chain.between();
    // No node passes the knot.
    let tied = course.knot.is_some() && eyelets.end == course.count;
    let (node, next, moved, eyelet, past, way) =
        if left_b < 0.0 && link + 2 < params.nodes && !(tied && eyelets.len() == 1) {
            (
                link + 1,
                link + 1,
                eyelets.start,
                last,
                -left_b,
                left_a + inner - left_b,
            )
        } else if left_a < 0.0 && link > 0 && !tied {
            (link, link - 1, eyelets.end - 1, first, -left_a, left_a - inner - left_b)
        } else {
            return;
        };
    let neighbour = if next > link {
        chain.point(chain.eyelets() - 1)
    } else {
        chain.point(2)
    };
    let towards = neighbour.map_or_else(Vec3::zeros, |neighbour| eyelet.to(&neighbour));
    if let Some(node) = nodes.get_mut(node) {
        let beyond = direction(towards, 1e-9) * past.min(0.5 * length(towards).max(EYELET));
        // Relative to the node's own coarse part, from which its displacement is measured.
        node.fine = (eyelet.coarse - node.coarse) + (eyelet.fine + beyond);
    }
    if let Some(eyelet) = course.eyelets.get_mut(moved) {
        eyelet.link = next;
    }
    if params.friction.is_some() {
        adhere(params, nodes, course, (moved, next), 0.5 * way);
    }
}

/// Lets the thread adhere at puncture `moved`, now in `link`, as strained as it was when its way there was `way` [m].
fn adhere(params: &Params, nodes: &[Place; NODES_MAX], course: &mut Course, (moved, link): (usize, usize), way: f32) {
    let older = course.through().iter().take(moved).rev();
    let start = moved - older.take_while(|eyelet| eyelet.link == link).count();
    let newer = course.through().iter().skip(moved + 1);
    let end = moved + 1 + newer.take_while(|eyelet| eyelet.link == link).count();
    let now = Chain::new((nodes, params.nodes), course, link, start..end).way(0, end - moved);
    if let Some(eyelet) = course.eyelets.get_mut(moved) {
        eyelet.grip.adhesion = eyelet.grip.adhesion.map(|adhesion| adhesion + (now - way));
    }
}
