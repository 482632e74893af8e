//! The wound's two faces: unilateral contact between facing nodes, and the width between the rims.
//!
//! Left and right face are node planes of the same rows and layers, so facing nodes differ by a constant index. Where the
//! predicted width g of a pair is negative, a spring of the penalty stiffness joins its x motion: f = −k g.

use crate::lattice::{Lattice, Tissue};
use crate::math::Vec3;
use core::ops::RangeInclusive;
use sutura_shared::scene::{STITCHES_MAX, Stitch, Wound};

/// Pairs of facing nodes.
pub const PAIRS_MAX: usize = 1024;

/// The two faces of the wound.
#[derive(Clone, Debug, PartialEq)]
pub struct Faces {
    /// Index of the left node of each pair.
    left: heapless::Vec<u16, PAIRS_MAX>,
    /// Index of the right node minus that of the left one.
    across: usize,
    /// Width at rest [m].
    rest: f32,
    /// Contact stiffness of a pair [N/m].
    pub penalty: f32,
    /// Columns along x, rows along y and those of the stitches.
    rims: Rims,
}

/// A side of the wound, and its face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Where x is less.
    Left,
    /// Where x is more.
    Right,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Rims {
    columns: [u32; 2],
    rows: [u32; 2],
    /// Lowest layer of the faces.
    floor: u32,
    /// The stitches' rows, each as row and fraction of the next.
    stitches: [Option<(u32, f32)>; STITCHES_MAX],
    /// First and last row of the mean.
    mean: [u32; 2],
}

/// Width between the upper rims [m], negative where they overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gap {
    /// At each stitch; zero where there is none.
    pub at_stitches: [f32; STITCHES_MAX],
    /// Mean over the rows between the end stitches, or over the wound's for one stitch.
    pub mean: f32,
}

/// How the wound's upper edges stand against each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Edges {
    /// Width between them [m], negative where they overlap.
    pub gap: f32,
    /// How much higher the right one stands than the left one [m].
    pub step: f32,
}

/// More pairs of facing nodes than [`PAIRS_MAX`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooManyPairs;

/// The faces of a wound in a lattice, and where `stitch` crosses it; at y = 0 without one.
///
/// # Errors
///
/// [`TooManyPairs`].
pub fn faces<const N: usize>(
    wound: &Wound,
    stitch: Option<&Stitch>,
    lattice: &Lattice<N>,
) -> Result<Faces, TooManyPairs> {
    let [left, right] = wound.faces.map(u32::from);
    let [first, last] = wound.rows.map(u32::from);
    let exists = |index: usize| lattice.mass.get(index).is_some_and(|m| *m > 0.0);
    let mut pairs = heapless::Vec::new();
    for k in u32::from(wound.floor)..lattice.nodes.get(2).copied().unwrap_or(0) {
        for j in first..=last {
            let (a, b) = (lattice.index([left, j, k]), lattice.index([right, j, k]));
            if exists(a) && exists(b) {
                pairs.push(a as u16).map_err(|_| TooManyPairs)?;
            }
        }
    }
    let (count, rows_m) = stitch.map_or((1, [0.0; STITCHES_MAX]), |stitch| {
        (usize::from(stitch.count), stitch.rows_m())
    });
    let [_, begin, _] = lattice.origin;
    let mut stitches = [None; STITCHES_MAX];
    for (stitch, y) in stitches.iter_mut().zip(rows_m).take(count) {
        let row = ((y - begin) / lattice.pitch).max(0.0);
        *stitch = Some((row as u32, row - (row as u32) as f32));
    }
    let mean = match (stitches.first(), stitches.get(count.saturating_sub(1))) {
        (Some(Some((low, part))), Some(Some((high, _)))) if count > 1 => [low + u32::from(*part > 0.0), *high],
        _ => [first, last],
    };
    Ok(Faces {
        left: pairs,
        across: (right - left) as usize,
        rest: (right - left) as f32 * lattice.pitch,
        penalty: wound.penalty_n_per_m,
        rims: Rims {
            columns: [left, right],
            rows: [first, last],
            floor: u32::from(wound.floor),
            stitches,
            mean,
        },
    })
}

