//! How a site is passed: the states and the geometry that moves between them.

use super::{Arc, Params, State};
use crate::coupling::Kernel;
use crate::lattice::{Lattice, Tissue};
use crate::math::{DT, Vec3};
use crate::surface::{height, kernel_at};

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

/// The tip presses on the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The point that the tip holds.
    pub point: Point,
    /// Where the point was when the tip met it [m].
    pub from: Vec3,
    /// Where the tip was at the end of the last tick, or when it met the point [m]: what it moved before is none of the point's.
    pub tip: Vec3,
}

/// The needle passes through the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hole {
    /// Constraint point A.
    pub point: Point,
    /// Arc length from the tip to A [m].
    pub from_tip: f32,
    /// Arc length at which the shaft adheres [m].
    pub adhesion: f32,
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
            Self::Passed(point) => Some(point),
        }
    }
}

/// Moves both sites by geometry alone: the tip meets the skin, the needle's ends pass the constraint points.
pub fn detect<const N: usize>(params: &Params, state: &mut State, arc: &Arc, lattice: &Lattice<N>, tissue: &Tissue<N>) {
    let (tip, tangent) = arc.tip();
    let surface = height(lattice, tissue, tip);
    let meet = || {
        let point = Point::new(kernel_at(lattice, tissue, tip, params.kernel), tip, tissue);
        if point.kernel.is_empty() {
            return Passage::Ahead;
        }
        Passage::Touch(Touch { point, from: tip, tip })
    };
    if let (Passage::Ahead, Some(surface)) = (state.left, surface)
        && tip.z < surface
    {
        state.left = meet();
    }
    let entered = matches!(state.left, Passage::Hole(_) | Passage::Passed(_));
    if let (true, Passage::Ahead, Some(surface)) = (entered, state.right, surface)
        && tangent.z > 0.0
        && tip.z > surface - params.under
        && tip.z < surface
    {
        state.right = meet();
    }
    for site in [&mut state.left, &mut state.right] {
        *site = slide(*site, arc, tissue);
    }
}

/// Moves the constraint point along the needle; the needle leaves at its tip or at its swage.
fn slide<const N: usize>(site: Passage, arc: &Arc, tissue: &Tissue<N>) -> Passage {
    let Passage::Hole(hole) = site else { return site };
    let from_tip = arc.nearest(hole.point.place(tissue)).from_tip;
    if from_tip < 0.0 {
        Passage::Ahead
    } else if from_tip > arc.length {
        Passage::Passed(hole.point)
    } else {
        Passage::Hole(Hole { from_tip, ..hole })
    }
}
