//! What a block is put through.

use nalgebra::{Matrix2, Vector2, Vector3};

use super::super::block::Block;
use super::super::double::{Field, Model, NoEquilibrium, V};

/// Newton steps after which the sides of a block will not come to rest.
const SIDE_STEPS: usize = 100;
/// What is left of the sides' stress, over the stress along the block.
const SIDE_PULL: f64 = 1e-9;
/// Strain of the sides over which a difference stands for a slope.
const SIDE_STRAIN: f64 = 1e-7;

/// A block in double precision, with its nodes and its size.
pub(super) struct Probe {
    model: Model,
    nodes: Vec<Node>,
    /// Lengths along x, y, z [m].
    size: V,
    /// [kg/m³].
    density: f64,
}

/// A node at rest.
struct Node {
    index: usize,
    /// From the middle of the block [m].
    place: V,
    /// −1 on the lower face across an axis, 1 on the upper one, else 0.
    face: Vector3<i8>,
}

/// What small strains show; in SI units.
pub(super) struct Elasticity {
    /// E along x, y, z [Pa].
    pub(super) young: V,
    /// ν, mean over stretches along all axes and both sides.
    pub(super) poisson: f64,
    /// G, mean over the three planes [Pa].
    pub(super) shear: f64,
    /// √(C11/ρ), mean over the axes [m/s].
    pub(super) wave: f64,
    /// Stiffness in bending along x across the thickness z, over E b h³/12.
    pub(super) bending: f64,
}

