//! What a tick of the thread works on: what holds it, and what `condense` leaves for `settle`.

use super::contact::Touch;
use super::course::Course;
use super::front::{Condensed, Crossing, Row};
use super::state::{NODES_MAX, Place};
use crate::coupling::PUNCTURES;
use crate::math::{Mat3, Vec3};

/// What holds the thread, at its predicted position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ends {
    /// The needle's swage [m]; none where the thread is cut from the needle.
    pub swage: Option<Vec3>,
    /// The direction in which the thread leaves the swage, unit length; of use with effect `thread-bending`.
    pub heading: Vec3,
    /// The tissue's point that holds N₍ₙ₋₁₎ [m]; none where the tail is free.
    pub tail: Option<Vec3>,
    /// The tissue's points through which the thread runs [m], in the order of its [`Course`]; only so many have a meaning.
    pub eyelets: [Vec3; PUNCTURES],
    /// About what the tissue answers a point's displacement with, springs and inertia [N/m]; more than zero. It steers the
    /// thread's own iterations and has no part in the result once they have converged.
    pub end_stiffness: f32,
}

/// What [`condense`](super::condense) leaves for [`settle`](super::settle).
#[derive(Clone, Debug, PartialEq)]
pub struct Work {
    /// Force of each node on the ground [N], after `settle`.
    pub reaction: [Vec3; NODES_MAX],
    pub(super) nodes: [Place; NODES_MAX],
    pub(super) course: Course,
    pub(super) ends: Ends,
    pub(super) reduced: Condensed,
    pub(super) touch: [Option<Touch>; NODES_MAX],
    pub(super) rows: [Row; NODES_MAX],
    /// What the displacement of each node has of that of the node after the next, negated; of use where the thread bends.
    pub(super) beyond: [Mat3; NODES_MAX],
    pub(super) crossings: [Crossing; PUNCTURES],
    pub(super) crossed: usize,
}

impl Default for Work {
    fn default() -> Self {
        Self {
            reaction: [Vec3::zeros(); NODES_MAX],
            nodes: [Place::default(); NODES_MAX],
            course: Course::default(),
            ends: Ends::default(),
            reduced: Condensed::default(),
            touch: [None; NODES_MAX],
            rows: [Row::default(); NODES_MAX],
            beyond: [Mat3::zeros(); NODES_MAX],
            crossings: [Crossing::default(); PUNCTURES],
            crossed: 0,
        }
    }
}
