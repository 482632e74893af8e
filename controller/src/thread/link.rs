//! What one link does: T = EA (l/l₀ − 1) where it is taut, nothing where it is slack, and how that changes as its ends move.
//!
//! An ordinary link joins two nodes. The link at the eyelet p runs from N_e through p to N₍e+1₎: one spring of length
//! |N_e − p| + |N₍e+1₎ − p| and one tension, which is what a frictionless eyelet means.

use super::config::{EYELET, Params};
use crate::math::{Mat3, Vec3, length};

/// A straight piece of thread as seen from one end: its length, and how the length changes as the other end moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    /// Length [m]; below zero where the end has been pushed through the eyelet.
    pub(super) length: f32,
    /// The line on which the length is measured, unit length.
    pub(super) tangent: Vec3,
    /// Gradient of the length.
    pub(super) along: Vec3,
    /// Second derivative of the length [1/m].
    pub(super) bend: Mat3,
}

impl Piece {
    /// The piece that ends at `d` from its beginning.
    pub(super) fn new(d: Vec3) -> Self {
        let length = length(d);
        if length < 1e-9 {
            return Self::along(d, Vec3::zeros());
        }
        let along = d / length;
        Self {
            length,
            tangent: along,
            along,
            bend: across(along) / length,
        }
    }

    /// The piece from the eyelet to a node at `d`. A node closer than [`EYELET`] is measured along `tangent`, the direction of
    /// the thread behind it: its own direction turns over as it passes, the thread's does not. The length is then signed, and
    /// a node passes the eyelet without a step in any tension.
    pub(super) fn at_eyelet(d: Vec3, tangent: Vec3) -> Self {
        if d.dot(&d) < EYELET * EYELET {
            Self::along(d, tangent)
        } else {
            Self::new(d)
        }
    }

    fn along(d: Vec3, tangent: Vec3) -> Self {
        let bend = across(tangent) / EYELET;
        let aside = bend * d;
        Self {
            length: tangent.dot(&d) + 0.5 * d.dot(&aside),
            tangent,
            along: tangent + aside,
            bend,
        }
    }
}

/// Projection across the unit vector `along`.
fn across(along: Vec3) -> Mat3 {
    Mat3::identity() - along * along.transpose()
}

/// Forces and their derivatives of a link between nodes a and b. Forces are those on the node, the matrices are the blocks of
/// −∂force/∂position; where the link passes the eyelet [`Through`] has the eyelet's own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Link {
    /// Force on a [N].
    pub(super) on_a: Vec3,
    /// Force on b [N].
    pub(super) on_b: Vec3,
    /// Block a, a [N/m].
    pub(super) aa: Mat3,
    /// Block a, b [N/m].
    pub(super) ab: Mat3,
    /// Block b, b [N/m].
    pub(super) bb: Mat3,
    /// The eyelet's part.
    pub(super) through: Option<Through>,
}

/// The part of a link that acts on the eyelet p.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Through {
    /// Force on p [N].
    pub(super) on_p: Vec3,
    /// Block a, p [N/m].
    pub(super) ap: Mat3,
    /// Block b, p [N/m].
    pub(super) bp: Mat3,
    /// Block p, p [N/m].
    pub(super) pp: Mat3,
}

/// Tension and stiffness of a spring `elongation` longer than at rest; it holds from `-slack` of elongation on (0 for a thread).
pub(super) fn spring(stiffness: f32, elongation: f32, slack: f32) -> (f32, f32) {
    if elongation > -slack {
        (stiffness * elongation, stiffness)
    } else {
        (0.0, 0.0)
    }
}

/// The ordinary link, b at `d` from a.
pub(super) fn plain(params: &Params, d: Vec3, slack: f32) -> Link {
    let piece = Piece::new(d);
    let (tension, stiffness) = spring(params.stiffness(), piece.length - params.rest, slack);
    let block = pulled(&piece, tension, stiffness);
    let pull = piece.along * tension;
    Link {
        on_a: pull,
        on_b: -pull,
        aa: block,
        ab: -block,
        bb: block,
        through: None,
    }
}

/// The link that slides through the eyelet; `pieces` end at a and at b.
pub(super) fn sliding(params: &Params, pieces: &[Piece; 2], slack: f32) -> Link {
    let [a, b] = pieces;
    let elongation = a.length + b.length - params.rest;
    let (tension, stiffness) = spring(params.stiffness(), elongation, slack);
    let ab = a.along * b.along.transpose() * stiffness;
    joined(
        [a.along * tension, b.along * tension],
        [pulled(a, tension, stiffness), pulled(b, tension, stiffness)],
        ab,
    )
}

/// The link whose two pieces, of rest lengths `rest`, are tied at the eyelet.
pub(super) fn tied(params: &Params, pieces: &[Piece; 2], rest: [f32; 2]) -> Link {
    let [a, b] = pieces;
    let [a_rest, b_rest] = rest;
    let (a_tension, a_stiffness) = spring(tied_stiffness(params, a_rest), a.length - a_rest, 0.0);
    let (b_tension, b_stiffness) = spring(tied_stiffness(params, b_rest), b.length - b_rest, 0.0);
    joined(
        [a.along * a_tension, b.along * b_tension],
        [pulled(a, a_tension, a_stiffness), pulled(b, b_tension, b_stiffness)],
        Mat3::zeros(),
    )
}

/// Stiffness of a tied piece of rest length `rest` [N/m]. A knot is no stiffer than a tenth of a link of its thread.
pub(super) fn tied_stiffness(params: &Params, rest: f32) -> f32 {
    params.axial / rest.max(0.1 * params.rest)
}

/// −∂(pull)/∂(end) of one piece; a spring that is held in compression for an iteration has no sideways stiffness.
fn pulled(piece: &Piece, tension: f32, stiffness: f32) -> Mat3 {
    piece.along * piece.along.transpose() * stiffness + piece.bend * tension.max(0.0)
}

/// Two pieces with `pulls` towards their ends and blocks `own`, joined at the eyelet; `ab` is what they share.
fn joined(pulls: [Vec3; 2], own: [Mat3; 2], ab: Mat3) -> Link {
    let [a, b] = pulls;
    let [aa, bb] = own;
    let ap = -(aa + ab);
    let bp = -(bb + ab.transpose());
    Link {
        on_a: -a,
        on_b: -b,
        aa,
        ab,
        bb,
        through: Some(Through {
            on_p: a + b,
            ap,
            bp,
            pp: -(ap + bp),
        }),
    }
}
