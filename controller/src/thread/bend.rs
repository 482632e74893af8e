//! Bending: node i between two links has the energy ½ (EI/l₀³) |x₍ᵢ₋₁₎ − 2xᵢ + x₍ᵢ₊₁₎|², the curvature's of a beam by central differences.
//!
//! It is quadratic, so the elimination carries it exactly; moved or turned as a whole the thread feels nothing of it. At the swage the beam
//! is clamped: behind N₀, a link away against the heading of the thread, is a virtual node, and the half cell of N₀ bends about that. Tail and
//! cut end are free to turn. A thread that bends also holds the length of its links against pushing, as a thread without stiffness, which gives
//! way sideways at once, cannot. Links that run through an eyelet neither bend, nor bend their neighbours, nor push.

use super::config::Params;
use super::link::Link;
use super::state::{NODES_MAX, Place};
use super::work::Ends;
use crate::math::{Mat3, Vec3};

/// Three nodes a, b, c in a row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Joint {
    /// EI/l₀³ [N/m]; 0 where the thread does not bend.
    pub(super) stiffness: f32,
    /// Force on a and c [N]; b has the opposite twice.
    pub(super) on_a: Vec3,
}

impl Joint {
    /// The joint of nodes `index` to `index + 2`.
    pub(super) fn new(stiffness: f32, nodes: &[Place; NODES_MAX], index: usize) -> Self {
        match nodes.get(index..index + 3) {
            Some([a, b, c]) => Self {
                stiffness,
                on_a: (b.to(a) + b.to(c)) * -stiffness,
            },
            _ => Self::default(),
        }
    }
}

/// The clamp of the first link, b at `d` from a at the swage: bending energy of half a cell.
pub(super) fn clamp(params: &Params, stiffness: f32, ends: &Ends, d: Vec3) -> Link {
    if ends.swage.is_none() {
        return Link::default();
    }
    let stiffness = 2.0 * stiffness;
    Link {
        on_a: (d - ends.heading * params.rest) * stiffness,
        block: Mat3::from_diagonal_element(stiffness),
    }
}
