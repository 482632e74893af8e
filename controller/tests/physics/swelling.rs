//! Springs and the voxels' energy a³ U(J), U = ½ Λ (J − 1)² + ½ B max(0, 0.3 − J)², computed apart in double precision.

use super::block::{Block, PITCH};
use super::reference::{DT, Springs, V, add_ties, conjugate_gradients};
use nalgebra::Matrix3;

/// Springs and voxels in double precision.
pub(crate) struct Whole {
    springs: Springs,
    /// Corners of each voxel; bit i of a corner's number is its place along axis i.
    pub(crate) voxels: Vec<[usize; 8]>,
    /// Λ and B [Pa].
    pub(crate) stiffness: [f64; 2],
}

impl Whole {
    /// Of a full block of one tissue with the law `volume`, held where `block` is held.
    pub(crate) fn new(block: &Block, poisson: f64, young: f64) -> Self {
        let shear = 0.5 / (1.0 + poisson);
        let [nx, ny, nz] = block.lattice.nodes;
        let lowest = block
            .nodes()
            .filter(|(_, [i, j, k])| i + 1 < nx && j + 1 < ny && k + 1 < nz);
        let corners = |[i, j, k]: [u32; 3]| {
            core::array::from_fn(|c| {
                let c = c as u32;
                block.lattice.index([i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)])
            })
        };
        Self {
            springs: Springs::of(block, [2.0 * shear, 0.75 * shear], |_| young),
            voxels: lowest.map(|(_, at)| corners(at)).collect(),
            stiffness: [shear * (4.0 * poisson - 1.0) / (1.0 - 2.0 * poisson), 8.0].map(|k| k * young),
        }
    }

    /// Mean edges of a voxel over a, less their rest.
    fn moved(voxel: &[usize; 8], u: &[V]) -> Matrix3<f64> {
        let edge = |axis: usize| -> V {
            let signed = voxel.iter().enumerate();
            signed
                .map(|(corner, node)| u[*node] * (sign(corner, axis) / f64::from(PITCH)))
                .sum()
        };
        Matrix3::from_columns(&[edge(0), edge(1), edge(2)])
    }

    /// J of a voxel.
    pub(crate) fn growth(voxel: &[usize; 8], u: &[V]) -> f64 {
        (Self::moved(voxel, u) + Matrix3::identity()).determinant()
    }

    /// dU/dJ and its slope [Pa].
    fn answer(&self, growth: f64) -> [f64; 2] {
        let [volume, barrier] = self.stiffness;
        let under = (0.3 - growth).max(0.0);
        let acts = if under > 0.0 { barrier } else { 0.0 };
        [volume * (growth - 1.0) - barrier * under, volume + acts]
    }

    /// ∂J/∂u of a voxel's corners [1/m].
    fn slopes(voxel: &[usize; 8], u: &[V]) -> [V; 8] {
        let edges = Self::moved(voxel, u) + Matrix3::identity();
        let [x, y, z] = [0, 1, 2].map(|axis| edges.column(axis).into_owned());
        let faces = [y.cross(&z), z.cross(&x), x.cross(&y)];
        core::array::from_fn(|corner| {
            let parts = (0..3).map(|axis| faces[axis] * (sign(corner, axis) / f64::from(PITCH)));
            parts.sum()
        })
    }

    /// Elastic force on every node [N].
    pub(crate) fn force(&self, u: &[V]) -> Vec<V> {
        let mut force = self.springs.force(u);
        for voxel in &self.voxels {
            let [pressure, _] = self.answer(Self::growth(voxel, u));
            for (node, slope) in voxel.iter().zip(Self::slopes(voxel, u)) {
                force[*node] -= slope * (pressure * f64::from(PITCH).powi(3));
            }
        }
        force
    }

    /// The backward Euler step from a state, by quasi-Newton steps until no node moves by 1e-13 m.
    pub(crate) fn step(&self, start: &[V], velocity: &[V], damping: f64) -> Vec<V> {
        let mut u = start.to_vec();
        let inertia = 1.0 / (DT * DT) + damping / DT;
        for _ in 0..1000 {
            let mut residual = self.force(&u);
            for (node, r) in residual.iter_mut().enumerate() {
                let moved = u[node] - start[node];
                *r -= (moved * inertia - velocity[node] / DT) * self.springs.mass[node];
            }
            self.springs.clear_held(&mut residual);
            let ties = self.springs.tangents(&u);
            let voxels: Vec<_> = self.voxels.iter().map(|voxel| self.linear(voxel, &u)).collect();
            let product = |p: &[V]| {
                let weighed = p.iter().zip(&self.springs.mass);
                let mut product: Vec<V> = weighed.map(|(p, m)| p * (m * inertia)).collect();
                add_ties(&ties, p, &mut product);
                for (voxel, (slopes, stiffness)) in self.voxels.iter().zip(&voxels) {
                    let grown: f64 = voxel.iter().zip(slopes).map(|(node, slope)| slope.dot(&p[*node])).sum();
                    for (node, slope) in voxel.iter().zip(slopes) {
                        product[*node] += slope * (grown * stiffness);
                    }
                }
                self.springs.clear_held(&mut product);
                product
            };
            let further = conjugate_gradients(&residual, &vec![Matrix3::identity(); u.len()], 1e-20, product);
            u.iter_mut().zip(&further).for_each(|(u, s)| *u += s);
            if further.iter().all(|s| s.norm() < 1e-13) {
                return u;
            }
        }
        panic!("the reference does not converge");
    }

    /// A voxel's ∂J/∂u and U″ a³ [Pa m³].
    fn linear(&self, voxel: &[usize; 8], u: &[V]) -> ([V; 8], f64) {
        let [_, stiffness] = self.answer(Self::growth(voxel, u));
        (Self::slopes(voxel, u), stiffness * f64::from(PITCH).powi(3))
    }

    /// Elastic energy [J].
    pub(crate) fn energy(&self, u: &[V]) -> f64 {
        let [volume, barrier] = self.stiffness;
        let of = |voxel: &[usize; 8]| {
            let j = Self::growth(voxel, u);
            let under = (0.3 - j).max(0.0);
            0.5 * (volume * (j - 1.0) * (j - 1.0) + barrier * under * under) * f64::from(PITCH).powi(3)
        };
        self.springs.energy(u) + self.voxels.iter().map(of).sum::<f64>()
    }
}

/// ∂ of a mean edge over the way of a corner.
fn sign(corner: usize, axis: usize) -> f64 {
    if corner >> axis & 1 == 1 { 0.25 } else { -0.25 }
}
