//! How a site is passed: its states, and the material points in them.

use super::Arc;
use crate::coupling::Kernel;
use crate::lattice::Tissue;
use crate::math::{DT, Vec3};

/// A material point of the tissue: a weighted mean of nodes with an offset that is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Nodes and weights.
    pub kernel: Kernel,
    /// Place of the point when no node has moved, patch frame [m].
    pub rest: Vec3,
}

impl Point {
    /// The point that is at `place` now, held by `kernel`.
    #[must_use]
    pub fn new<const N: usize>(kernel: Kernel, place: Vec3, tissue: &Tissue<N>) -> Self {
        Self {
            kernel,
            rest: place - kernel.gather(&tissue.displacement),
        }
    }

    /// Where it is [m].
    #[must_use]
    pub fn place<const N: usize>(&self, tissue: &Tissue<N>) -> Vec3 {
        self.rest + self.kernel.gather(&tissue.displacement)
    }

    /// Where it will be at the end of the tick if nothing changes its velocity [m].
    #[must_use]
    pub fn predicted<const N: usize>(&self, tissue: &Tissue<N>) -> Vec3 {
        self.place(tissue) + self.kernel.gather(&tissue.velocity) * DT
    }
}

/// The tip presses on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The point that the tip holds.
    pub point: Point,
    /// Where the point was when the tip met it [m].
    pub from: Vec3,
    /// Force at which the surface gives way [N]; `None` for a tool that only presses.
    pub f0: Option<f32>,
}

/// The needle passes through a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hole {
    /// Constraint point A.
    pub point: Point,
    /// Arc length from the tip to A [m].
    pub from_tip: f32,
    /// Arc length at which the shaft adheres [m].
    pub adhesion: f32,
    /// Length of the track that the tip has cut beyond A [m].
    pub cut: f32,
}

/// A hole that the needle has been drawn back out of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// Where the surface is open.
    pub point: Point,
    /// Length of the cut beyond it [m].
    pub cut: f32,
}

/// State of one site.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Passage {
    /// Not reached.
    #[default]
    Ahead,
    /// The tip presses.
    Touch(Touch),
    /// The needle passes.
    Hole(Hole),
    /// The needle has been drawn back.
    Track(Track),
    /// The needle has passed; the point is where the thread runs.
    Passed(Point),
}

impl Passage {
    /// The tissue point of the site, once there is one.
    #[must_use]
    pub const fn point(&self) -> Option<&Point> {
        match self {
            Self::Ahead => None,
            Self::Touch(touch) => Some(&touch.point),
            Self::Hole(hole) => Some(&hole.point),
            Self::Track(track) => Some(&track.point),
            Self::Passed(point) => Some(point),
        }
    }

    /// Whether needle or thread goes through.
    #[must_use]
    pub const fn is_through(&self) -> bool {
        matches!(self, Self::Hole(_) | Self::Passed(_))
    }

    /// Whether neither needle nor thread is at the site.
    #[must_use]
    pub const fn is_out(&self) -> bool {
        matches!(self, Self::Ahead | Self::Track(_))
    }

    /// Arc length from the tip to the site while the needle passes it [m].
    #[must_use]
    pub const fn from_tip(&self) -> Option<f32> {
        match self {
            Self::Hole(hole) => Some(hole.from_tip),
            _ => None,
        }
    }

    /// The constraint point slid along the needle; the needle leaves at its tip or at its swage.
    #[must_use]
    pub fn slid<const N: usize>(self, arc: &Arc, tissue: &Tissue<N>) -> Self {
        let Self::Hole(hole) = self else { return self };
        let from_tip = arc.nearest(hole.point.place(tissue)).from_tip;
        let cut = hole.cut.max(from_tip);
        if from_tip < 0.0 {
            Self::Track(Track { point: hole.point, cut })
        } else if from_tip > arc.length {
            Self::Passed(hole.point)
        } else {
            Self::Hole(Hole { from_tip, cut, ..hole })
        }
    }
}
