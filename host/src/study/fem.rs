//! Finite elements of small strain: a box of equal cubes, eight nodes each, displacements trilinear within a cube.
//!
//! K = ∫ 2G ε_dev : ε_dev + κ ε̄_vol² with the deviatoric strain by 2 × 2 × 2 Gauss points, where it is exact, and the change of volume
//! ε̄_vol as its mean over the cube (B̄, Hughes 1980): cubes whose every point had to keep its volume would lock as ν tends to 1/2.
//! On cubes one 24 × 24 matrix serves all. Nothing here is shared with the lattice but vectors and conjugate gradients.

use nalgebra::{SMatrix, SVector};

use super::double::{Field, NoEquilibrium, Stiffness, relax};

/// Corners of a cube; bit i of a corner's number is its place along axis i.
const CORNERS: usize = 8;
/// Components of the displacements of a cube's corners, three by three.
const COMPONENTS: usize = 3 * CORNERS;
/// Place of the Gauss points on either side of the middle, of an edge from 0 to 1: (1 ∓ 1/√3)/2.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

type Element = SMatrix<f64, COMPONENTS, COMPONENTS>;
/// Slopes along x, y, z of the eight shape functions.
type Slopes = [[f64; 3]; CORNERS];

/// A linear, isotropic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastic {
    /// E [Pa].
    pub young_pa: f64,
    /// ν, below 1/2.
    pub poisson: f64,
}

/// A box of cubes and what of it is held.
#[derive(Clone, Debug)]
pub struct Solid {
    /// Nodes along x, y, z; x is fastest.
    nodes: [usize; 3],
    element: Element,
    /// Reciprocal diagonal of K.
    inverse: [Vec<f64>; 3],
    free: [Vec<bool>; 3],
}

impl Solid {
    /// A box of `cells` cubes of edge `pitch_m` [m] of which nothing is held.
    #[must_use]
    pub fn new(cells: [usize; 3], pitch_m: f64, material: Elastic) -> Self {
        let nodes = cells.map(|cells| cells + 1);
        let n = nodes.iter().product();
        let mut solid = Self {
            nodes,
            element: element(material) * pitch_m,
            inverse: std::array::from_fn(|_| vec![0.0; n]),
            free: std::array::from_fn(|_| vec![true; n]),
        };
        let diagonal = solid.element.diagonal();
        for low in solid.cubes() {
            for (corner, offset) in solid.offsets().into_iter().enumerate() {
                for (axis, sum) in solid.inverse.iter_mut().enumerate() {
                    sum[low + offset] += diagonal[3 * corner + axis];
                }
            }
        }
        let sums = solid.inverse.iter_mut().flatten();
        sums.for_each(|sum| *sum = 1.0 / *sum);
        solid
    }

    /// Index of node (i, j, k).
    #[must_use]
    pub const fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        let [nx, ny, _] = self.nodes;
        (k * ny + j) * nx + i
    }

    /// Every node with its index.
    pub fn nodes(&self) -> impl Iterator<Item = ([usize; 3], usize)> + use<> {
        let [nx, ny, nz] = self.nodes;
        (0..nx * ny * nz).map(move |n| ([n % nx, n / nx % ny, n / (nx * ny)], n))
    }

    /// Holds the components that `held` says of node (i, j, k), and no others.
    pub fn hold(&mut self, held: impl Fn([usize; 3]) -> [bool; 3]) {
        for (node, index) in self.nodes() {
            for (free, held) in self.free.iter_mut().zip(held(node)) {
                free[index] = !held;
            }
        }
    }

    /// The displacement that `of` gives of node (i, j, k) [m].
    #[must_use]
    pub fn field(&self, of: impl Fn([usize; 3]) -> [f64; 3]) -> Field {
        let mut field = Field::zeros(self.nodes.iter().product());
        for (node, index) in self.nodes() {
            field.set(index, of(node).into());
        }
        field
    }

    /// Moves the free components of `at` to where ½ uᵀKu − fᵀu is least under the `load` f [N], and gives the elastic energy [J].
    ///
    /// # Errors
    /// What is held does not hold the body.
    pub fn relax(&self, load: &Field, at: &mut Field) -> Result<f64, NoEquilibrium> {
        relax(self, at, load)
    }

    /// Lowest corners of the cubes.
    fn cubes(&self) -> impl Iterator<Item = usize> + use<> {
        let cells = self.nodes.map(|nodes| nodes - 1);
        self.rows().flat_map(move |first| (0..cells[0]).map(move |i| first + i))
    }

    /// Lowest corner of the first cube of each row along x.
    fn rows(&self) -> impl Iterator<Item = usize> + use<> {
        let [nx, ny, nz] = self.nodes;
        (0..nz - 1).flat_map(move |k| (0..ny - 1).map(move |j| (k * ny + j) * nx))
    }

    /// Index distance from the lowest corner of a cube to each of the eight.
    fn offsets(&self) -> [usize; CORNERS] {
        std::array::from_fn(|corner| self.index([corner & 1, corner >> 1 & 1, corner >> 2]))
    }
}