impl Probe {
    pub(super) fn new(block: &Block) -> Self {
        let lattice = &block.lattice;
        let model = Model::new(lattice, &block.material);
        let pitch = f64::from(lattice.pitch);
        let size = Vector3::from(lattice.nodes).map(|n| f64::from(n - 1) * pitch);
        let [nx, ny, nz] = lattice.nodes;
        let box_nodes = (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])));
        let nodes: Vec<_> = box_nodes
            .map(|at| Node {
                index: lattice.index(at),
                place: Vector3::from(at).map(|n| f64::from(n) * pitch) - size / 2.0,
                face: Vector3::from(std::array::from_fn(|axis| {
                    i8::from(at[axis] + 1 == lattice.nodes[axis]) - i8::from(at[axis] == 0)
                })),
            })
            .collect();
        let mass: f64 = nodes.iter().map(|node| f64::from(lattice.mass[node.index])).sum();
        Self {
            model,
            nodes,
            size,
            density: mass / size.product(),
        }
    }

    /// Everything that small strains show.
    pub(super) fn measure(&self) -> Result<Elasticity, NoEquilibrium> {
        let mut young = V::zeros();
        let mut poisson = 0.0;
        for axis in 0..3 {
            let (modulus, sides) = self.stretch(axis)?;
            young[axis] = modulus;
            poisson += sides / 3.0;
        }
        let [mut shear, mut stiff] = [0.0; 2];
        for axis in 0..3 {
            let next = (axis + 1) % 3;
            shear += self.affine(|place| unit(axis) * place[next])? / 3.0;
            stiff += self.affine(|place| unit(axis) * place[axis])? / 3.0;
        }
        Ok(Elasticity {
            young,
            poisson,
            shear,
            wave: (stiff / self.density).sqrt(),
            bending: self.bend()? / young.x,
        })
    }

    /// Largest stable step of symplectic Euler for the block left to itself [s].
    pub(super) fn stable_step_s(&self) -> f64 {
        2.0 / self.held(|_| [false; 3]).fastest()
    }

    /// E and ν from unit strain along an axis.
    fn stretch(&self, axis: usize) -> Result<(f64, f64), NoEquilibrium> {
        let model = self.between_plates(axis);
        let mut u = self.field(|place| unit(axis) * place[axis]);
        let energy = model.relax(&mut u)?;
        let mut sides = 0.0;
        for across in (0..3).filter(|across| *across != axis) {
            let mean = |side: i8| {
                let on = self.nodes.iter().filter(|node| node.face[across] == side);
                let (sum, count) = on.fold((0.0, 0.0), |(sum, count), node| {
                    (sum + u.get(node.index)[across], count + 1.0)
                });
                sum / count
            };
            sides += (mean(1) - mean(-1)) / self.size[across] / 2.0;
        }
        Ok((self.modulus(energy), -sides))
    }

    /// The modulus of a unit displacement gradient that the whole boundary follows [Pa].
    fn affine(&self, displacement: impl Fn(V) -> V) -> Result<f64, NoEquilibrium> {
        let model = self.held(|node| [node.face != Vector3::zeros(); 3]);
        let energy = model.relax(&mut self.field(displacement))?;
        Ok(self.modulus(energy))
    }

    /// E of a beam along x that takes as much energy at unit curvature as the block between turning end plates [Pa].
    fn bend(&self) -> Result<f64, NoEquilibrium> {
        let model = self.between_plates(0);
        let mut u = self.field(|place| V::new(place.x * place.z, 0.0, -0.5 * place.x * place.x));
        let energy = model.relax(&mut u)?;
        Ok(self.modulus(energy) * 12.0 / (self.size.z * self.size.z))
    }

    /// 2U/V.
    fn modulus(&self, energy: f64) -> f64 {
        2.0 * energy / self.size.product()
    }

    /// Nominal stress along z at each strain, from one to the next, with free sides that stay plane [Pa].
    ///
    /// Plane, because the lattice has modes that nothing but tension stiffens, such as u_x = (−1)^(j + k), which stretches neither edge nor
    /// diagonal: compressed between sliding plates a block of many voxels gives way in them at a few per cent. The curve is the material's,
    /// and a block of equal voxels is in balance on it.
    pub(super) fn stresses(&self, strains: impl Iterator<Item = f64>) -> Result<Vec<f64>, NoEquilibrium> {
        let mut across = Vector2::zeros();
        let stress = |strain: f64| {
            for _ in 0..SIDE_STEPS {
                let pull = self.pull(strain, across);
                if pull.xy().amax() <= SIDE_PULL * pull.z.abs() {
                    return Ok(pull.z);
                }
                let slopes = [Vector2::x(), Vector2::y()].map(|axis| {
                    let there = self.pull(strain, across + axis * SIDE_STRAIN);
                    (there - pull).xy() / SIDE_STRAIN
                });
                let step = Matrix2::from_columns(&slopes).try_inverse().unwrap_or_default() * pull.xy();
                across -= step;
            }
            Err(NoEquilibrium {
                residual_n: self.pull(strain, across).xy().amax() * self.size.x * self.size.y,
            })
        };
        strains.map(stress).collect()
    }

    /// Nominal stress along x, y, z in a homogeneous stretch: the slope of the energy, by virtual work [Pa].
    fn pull(&self, strain: f64, across: Vector2<f64>) -> V {
        let stretch = V::new(across.x, across.y, strain);
        let mut force = Field::zeros(self.model.len());
        self.model
            .elastic(&self.field(|place| stretch.component_mul(&place)), &mut force);
        let work = self
            .nodes
            .iter()
            .map(|node| force.get(node.index).component_mul(&node.place));
        -work.sum::<V>() / self.size.product()
    }

    /// The block whose end faces across `axis` are held along it and slide freely.
    fn between_plates(&self, axis: usize) -> Model {
        self.held(|node| std::array::from_fn(|component| component == axis && node.face[axis] != 0))
    }

    fn held(&self, held: impl Fn(&Node) -> [bool; 3]) -> Model {
        let mut model = self.model.clone();
        let mut by_index = vec![[true; 3]; model.len()];
        for node in &self.nodes {
            by_index[node.index] = held(node);
        }
        model.hold(|index| by_index[index]);
        model
    }

    fn field(&self, displacement: impl Fn(V) -> V) -> Field {
        let mut field = Field::zeros(self.model.len());
        for node in &self.nodes {
            field.set(node.index, displacement(node.place));
        }
        field
    }
}

fn unit(axis: usize) -> V {
    let mut unit = V::zeros();
    unit[axis] = 1.0;
    unit
}