impl Faces {
    /// Pairs of facing nodes, left and right.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.left
            .iter()
            .map(|left| (usize::from(*left), usize::from(*left) + self.across))
    }

    /// Columns from the left face to the right one.
    #[must_use]
    pub const fn across(&self) -> usize {
        self.across
    }

    /// The side that a place is on.
    #[must_use]
    pub fn side<const N: usize>(&self, lattice: &Lattice<N>, p: Vec3) -> Side {
        let [left, right] = self.rims.columns;
        let [origin, ..] = lattice.origin;
        let middle = origin + 0.5 * (left + right) as f32 * lattice.pitch;
        if p.x < middle { Side::Left } else { Side::Right }
    }

    /// x of a face where no node has moved [m].
    #[must_use]
    pub fn face<const N: usize>(&self, lattice: &Lattice<N>, side: Side) -> f32 {
        let ([left, right], [origin, ..]) = (self.rims.columns, lattice.origin);
        let column = match side {
            Side::Left => left,
            Side::Right => right,
        };
        origin + column as f32 * lattice.pitch
    }

    /// Node columns of a side, its face among them.
    #[must_use]
    pub const fn columns(&self, side: Side) -> RangeInclusive<u32> {
        let [left, right] = self.rims.columns;
        match side {
            Side::Left => 0..=left,
            Side::Right => right..=u32::MAX,
        }
    }

    /// x of a face at (y, z) of `p` [m], bilinear between its nodes; `None` beyond its rows, above its rim and below its floor. Nodes are
    /// found at rest, which errs by slope × their motion along the face.
    #[must_use]
    pub fn wall<const N: usize>(
        &self,
        side: Side,
        (lattice, tissue): (&Lattice<N>, &Tissue<N>),
        p: Vec3,
    ) -> Option<f32> {
        let Rims {
            columns: [left, right],
            rows: [first, last],
            floor,
            ..
        } = self.rims;
        let column = match side {
            Side::Left => left,
            Side::Right => right,
        };
        let [_, oy, oz] = lattice.origin;
        let (y, z) = ((p.y - oy) / lattice.pitch, (p.z - oz) / lattice.pitch);
        if y < first as f32 || y > last as f32 || z < floor as f32 {
            return None;
        }
        let (j, k) = ((y as u32).min(last.saturating_sub(1)), z as u32);
        let (fy, fz) = (y - j as f32, z - k as f32);
        let x = |j: u32, k: u32| {
            let node = lattice.index([column, j.min(last), k]);
            let exists = lattice.mass.get(node).is_some_and(|mass| *mass > 0.0);
            exists.then(|| lattice.place(tissue, node).x)
        };
        let along = |k| Some(x(j, k)? * (1.0 - fy) + x(j + 1, k)? * fy);
        Some(along(k)? * (1.0 - fz) + along(k + 1)? * fz)
    }

    /// The edges at a row of nodes; as at rest where the skin has no node on both sides.
    fn edges<const N: usize>(&self, lattice: &Lattice<N>, tissue: &Tissue<N>, row: u32) -> Edges {
        let place = |i| lattice.top(i, row).map(|node| lattice.place(tissue, node));
        let [left, right] = self.rims.columns.map(place);
        let rest = Edges {
            gap: self.rest,
            step: 0.0,
        };
        left.zip(right).map_or(rest, |(left, right)| Edges {
            gap: right.x - left.x,
            step: right.z - left.z,
        })
    }

    /// Width of a pair whose nodes have moved by these x displacements [m].
    #[must_use]
    pub fn width(&self, left: f32, right: f32) -> f32 {
        self.rest + (right - left)
    }
}

