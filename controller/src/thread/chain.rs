//! The link that runs through eyelets: a spring of several pieces, N_e to p₁, p₁ to p₂ … p_k to N₍e+1₎.
//!
//! Without friction it is one spring of their length |N_e − p₁| + |p₁ − p₂| + … + |p_k − N₍e+1₎| and one tension.

use core::ops::Range;

use super::config::Params;
use super::course::Course;
use super::friction::{Grip, rub};
use super::knot;
use super::link::{Piece, spring};
use super::state::{NODES_MAX, Place};
use crate::coupling::PUNCTURES;
use crate::math::{Mat3, Vec3, direction, length};

/// Most pieces of a link.
pub(super) const PIECES: usize = PUNCTURES + 1;
/// Most points of a link: both nodes and every eyelet.
pub(super) const CORNERS: usize = PUNCTURES + 2;

/// The pieces of one link in order from node a, on the needle's side, to node b; a piece's `along` is the way from a to b.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    /// Node a, the eyelets, node b.
    corners: [Place; CORNERS],
    pieces: [Piece; PIECES],
    /// How the thread holds at each eyelet, in order from node a.
    grips: [Grip; PUNCTURES],
    /// Pieces that there are.
    len: usize,
    /// The directions of both ends' pieces from their eyelets, unit length.
    pub(super) tangents: [Vec3; 2],
}

/// Tensions of a chain's pieces [N], and by piece and piece what they gain as the pieces become longer [N/m]: symmetric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Strain {
    pub(super) tension: [f32; PIECES],
    pub(super) stiffness: [[f32; PIECES]; PIECES],
}

impl Chain {
    /// Link `link` of `n` nodes, through `eyelets` of the course.
    pub(super) fn new(
        (nodes, n): (&[Place; NODES_MAX], usize),
        course: &Course,
        link: usize,
        eyelets: Range<usize>,
    ) -> Self {
        let mut corners = [Place::default(); CORNERS];
        let node = |index: usize| nodes.get(index).copied().into_iter();
        let through = course.through().get(eyelets.clone()).unwrap_or_default();
        let order = node(link).chain(through.iter().rev().map(|eyelet| eyelet.place));
        for (corner, place) in corners.iter_mut().zip(order.chain(node(link + 1))) {
            *corner = place;
        }
        let len = through.len() + 1;
        let mut grips = [Grip::default(); PUNCTURES];
        let held = through.iter().rev().map(|eyelet| eyelet.grip);
        grips.iter_mut().zip(held).for_each(|(grip, held)| *grip = held);
        let mut pieces = [Piece::default(); PIECES];
        for (piece, ends) in pieces.iter_mut().zip(corners.windows(2)).take(len) {
            if let [from, to] = ends {
                *piece = Piece::between(from.to(to));
            }
        }
        let mut chain = Self {
            corners,
            pieces,
            grips,
            len,
            tangents: [Vec3::zeros(); 2],
        };
        let before = course.before(nodes, link, &eyelets).copied();
        let after = course.after((nodes, n), link, &eyelets).copied();
        chain.fasten(before, after);
        chain
    }

    /// Both end pieces, from their eyelets to their nodes; behind the nodes the thread goes on to `before` and `after`.
    fn fasten(&mut self, before: Option<Place>, after: Option<Place>) {
        let (Some(first), Some(last)) = (self.point(1), self.point(self.eyelets())) else {
            return;
        };
        let (a, b) = (first.to(&self.a()), last.to(&self.b()));
        let (inwards_a, inwards_b) = (self.point(2), self.point(self.eyelets() - 1));
        let behind = |place: Option<Place>, inwards: Option<Place>, from: &Place| {
            let goes_on = place.map(|place| from.to(&place));
            let way = goes_on.or_else(|| inwards.map(|inwards| inwards.to(from)));
            direction(way.unwrap_or_default(), 1e-9)
        };
        let at_a = Piece::at_eyelet(a, behind(before, inwards_a, &first));
        let at_b = Piece::at_eyelet(b, behind(after, inwards_b, &last));
        self.tangents = [at_a.tangent, at_b.tangent];
        let len = self.len;
        if let Some(piece) = self.pieces.first_mut() {
            *piece = at_a.reversed();
        }
        if let Some(piece) = self.pieces.get_mut(len - 1) {
            *piece = at_b;
        }
    }

