//! What changes in a thread: places, velocities, and where it runs.

use super::chain::Chain;
use super::config::Params;
use super::course::{Course, Eyelet};
use super::friction::Grip;
use super::knot::tied_rest;
use crate::coupling::POINTS;
use crate::math::{Vec3, direction, length};

/// Most mass elements of a thread; a microcontroller has less memory.
pub const NODES_MAX: usize = if cfg!(target_os = "none") { 64 } else { 256 };

/// A position in two parts, `coarse + fine`, so that a displacement of a nanometre is not rounded away a decimetre from the origin:
/// half a unit in the last place of 0.1 m is 4 nm, which a link of 15 kN/m answers with 0.06 mN.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// The position to its own precision [m].
    pub coarse: Vec3,
    /// What is left of it [m].
    pub fine: Vec3,
}

impl Place {
    /// A place at `p`.
    #[must_use]
    pub fn new(p: Vec3) -> Self {
        Self {
            coarse: p,
            fine: Vec3::zeros(),
        }
    }

    /// The position, rounded [m].
    #[must_use]
    pub fn point(&self) -> Vec3 {
        self.coarse + self.fine
    }

    /// The vector from here to `other` [m].
    #[inline]
    #[must_use]
    pub fn to(&self, other: &Self) -> Vec3 {
        (other.coarse - self.coarse) + (other.fine - self.fine)
    }

    /// The same position with the rounding error of `coarse` alone in `fine`.
    pub(super) fn normalised(&self) -> Self {
        let coarse = self.point();
        Self {
            coarse,
            fine: (self.coarse - coarse) + self.fine,
        }
    }
}

/// The thread's state; only the first n entries have a meaning, the others stay zero.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Where the nodes are.
    pub nodes: [Place; NODES_MAX],
    /// Their velocities [m/s].
    pub velocity: [Vec3; NODES_MAX],
    /// The punctures that it runs through, and where they were.
    pub course: Course,
    /// Forces on the tissue's points, the tail's and then the eyelets', at the end of the last tick [N].
    pub load: [Vec3; POINTS],
}

/// Length of a laid link over its rest length: links right at the edge of taut would tug as they settle. Those that push would, too.
const SLACK: f32 = 0.99;

impl State {
    /// A thread at rest between `from` (the swage) and `to` (the tail): an arc that bulges towards `bulge` (unit length, across the
    /// line between the two); a straight line where the thread is too short for an arc. Its links are a hair short of taut, those of a thread that
    /// bends at rest.
    #[must_use]
    pub fn laid(params: &Params, from: Vec3, to: Vec3, bulge: Vec3) -> Self {
        let links = (params.nodes - 1) as f32;
        let span = length(to - from);
        let mut along = direction(to - from, 1e-6);
        if along == Vec3::zeros() {
            along = direction(bulge.cross(&Vec3::new(bulge.y, bulge.z, -bulge.x)), 1e-6);
        }
        let link = if params.bending.is_some() {
            params.rest
        } else {
            params.rest * SLACK
        };
        let (turn, step) = match arc(links, span / link) {
            Some(turn) => (turn, link),
            None => (0.0, span / links),
        };
        let mut state = Self {
            nodes: [Place::default(); NODES_MAX],
            velocity: [Vec3::zeros(); NODES_MAX],
            course: Course::default(),
            load: [Vec3::zeros(); POINTS],
        };
        let mut at = from;
        let mut heading = 0.5 * turn * (links - 1.0);
        for node in state.nodes.iter_mut().take(params.nodes) {
            *node = Place::new(at);
            let (sin, cos) = libm::sincosf(heading);
            at += (along * cos + bulge * sin) * step;
            heading -= turn;
        }
        state
    }

    /// Places [m] and velocities [m/s] of the nodes that there are.
    pub fn live(&self, params: &Params) -> impl Iterator<Item = (Vec3, Vec3)> + '_ {
        let nodes = self.nodes.iter().zip(&self.velocity).take(params.nodes);
        nodes.map(|(place, velocity)| (place.point(), *velocity))
    }

    /// Leads the thread through one more puncture, now at `place` [m]: the needle's swage has just passed it. Beyond
    /// [`PUNCTURES`](crate::coupling::PUNCTURES) it holds no more.
    pub fn lead_through(&mut self, place: Vec3) {
        if let Some(eyelet) = self.course.eyelets.get_mut(self.course.count) {
            *eyelet = Eyelet {
                place: Place::new(place),
                link: 0,
                grip: Grip::default(),
            };
            self.course.count += 1;
        }
    }

    /// Ties the thread at the last puncture: each part of the link there keeps the tension it has. Nothing is tied without effect `knot`.
    pub fn tie(&mut self, params: &Params) {
        let (Some(newest), None, Some(_)) = (self.course.through().last(), self.course.knot, params.knot) else {
            return;
        };
        let eyelets = self.course.within(newest.link, self.course.count);
        let chain = Chain::new((&self.nodes, params.nodes), &self.course, newest.link, eyelets);
        let [needle, behind, ..] = chain.strain(params, 0.0, None).tension;
        let tail_side = chain.length_from(1);
        let parts = [(chain.length_from(0) - tail_side, needle), (tail_side, behind)];
        self.course.knot = Some(parts.map(|(length, tension)| tied_rest(params, length, tension)));
        for eyelet in &mut self.course.eyelets {
            eyelet.grip = Grip::default();
        }
    }
}

/// The angle between neighbours among `links` equal chords of unit length that together span `span`; none where they cannot.
fn arc(links: f32, span: f32) -> Option<f32> {
    if span >= links {
        return None;
    }
    // The span falls from `links` to 0 as the chords go from a line to a closed polygon; bisection to the last bit of an f32.
    let (mut straight, mut closed) = (0.0_f32, 2.0 * core::f32::consts::PI / links);
    for _ in 0..30 {
        let turn = 0.5 * (straight + closed);
        let spanned = libm::sinf(0.5 * turn * links) / libm::sinf(0.5 * turn);
        if spanned > span {
            straight = turn;
        } else {
            closed = turn;
        }
    }
    Some(straight)
}
