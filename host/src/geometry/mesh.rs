//! An indexed triangle surface, and what is wrong with it.
//!
//! A surface is treated as a chain of oriented triangles: its boundary is the sum of their directed edges, where opposite directions cancel.
//! That makes "closed" a statement about whole numbers, also for surfaces that are not manifold.

use std::collections::{HashMap, HashSet};
use std::fmt;

use super::Vec3;

/// A triangle surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Points, no two of them equal [file units, or mm after [`Mesh::scaled`]].
    pub vertices: Vec<Vec3>,
    /// Corners of each triangle, as indices into `vertices`, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// What is wrong with a surface without making it useless.
#[derive(Clone, Debug, PartialEq)]
pub enum Flaw {
    /// Triangles with two equal corners, which were left out.
    Degenerate {
        /// How many.
        count: usize,
        /// Index of the first in the file, from 0.
        first: usize,
    },
    /// Repeated triangles, of which one each was kept.
    Duplicate {
        /// How many were left out.
        count: usize,
        /// Index of the first that was left out, from 0.
        first: usize,
    },
    /// Directed edges without an opposite one: holes, seams or stray triangles.
    Open {
        /// How many.
        edges: usize,
    },
    /// The signed volume is negative: the triangles face inwards.
    InsideOut,
    /// The coordinates are so far from the origin that single precision rounds the shape.
    Coarse {
        /// Distance between neighbouring single-precision numbers there [file units].
        step: f64,
        /// Largest extent of the surface [file units].
        extent: f64,
    },
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Degenerate { count, first } => {
                write!(f, "triangle {first}: two equal corners, left out ({count} such)")
            }
            Self::Duplicate { count, first } => {
                write!(f, "triangle {first}: a repetition, left out ({count} such)")
            }
            Self::Open { edges } => {
                write!(
                    f,
                    "not closed, {edges} open edges: inside is taken to be where the winding number exceeds one half"
                )
            }
            Self::InsideOut => write!(
                f,
                "inside out, the triangles face inwards: the inside is taken to be the inside all the same"
            ),
            Self::Coarse { step, extent } => {
                write!(
                    f,
                    "far from the origin, where single precision rounds to {step}: coarse for a surface of size {extent:.4}"
                )
            }
        }
    }
}

/// Rounding of coordinates beyond this part of the extent is worth a warning: a tenth of a cell at a thousand cells.
const COARSE: f64 = 1e-4;

impl Mesh {
    /// Joins equal corners of loose triangles, and leaves out triangles with two equal corners and repeated ones.
    ///
    /// A thin triangle with three different corners stays, though its area be zero: leaving it out would open the edges of its neighbours.
    #[must_use]
    pub fn from_corners(corners: &[[Vec3; 3]]) -> (Self, Vec<Flaw>) {
        let mut mesh = Self::default();
        let mut index_of = HashMap::new();
        let mut seen = HashSet::new();
        let (mut degenerate, mut duplicate) = (Tally::default(), Tally::default());
        for (index, points) in corners.iter().enumerate() {
            let triangle = points.map(|p| {
                // Adding zero turns -0 into 0, so that the two are one corner.
                let p = p.add_scalar(0.0);
                *index_of
                    .entry([p.x.to_bits(), p.y.to_bits(), p.z.to_bits()])
                    .or_insert_with(|| {
                        mesh.vertices.push(p);
                        mesh.vertices.len() as u32 - 1
                    })
            });
            let [a, b, c] = triangle;
            if a == b || b == c || c == a {
                degenerate.add(index);
            } else if !seen.insert(smallest_first(triangle)) {
                duplicate.add(index);
            } else {
                mesh.triangles.push(triangle);
            }
        }
        let mut flaws = Vec::new();
        if degenerate.count > 0 {
            flaws.push(Flaw::Degenerate {
                count: degenerate.count,
                first: degenerate.first,
            });
        }
        if duplicate.count > 0 {
            flaws.push(Flaw::Duplicate {
                count: duplicate.count,
                first: duplicate.first,
            });
        }
        (mesh, flaws)
    }

    /// The three corners of each triangle.
    pub fn corners(&self) -> impl Iterator<Item = [Vec3; 3]> {
        self.triangles.iter().map(|t| t.map(|v| self.vertices[v as usize]))
    }

    /// The same surface with every point moved by `f`, which must keep orientation (no mirror).
    #[must_use]
    pub fn mapped(&self, f: impl Fn(Vec3) -> Vec3) -> Self {
        Self {
            vertices: self.vertices.iter().map(|&p| f(p)).collect(),
            triangles: self.triangles.clone(),
        }
    }