impl Stiffness for Solid {
    /// Row by row of cubes, whose corners are eight contiguous runs of nodes.
    fn apply(&self, p: &Field, product: &mut Field) {
        product.clear();
        let cubes = self.nodes[0] - 1;
        let offsets = self.offsets();
        let mut pull = vec![0.0; cubes];
        for first in self.rows() {
            for to in 0..COMPONENTS {
                pull.fill(0.0);
                for from in 0..COMPONENTS {
                    let k = self.element[(to, from)];
                    let start = first + offsets[from / 3];
                    let moved = &p.parts[from % 3][start..start + cubes];
                    pull.iter_mut().zip(moved).for_each(|(pull, u)| *pull += k * u);
                }
                let start = first + offsets[to / 3];
                let target = &mut product.parts[to % 3][start..start + cubes];
                target.iter_mut().zip(&pull).for_each(|(q, pull)| *q += pull);
            }
        }
    }

    fn precondition(&self, r: &Field, z: &mut Field) {
        for ((z, r), inverse) in z.parts.iter_mut().zip(&r.parts).zip(&self.inverse) {
            for ((z, r), inverse) in z.iter_mut().zip(r).zip(inverse) {
                *z = r * inverse;
            }
        }
    }

    fn free(&self) -> &[Vec<bool>; 3] {
        &self.free
    }
}

/// K of a cube of edge 1; of one of edge a it is a times that.
fn element(Elastic { young_pa, poisson }: Elastic) -> Element {
    let shear = young_pa / (2.0 * (1.0 + poisson));
    let bulk = young_pa / (3.0 * (1.0 - 2.0 * poisson));
    let mut sum = Element::zeros();
    for point in 0..CORNERS {
        let place = std::array::from_fn(|axis| GAUSS[point >> axis & 1]);
        for strain in deviator(slopes(place)) {
            sum += strain * strain.transpose() * (2.0 * shear / CORNERS as f64);
        }
    }
    // The mean of a trilinear function's slope is the slope in the middle.
    let swelling = swelling(slopes([0.5; 3]));
    sum + swelling * swelling.transpose() * bulk
}

/// Slopes of the shape functions Π (x_i or 1 − x_i) at a place in the cube from 0 to 1.
fn slopes(place: [f64; 3]) -> Slopes {
    std::array::from_fn(|corner| {
        let upper = |axis: usize| corner >> axis & 1 == 1;
        let part = |axis: usize| if upper(axis) { place[axis] } else { 1.0 - place[axis] };
        std::array::from_fn(|axis| {
            let sign = if upper(axis) { 1.0 } else { -1.0 };
            sign * part((axis + 1) % 3) * part((axis + 2) % 3)
        })
    })
}

/// ε_xx + ε_yy + ε_zz as a row over the corners' displacements.
fn swelling(slopes: Slopes) -> SVector<f64, COMPONENTS> {
    SVector::from_fn(|component, _| slopes[component / 3][component % 3])
}

/// Rows whose squares add up to ε_dev : ε_dev: three on the diagonal, and √2 times three off it.
fn deviator(slopes: Slopes) -> [SVector<f64, COMPONENTS>; 6] {
    let along = |axis: usize| {
        SVector::from_fn(|component, _| {
            if component % 3 == axis {
                slopes[component / 3][axis]
            } else {
                0.0
            }
        }) - swelling(slopes) / 3.0
    };
    let across = |a: usize, b: usize| {
        SVector::from_fn(|component, _| {
            let slope = slopes[component / 3];
            let gamma = match component % 3 {
                axis if axis == a => slope[b],
                axis if axis == b => slope[a],
                _ => 0.0,
            };
            gamma * std::f64::consts::FRAC_1_SQRT_2
        })
    };
    [along(0), along(1), along(2), across(0, 1), across(1, 2), across(2, 0)]
}

#[cfg(test)]
mod tests;