    /// How many eyelets it runs through.
    pub(super) const fn eyelets(&self) -> usize {
        self.len - 1
    }

    /// Node a.
    pub(super) fn a(&self) -> Place {
        let [a, ..] = self.corners;
        a
    }

    /// Node b.
    pub(super) fn b(&self) -> Place {
        self.point(self.len).unwrap_or_default()
    }

    /// Point `index` in order from node a.
    pub(super) fn point(&self, index: usize) -> Option<Place> {
        self.corners.get(index).copied()
    }

    /// The pieces.
    pub(super) fn pieces(&self) -> &[Piece] {
        self.pieces.get(..self.len).unwrap_or_default()
    }

    /// Length between the first eyelet and the last [m].
    pub(super) fn between(&self) -> f32 {
        let inner = self.pieces().iter().skip(1).take(self.len.saturating_sub(2));
        inner.map(|piece| piece.length).sum()
    }

    /// Length of the pieces from `from` on [m].
    pub(super) fn length_from(&self, from: usize) -> f32 {
        self.pieces().iter().skip(from).map(|piece| piece.length).sum()
    }

    /// How the thread holds at its eyelets.
    pub(super) fn grips(&self) -> &[Grip] {
        self.grips.get(..self.eyelets()).unwrap_or_default()
    }

    /// The way of the thread at an eyelet among the pieces from `from` on [m]: half of what is before it less half of what is behind.
    pub(super) fn way(&self, from: usize, eyelet: usize) -> f32 {
        0.5 * self.length_from(from) - self.length_from(eyelet)
    }

    /// Tensions of a link that slides, or that `knot` holds at its first eyelet.
    pub(super) fn strain(&self, params: &Params, slack: f32, knot: Option<[f32; 2]>) -> Strain {
        let mut strain = Strain {
            tension: [0.0; PIECES],
            stiffness: [[0.0; PIECES]; PIECES],
        };
        if let Some(rest) = knot {
            let tail_side = self.length_from(1);
            let length = [self.length_from(0) - tail_side, tail_side];
            let [(a, aa), (b, bb)] = knot::hold(params, length, rest, slack);
            strain.add(0..1, 0..1, aa);
            strain.add(1..self.len, 1..self.len, bb);
            strain.pull(0..1, a);
            strain.pull(1..self.len, b);
            rub(params, self, 1, &mut strain);
        } else {
            let (tension, stiffness) = spring(params.stiffness(), self.length_from(0) - params.rest, slack);
            strain.add(0..self.len, 0..self.len, stiffness);
            strain.pull(0..self.len, tension);
            rub(params, self, 0, &mut strain);
        }
        strain
    }

    /// Forces on its points [N], and −∂force/∂position by point and point [N/m].
    pub(super) fn forces(&self, strain: &Strain) -> Forces {
        let mut forces = Forces::default();
        let loaded = self.pieces().iter().zip(&strain.tension).zip(&strain.stiffness);
        for (i, ((piece, tension), stiffness)) in loaded.enumerate() {
            forces.pull(i, piece.along * *tension);
            // A spring that is held in compression for an iteration has no sideways stiffness.
            forces.couple([i, i], &(piece.bend * tension.max(0.0)));
            for (j, (other, stiffness)) in self.pieces().iter().zip(stiffness).enumerate() {
                forces.couple([i, j], &(piece.along * other.along.transpose() * *stiffness));
            }
        }
        let last = self.eyelets();
        if let (Some(piece), Some(tension)) = (self.pieces.get(last), strain.tension.get(last)) {
            forces.end = End {
                along: piece.along,
                tangent: piece.tangent,
                turn: piece.bend * tension.max(0.0),
            };
        }
        forces
    }
}

impl Strain {
    /// Pieces `rows` gain `stiffness` of tension as pieces `columns` become longer.
    fn add(&mut self, rows: Range<usize>, columns: Range<usize>, stiffness: f32) {
        for row in self.stiffness.get_mut(rows).unwrap_or_default() {
            let cells = row.get_mut(columns.clone()).unwrap_or_default();
            cells.iter_mut().for_each(|cell| *cell += stiffness);
        }
    }

