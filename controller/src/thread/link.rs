//! What one link does: T = EA (l/l₀ − 1) where it is taut, nothing where it is slack, and how that changes as its ends move.

use super::config::{EYELET, Params};
use crate::math::{Mat3, Vec3, length};

/// A straight piece of thread as seen from one end: its length, and how the length changes as the other end moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

    /// The piece between two eyelets, `d` apart. Closer than [`EYELET`] it is rounded off, for eyelets may meet and part again:
    /// length and gradient have no step there. Ten times as far a linear step would already carry one eyelet past the other, so there
    /// the curvature along the piece goes over to that of the parabola through its ends, which is never less than the length.
    pub(super) fn between(d: Vec3) -> Self {
        let square = d.dot(&d);
        if square >= EYELET * EYELET {
            let piece = Self::new(d);
            let near = (1.0 / piece.length - 0.1 / EYELET).max(0.0) / 0.9;
            let bend = piece.bend + piece.along * piece.along.transpose() * near;
            return Self { bend, ..piece };
        }
        let along = d / EYELET;
        Self {
            length: 0.5 * (square / EYELET + EYELET),
            tangent: along,
            along,
            bend: Mat3::identity() / EYELET,
        }
    }

    /// The same seen from the other end.
    pub(super) fn reversed(&self) -> Self {
        Self {
            tangent: -self.tangent,
            along: -self.along,
            ..*self
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

/// What an ordinary link does to its nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Link {
    /// Force on a [N]; b has the opposite.
    pub(super) on_a: Vec3,
    /// −∂force/∂position of a node with itself; of one with the other it is the opposite [N/m].
    pub(super) block: Mat3,
}

/// Tension and stiffness of a spring `elongation` longer than at rest; it holds from `-slack` of elongation on (0 for a thread).
pub(super) fn spring(stiffness: f32, elongation: f32, slack: f32) -> (f32, f32) {
    if elongation > -slack {
        (stiffness * elongation, stiffness)
    } else {
        (0.0, 0.0)
    }
}

/// The ordinary link of a thread that bends, b at `d` from a: it holds its length both ways. Pushed, it would have its ends away from its
/// line; the tension's size in place of its sign keeps the block positive semidefinite and a step from overreaching.
pub(super) fn rod(params: &Params, d: Vec3) -> Link {
    let piece = Piece::new(d);
    let (tension, stiffness) = spring(params.stiffness(), piece.length - params.rest, f32::INFINITY);
    Link {
        on_a: piece.along * tension,
        block: piece.along * piece.along.transpose() * stiffness + piece.bend * tension.abs(),
    }
}

/// The ordinary link of a thread without bending stiffness, b at `d` from a.
pub(super) fn plain(params: &Params, d: Vec3, slack: f32) -> Link {
    let piece = Piece::new(d);
    let (tension, stiffness) = spring(params.stiffness(), piece.length - params.rest, slack);
    Link {
        on_a: piece.along * tension,
        // A spring that is held in compression for an iteration has no sideways stiffness.
        block: piece.along * piece.along.transpose() * stiffness + piece.bend * tension.max(0.0),
    }
}