    /// The same surface `factor` times as large, from units of a file to millimetres.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        self.mapped(|p| p * factor)
    }

    /// Smallest and largest corner of the box around the used points; `None` without triangles.
    #[must_use]
    pub fn bounds(&self) -> Option<[Vec3; 2]> {
        self.corners().flatten().fold(None, |bounds, p| match bounds {
            None => Some([p, p]),
            Some([low, high]) => Some([low.inf(&p), high.sup(&p)]),
        })
    }

    /// Volume inside, positive where triangles face outwards [cubed units of the vertices]: Σ a·(b × c)/6, about the middle of its box.
    #[must_use]
    pub fn signed_volume(&self) -> f64 {
        let from = self.bounds().map_or_else(Vec3::zeros, |[low, high]| (low + high) / 2.0);
        self.corners()
            .map(|[a, b, c]| (a - from).dot(&(b - from).cross(&(c - from))) / 6.0)
            .sum()
    }

    /// Area of all triangles [squared units of the vertices].
    #[must_use]
    pub fn area(&self) -> f64 {
        self.corners()
            .map(|[a, b, c]| (b - a).cross(&(c - a)).norm() / 2.0)
            .sum()
    }

    /// Directed edges (from, to) that no opposite edge cancels, in the direction of their triangle: the boundary of the chain.
    #[must_use]
    pub fn open_edges(&self) -> Vec<[u32; 2]> {
        // Edges are sorted into buckets by their smaller end; a bucket then holds a handful, and cancelling within it is cheap.
        let mut start = vec![0_u32; self.vertices.len() + 1];
        for [a, b] in self.directed_edges() {
            start[a.min(b) as usize + 1] += 1;
        }
        let mut total = 0;
        for s in &mut start {
            total += *s;
            *s = total;
        }
        let mut place = start.clone();
        let mut sorted = vec![[0_u32; 2]; total as usize];
        for [a, b] in self.directed_edges() {
            let slot = &mut place[a.min(b) as usize];
            sorted[*slot as usize] = [a, b];
            *slot += 1;
        }
        let mut open = Vec::new();
        for bucket in start.windows(2) {
            let first_of_bucket = open.len();
            for &[a, b] in &sorted[bucket[0] as usize..bucket[1] as usize] {
                match open[first_of_bucket..].iter().position(|&edge| edge == [b, a]) {
                    Some(opposite) => drop(open.swap_remove(first_of_bucket + opposite)),
                    None => open.push([a, b]),
                }
            }
        }
        open
    }

    fn directed_edges(&self) -> impl Iterator<Item = [u32; 2]> {
        self.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
    }

    /// What is wrong with the surface as a whole: open edges, orientation, rounding.
    #[must_use]
    pub fn survey(&self) -> Vec<Flaw> {
        let mut flaws = Vec::new();
        let edges = self.open_edges().len();
        if edges > 0 {
            flaws.push(Flaw::Open { edges });
        }
        // A few loose triangles have no inside to speak of.
        if self.signed_volume() < 0.0 && edges < self.triangles.len() {
            flaws.push(Flaw::InsideOut);
        }
        if let Some([low, high]) = self.bounds() {
            let step = low.amax().max(high.amax()) as f32;
            let step = f64::from(step.next_up() - step);
            let extent = (high - low).amax();
            if step > COARSE * extent {
                flaws.push(Flaw::Coarse { step, extent });
            }
        }
        flaws
    }
}

/// How many, and which came first.
#[derive(Default)]
struct Tally {
    count: usize,
    first: usize,
}

impl Tally {
    fn add(&mut self, index: usize) {
        if self.count == 0 {
            self.first = index;
        }
        self.count += 1;
    }
}

/// The same triangle, same orientation, beginning at its smallest index.
fn smallest_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The surface of the unit cube moved by `at`, facing outwards.
    pub(crate) fn cube(at: Vec3) -> Mesh {
        let p = |i: usize| at + Vec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let corners: Vec<_> = quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[p(a), p(b), p(c)], [p(a), p(c), p(d)]])
            .collect();
        Mesh::from_corners(&corners).0
    }

    #[test]
    fn cube_is_closed_with_unit_volume_and_six_unit_faces() {
        let cube = cube(Vec3::new(3.0, -2.0, 5.0));
        assert_eq!((cube.vertices.len(), cube.triangles.len()), (8, 12));
        assert!((cube.signed_volume() - 1.0).abs() < 1e-14);
        assert!((cube.area() - 6.0).abs() < 1e-14);
        assert_eq!(cube.survey(), []);
    }

    #[test]
    fn a_missing_triangle_opens_its_three_edges() {
        let mut cube = cube(Vec3::zeros());
        let [a, b, c] = cube.triangles.remove(5);
        let mut open = cube.open_edges();
        let mut expected = vec![[b, a], [c, b], [a, c]];
        open.sort_unstable();
        expected.sort_unstable();
        assert_eq!(open, expected);
    }

    #[test]
    fn degenerate_and_repeated_triangles_are_left_out_and_counted() {
        let p = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let whole = [p(0.0, 0.0), p(1.0, 0.0), p(0.0, 1.0)];
        let turned = [whole[1], whole[2], whole[0]];
        let flat = [p(0.0, 0.0), p(-0.0, 0.0), p(0.0, 1.0)];
        let (mesh, flaws) = Mesh::from_corners(&[whole, flat, turned]);
        assert_eq!(mesh.triangles.len(), 1);
        assert_eq!(
            flaws,
            [
                Flaw::Degenerate { count: 1, first: 1 },
                Flaw::Duplicate { count: 1, first: 2 }
            ]
        );
    }

    #[test]
    fn inside_out_and_far_away_are_noticed() {
        let mut inverted = cube(Vec3::zeros());
        inverted.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        assert_eq!(inverted.survey(), [Flaw::InsideOut]);
        // At 2^20 single-precision numbers are 2^-3 apart.
        let far = cube(Vec3::new(f64::from(1 << 20) + 1.0, 0.0, 0.0));
        assert_eq!(
            far.survey(),
            [Flaw::Coarse {
                step: 0.125,
                extent: 1.0
            }]
        );
    }
}