    /// Pieces `pieces` pull with `tension` more.
    fn pull(&mut self, pieces: Range<usize>, tension: f32) {
        let tensions = self.tension.get_mut(pieces).unwrap_or_default();
        tensions.iter_mut().for_each(|sum| *sum += tension);
    }

    /// Parts the tensions from piece `from` on by `drag` at an eyelet: half more before it, half less behind.
    pub(super) fn part(&mut self, from: usize, eyelet: usize, drag: f32) {
        self.pull(from..eyelet, 0.5 * drag);
        self.pull(eyelet..PIECES, -0.5 * drag);
    }

    /// The same with a spring along the way at the eyelet.
    pub(super) fn hold(&mut self, from: usize, eyelet: usize, stiffness: f32) {
        let (before, behind) = (from..eyelet, eyelet..PIECES);
        self.add(before.clone(), before.clone(), 0.25 * stiffness);
        self.add(behind.clone(), behind.clone(), 0.25 * stiffness);
        self.add(before.clone(), behind.clone(), -0.25 * stiffness);
        self.add(behind, before, -0.25 * stiffness);
    }
}

/// Forces on the points of a chain, in order from node a, and their derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Forces {
    pub(super) on: [Vec3; CORNERS],
    pub(super) blocks: [[Mat3; CORNERS]; CORNERS],
    pub(super) end: End,
}

/// The last piece of a chain, through which alone node b is tied to all the points before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct End {
    along: Vec3,
    tangent: Vec3,
    /// What its tension does against turning [N/m].
    turn: Mat3,
}

/// Least slope of a piece's length along its tangent.
const STEEPEST: f32 = 0.1;

impl End {
    /// Splits the blocks U X_j of node b with the eyelets, of which `nearest` is what the piece turns about: gives U and leaves the X_j,
    /// none of which is large. Motion along the tangent turns nothing.
    pub(super) fn split(&self, blocks: &mut [Mat3; PUNCTURES], nearest: usize) -> Mat3 {
        let mut most = 0.0_f32;
        let square = self.along.dot(&self.along).max(f32::MIN_POSITIVE);
        // What node b feels along the piece as an eyelet moves [N/m].
        let pulls = |j: usize, block: &Mat3| {
            let turn = if j == nearest { self.turn } else { Mat3::zeros() };
            (block + turn).transpose() * self.along / square
        };
        for (j, block) in blocks.iter().enumerate() {
            most = most.max(length(pulls(j, block)));
        }
        let slope = self.along.dot(&self.tangent).max(STEEPEST);
        for (j, block) in blocks.iter_mut().enumerate() {
            let pull = pulls(j, block) / -most.max(f32::MIN_POSITIVE);
            *block = if j == nearest {
                Mat3::identity() + self.tangent * (pull - self.along).transpose() / slope
            } else {
                self.tangent * pull.transpose() / slope
            };
        }
        -(self.along * self.along.transpose() * most + self.turn)
    }
}

impl Default for Forces {
    fn default() -> Self {
        Self {
            on: [Vec3::zeros(); CORNERS],
            blocks: [[Mat3::zeros(); CORNERS]; CORNERS],
            end: End::default(),
        }
    }
}

impl Forces {
    /// Piece `piece` pulls its ends together by `pull`.
    fn pull(&mut self, piece: usize, pull: Vec3) {
        if let Some([from, to]) = self.on.get_mut(piece..piece + 2) {
            *from += pull;
            *to -= pull;
        }
    }

    /// Two pieces, or one, whose forces answer each other's motion with `block`.
    fn couple(&mut self, [i, j]: [usize; 2], block: &Mat3) {
        if let Some([from, to]) = self.blocks.get_mut(i..i + 2) {
            if let Some([near, far]) = from.get_mut(j..j + 2) {
                *near += block;
                *far -= block;
            }
            if let Some([near, far]) = to.get_mut(j..j + 2) {
                *near -= block;
                *far += block;
            }
        }
    }

    /// Block of points `r` and `c`.
    pub(super) fn block(&self, r: usize, c: usize) -> Mat3 {
        let row = self.blocks.get(r);
        row.and_then(|row| row.get(c)).copied().unwrap_or_default()
    }
}