/// The edges row by row: place along the wound at rest [m], and how they stand there.
pub fn edges<const N: usize>(
    faces: &Faces,
    lattice: &Lattice<N>,
    tissue: &Tissue<N>,
) -> impl Iterator<Item = (f32, Edges)> {
    let ([first, last], [_, begin, _]) = (faces.rims.rows, lattice.origin);
    (first..=last).map(move |j| (begin + j as f32 * lattice.pitch, faces.edges(lattice, tissue, j)))
}

/// The edges at each stitch; level and with no gap where there is none.
pub fn at_stitches<const N: usize>(faces: &Faces, lattice: &Lattice<N>, tissue: &Tissue<N>) -> [Edges; STITCHES_MAX] {
    let between = |(row, part): (u32, f32)| {
        let [here, next] = [row, row + 1].map(|j| faces.edges(lattice, tissue, j));
        Edges {
            gap: here.gap * (1.0 - part) + next.gap * part,
            step: here.step * (1.0 - part) + next.step * part,
        }
    };
    faces
        .rims
        .stitches
        .map(|stitch| stitch.map_or_else(Edges::default, between))
}

/// Width between the rims now.
#[must_use]
pub fn gap<const N: usize>(faces: &Faces, lattice: &Lattice<N>, tissue: &Tissue<N>) -> Gap {
    let [first, last] = faces.rims.mean;
    let rows = (last.saturating_sub(first) + 1) as f32;
    let sum: f32 = (first..=last).map(|j| faces.edges(lattice, tissue, j).gap).sum();
    Gap {
        at_stitches: at_stitches(faces, lattice, tissue).map(|edges| edges.gap),
        mean: sum / rows,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;

    const N: usize = 256;

    /// Four columns by three rows in two layers 2 mm apart, cut between the second column and the third; at row j the right edge has moved
    /// by −j mm across and by j/10 mm upwards.
    #[test]
    fn edges_are_seen_row_by_row_and_between_rows() {
        let (mut lattice, mut tissue) = (Lattice::<N>::zeroed(), Tissue::<N>::zeroed());
        (lattice.nodes, lattice.pitch, lattice.origin) = ([4, 3, 2], 2e-3, [0.0, -2e-3, 0.0]);
        lattice.mass.fill(1.0);
        let layer = lattice.layer() as u32;
        for (column, top) in (1..).zip(lattice.top.iter_mut().take(12)) {
            *top = layer + column;
        }
        for j in 0..3 {
            let node = lattice.index([2, j, 1]);
            let [x, _, z] = &mut tissue.displacement;
            (x[node], z[node]) = (-1e-3 * j as f32, 1e-4 * j as f32);
        }
        let wound = Wound {
            faces: [1, 2],
            rows: [0, 2],
            floor: 1,
            penalty_n_per_m: 1.0,
        };
        let stitch = Stitch {
            a_m: [0.0, 5e-4],
            count: 1,
            spacing_m: 0.0,
            f0_n: [1.0; 4],
            under_m: 0.0,
            friction_n_per_m: 0.0,
            cutting_n: 0.0,
            tension_gain: 0.0,
        };
        let faces = faces(&wound, Some(&stitch), &lattice).unwrap();
        let near = |a: f32, b: f32| (a - b).abs() < 1e-9;
        for (j, (along, edges)) in edges(&faces, &lattice, &tissue).enumerate() {
            let j = j as f32;
            assert!(near(along, 2e-3 * j - 2e-3), "{along}");
            assert!(
                near(edges.gap, 2e-3 - 1e-3 * j) && near(edges.step, 1e-4 * j),
                "{edges:?}"
            );
        }
        // A quarter of the way from the second row to the third.
        let [here, none, _] = at_stitches(&faces, &lattice, &tissue);
        assert!(near(here.gap, 7.5e-4) && near(here.step, 1.25e-4), "{here:?}");
        assert_eq!(none, Edges::default());
        let gap = gap(&faces, &lattice, &tissue);
        assert!(near(gap.at_stitches[0], here.gap) && near(gap.mean, 1e-3), "{gap:?}");
    }
}
