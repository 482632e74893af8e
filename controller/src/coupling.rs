//! Where tool and thread hold the tissue: weighted points of the lattice, and what pulls on them.
//!
//! Needle and thread are condensed onto these points: together they answer a displacement of the points with
//! F = f − S·u, S symmetric and positive semidefinite. The tissue's solver adds WᵀSW to its operator and WᵀF to its load,
//! so both sides are solved at once and nothing is handed back and forth.

use crate::lattice::{Field, add, at};
use crate::math::{Mat3, Vec3};

/// Most punctures: three stitches of four, a to d and again, a microcontroller's one.
pub const PUNCTURES: usize = if cfg!(target_os = "none") { 4 } else { 12 };
/// Most points: the thread's tail and the punctures.
pub const POINTS: usize = PUNCTURES + 1;
/// The thread's tail.
pub const TAIL: usize = 0;
/// Puncture a, and whatever a tool without puncture touches.
pub const A: usize = 1;
/// Puncture b.
pub const B: usize = 2;
/// Puncture c.
pub const C: usize = 3;
/// Puncture d.
pub const D: usize = 4;
/// The first of the punctures of earlier stitches, which only the thread holds.
pub const SEWN: usize = 5;
/// Nodes of one kernel: a ball of 3.5 pitches about a lattice point holds 179 of them.
pub const KERNEL_MAX: usize = 192;

/// A weighted mean of lattice nodes: the material point that a tool or thread holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel {
    nodes: [u32; KERNEL_MAX],
    weights: [f32; KERNEL_MAX],
    len: usize,
}

impl Default for Kernel {
    fn default() -> Self {
        Self {
            nodes: [0; KERNEL_MAX],
            weights: [0.0; KERNEL_MAX],
            len: 0,
        }
    }
}

impl Kernel {
    /// Adds a node, of a higher index than those before; one more than [`KERNEL_MAX`] is left out.
    pub fn push(&mut self, node: u32, weight: f32) {
        if let (Some(n), Some(w)) = (self.nodes.get_mut(self.len), self.weights.get_mut(self.len)) {
            (*n, *w) = (node, weight);
            self.len += 1;
        }
    }

    /// The same with weights that sum to one.
    #[must_use]
    pub fn normalised(mut self) -> Self {
        let sum: f32 = self.weights.iter().sum();
        if sum > 0.0 {
            self.weights.iter_mut().for_each(|w| *w /= sum);
        }
        self
    }

    /// Whether it holds no node.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Nodes and weights.
    pub fn iter(&self) -> impl Iterator<Item = (usize, f32)> + '_ {
        let pairs = self.nodes.iter().zip(&self.weights).take(self.len);
        pairs.map(|(node, weight)| (*node as usize, *weight))
    }

    /// The weighted mean of a field.
    #[must_use]
    pub fn gather<const N: usize>(&self, field: &Field<N>) -> Vec3 {
        self.iter().map(|(node, w)| at(field, node) * w).sum()
    }

    /// Spreads a vector over the nodes: the transpose of [`Self::gather`].
    pub fn scatter<const N: usize>(&self, v: Vec3, field: &mut Field<N>) {
        for (node, w) in self.iter() {
            add(field, node, v * w);
        }
    }
}

/// What needle and thread do to the points in one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// The points; an empty kernel takes no part.
    pub kernels: [Kernel; POINTS],
    /// Force on each point at its predicted place [N].
    pub force: [Vec3; POINTS],
    /// S by point and point [N/m].
    pub stiffness: [[Mat3; POINTS]; POINTS],
}

impl Default for Coupling {
    fn default() -> Self {
        Self {
            kernels: [Kernel::default(); POINTS],
            force: [Vec3::zeros(); POINTS],
            stiffness: [[Mat3::zeros(); POINTS]; POINTS],
        }
    }
}

impl Coupling {
    /// Whether nothing holds or pulls the tissue.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        let soft = self.stiffness.iter().flatten().all(|s| *s == Mat3::zeros());
        soft && self.force.iter().all(|f| *f == Vec3::zeros())
    }

    /// Points up to the last that takes part; the work of all that follows is theirs alone.
    #[must_use]
    pub fn points(&self) -> usize {
        let last = self.kernels.iter().rposition(|kernel| !kernel.is_empty());
        last.map_or(0, |last| last + 1)
    }

    /// Weighted means of a field at the points.
    #[must_use]
    pub fn gather<const N: usize>(&self, field: &Field<N>) -> [Vec3; POINTS] {
        core::array::from_fn(|p| self.kernels.get(p).map_or_else(Vec3::zeros, |k| k.gather(field)))
    }

    /// Spreads vectors at the points over their nodes.
    pub fn scatter<const N: usize>(&self, v: &[Vec3; POINTS], field: &mut Field<N>) {
        for (kernel, v) in self.kernels.iter().zip(v) {
            kernel.scatter(*v, field);
        }
    }

    /// Force on the points that have moved by `u` from their predicted places, F − S·u [N].
    #[must_use]
    pub fn at(&self, u: &[Vec3; POINTS]) -> [Vec3; POINTS] {
        let given = self.product(u);
        core::array::from_fn(|p| self.force[p] - given[p])
    }

    /// S·u.
    #[must_use]
    pub fn product(&self, u: &[Vec3; POINTS]) -> [Vec3; POINTS] {
        product(&self.stiffness, self.points(), u)
    }
}

/// A block matrix over the first `len` points times vectors at them; nothing at the others.
#[must_use]
pub fn product(blocks: &[[Mat3; POINTS]; POINTS], len: usize, u: &[Vec3; POINTS]) -> [Vec3; POINTS] {
    let mut all = [Vec3::zeros(); POINTS];
    for (sum, row) in all.iter_mut().zip(blocks).take(len) {
        *sum = row.iter().zip(u).take(len).map(|(s, u)| s * u).sum();
    }
    all
}
