//! The voxels' energy a³ U(J), U = ½ Λ (J − 1)² + ½ B max(0, J_b − J)², J the determinant of a voxel's mean edges over a.
//!
//! A mean edge E_i is the mean of the four edges along axis i, so a corner moves it by ±1/4 of its own way, and with the faces
//! C_x = E_y × E_z (and cyclic) a³ ∂J/∂x = Σ ± C_i/4: the force on a corner is −U′ of that.

use nalgebra::Matrix3;
use sutura_controller::lattice::Lattice;
use sutura_controller::law::BARRIER_BELOW;

use super::tangent::Form;
use super::{Field, V};

/// Voxels that resist a change of volume.
#[derive(Clone, Debug)]
pub(super) struct Voxels {
    /// Index distance from the lowest corner to each of the eight; bit i of a corner's number is its place along axis i.
    corners: [usize; 8],
    pitch: f64,
    /// Λ by lowest corner, zero where there is no voxel [Pa].
    stiffness: Vec<f64>,
    /// B likewise [Pa].
    barrier: Vec<f64>,
}

/// What a voxel answers its growth with.
struct Answer {
    /// U [Pa].
    energy: f64,
    /// U′ [Pa].
    pressure: f64,
    /// U″ [Pa].
    stiffness: f64,
}

/// One voxel as it is now.
#[derive(Clone, Copy, Debug)]
struct Shape {
    /// E_i [m].
    edges: [V; 3],
    /// C_i [m²].
    faces: [V; 3],
    /// J − 1.
    growth: f64,
}

impl Voxels {
    pub(super) fn new<const N: usize>(lattice: &Lattice<N>) -> Self {
        let origin = lattice.index([0; 3]);
        let n = lattice.len();
        Self {
            corners: std::array::from_fn(|c| {
                let c = c as u32;
                lattice.index([c & 1, c >> 1 & 1, c >> 2]) - origin
            }),
            pitch: f64::from(lattice.pitch),
            stiffness: lattice.volume.iter().take(n).map(|k| f64::from(*k)).collect(),
            barrier: lattice.barrier.iter().take(n).map(|k| f64::from(*k)).collect(),
        }
    }

    /// Lowest corners of the voxels.
    fn cells(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.stiffness.len()).filter(|low| self.is_there(*low))
    }

    /// Whether a node is a voxel's lowest corner.
    fn is_there(&self, low: usize) -> bool {
        let any = |k: &Vec<f64>| k.get(low).is_some_and(|k| *k > 0.0);
        any(&self.stiffness) || any(&self.barrier)
    }

    fn answer(&self, low: usize, growth: f64) -> Answer {
        let (volume, barrier) = (self.stiffness[low], self.barrier[low]);
        let under = (f64::from(BARRIER_BELOW) - 1.0 - growth).max(0.0);
        let acts = if under > 0.0 { barrier } else { 0.0 };
        Answer {
            energy: 0.5 * (volume * growth * growth + barrier * under * under),
            pressure: volume * growth - barrier * under,
            stiffness: volume + acts,
        }
    }

    fn shape(&self, low: usize, at: impl Fn(usize) -> V) -> Shape {
        let mut edges = mean_edges(self.corners.map(|corner| at(low + corner)));
        for (axis, edge) in edges.iter_mut().enumerate() {
            edge[axis] += self.pitch;
        }
        let [x, y, z] = edges;
        let faces = [y.cross(&z), z.cross(&x), x.cross(&y)];
        let [face, ..] = faces;
        Shape {
            edges,
            faces,
            growth: x.dot(&face) / self.pitch.powi(3) - 1.0,
        }
    }

    /// Adds the force on every node, and gives the energy [J].
    pub(super) fn elastic(&self, at: &Field, force: &mut Field) -> f64 {
        let mut energy = 0.0;
        for low in self.cells() {
            let shape = self.shape(low, |node| at.get(node));
            let answer = self.answer(low, shape.growth);
            for (number, corner) in self.corners.iter().enumerate() {
                force.add(low + corner, spread(shape.faces, number) * -answer.pressure);
            }
            energy += answer.energy * self.pitch.powi(3);
        }
        energy
    }

    /// Force on one node at displacements that `at` gives by node [N].
    pub(super) fn reaction(&self, node: usize, at: impl Fn(usize) -> V) -> V {
        let mut force = V::zeros();
        for (number, corner) in self.corners.iter().enumerate() {
            let Some(low) = node.checked_sub(*corner) else {
                continue;
            };
            if self.is_there(low) {
                let shape = self.shape(low, &at);
                force -= spread(shape.faces, number) * self.answer(low, shape.growth).pressure;
            }
        }
        force
    }
}

/// Mean of the four edges along each axis, from a vector at every corner.
fn mean_edges(corners: [V; 8]) -> [V; 3] {
    std::array::from_fn(|axis| {
        let signed = corners.iter().enumerate();
        signed.map(|(number, v)| v * share(number, axis)).sum()
    })
}

/// Σ ± v_i/4 at a corner.
fn spread(vectors: [V; 3], number: usize) -> V {
    let axes = vectors.iter().enumerate();
    axes.map(|(axis, v)| v * share(number, axis)).sum()
}

/// ∂E_axis over the way of a corner.
fn share(number: usize, axis: usize) -> f64 {
    if number >> axis & 1 == 1 { 0.25 } else { -0.25 }
}

/// Second derivative of the voxels' energy at a place.
pub(super) struct Swelling<'a> {
    voxels: &'a Voxels,
    shapes: Vec<(usize, Shape)>,
    form: Form,
}

impl<'a> Swelling<'a> {
    /// At displacements `at`; adds the part of each node's block to `blocks`.
    pub(super) fn new(voxels: &'a Voxels, at: &Field, form: Form, blocks: &mut [Matrix3<f64>]) -> Self {
        let shapes: Vec<_> = voxels
            .cells()
            .map(|low| (low, voxels.shape(low, |node| at.get(node))))
            .collect();
        for (low, shape) in &shapes {
            let rate = voxels.answer(*low, shape.growth).stiffness / voxels.pitch.powi(3);
            for (number, corner) in voxels.corners.iter().enumerate() {
                let slope = spread(shape.faces, number);
                blocks[low + corner] += slope * slope.transpose() * rate;
            }
        }
        Self { voxels, shapes, form }
    }

    /// Adds the voxels' part of the product.
    pub(super) fn apply(&self, p: &Field, product: &mut Field) {
        let Voxels { corners, pitch, .. } = self.voxels;
        for (low, shape) in &self.shapes {
            let answer = self.voxels.answer(*low, shape.growth);
            let moved = mean_edges(corners.map(|corner| p.get(low + corner)));
            let swelling: f64 = shape.faces.iter().zip(&moved).map(|(face, edge)| face.dot(edge)).sum();
            let mut pull = shape
                .faces
                .map(|face| face * (answer.stiffness * swelling / pitch.powi(3)));
            if self.form == Form::Exact {
                let ([x, y, z], [dx, dy, dz]) = (shape.edges, moved);
                let turned = [
                    dy.cross(&z) + y.cross(&dz),
                    dz.cross(&x) + z.cross(&dx),
                    dx.cross(&y) + x.cross(&dy),
                ];
                pull.iter_mut()
                    .zip(turned)
                    .for_each(|(pull, turned)| *pull += turned * answer.pressure);
            }
            for (number, corner) in corners.iter().enumerate() {
                product.add(low + corner, spread(pull, number));
            }
        }
    }
}
