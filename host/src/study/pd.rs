//! Projective dynamics: backward Euler by iterations with one constant matrix, factored before the first tick (Bouaziz et al. 2014). A
//! comparator, for blocks of one tissue of springs alone.
//!
//! Local and global step together are u ← u + A⁻¹ r(u), with the residual r of the backward Euler equation and
//! A = m(1/dt² + α/dt) + Σ w (e_a − e_b)(e_a − e_b)ᵀ, the same for x, y and z. A spring's weight w is its steepest slope: so A majorises the
//! energy wherever no spring locks, and every iteration lowers it.

use sutura_controller::coupling::POINTS;
use sutura_controller::lattice::{Field, Lattice, PC_NODES, Tissue};
use sutura_controller::math::{DT, Vec3};
use sutura_controller::solver::{Problem, Solver, Work, elastic_force};

use super::band::{Band, Factor};
use super::block::Block;
use super::spring::Spring;

/// The method's dial, and the factor of its matrix.
#[derive(Clone, Debug)]
pub struct Pd {
    iterations: u16,
    factor: Factor,
    /// Free nodes in the order of the unknowns.
    nodes: Vec<usize>,
}

impl Pd {
    /// For a block as it is held now; `None` where nothing is free.
    #[must_use]
    pub fn new(block: &Block, iterations: u16) -> Option<Self> {
        let lattice = &block.lattice;
        let nodes = order(lattice);
        let mut unknowns = vec![None; PC_NODES];
        for (unknown, node) in nodes.iter().enumerate() {
            unknowns[*node] = Some(unknown);
        }
        let ties = ties(block);
        let apart = ties.iter().filter_map(|(ends, _)| {
            let [a, b] = ends.map(|node| unknowns[node]);
            Some(a?.abs_diff(b?))
        });
        let mut matrix = Band::zeros(nodes.len(), apart.max()?);
        let inertia = 1.0 / (DT * DT) + block.material.mass_damping / DT;
        for (unknown, node) in nodes.iter().enumerate() {
            matrix.add(unknown, unknown, f64::from(lattice.mass[*node] * inertia));
        }
        for (ends, weight) in ties {
            let [a, b] = ends.map(|node| unknowns[node]);
            [a, b]
                .into_iter()
                .flatten()
                .for_each(|end| matrix.add(end, end, weight));
            if let (Some(a), Some(b)) = (a, b) {
                matrix.add(a, b, -weight);
            }
        }
        let factor = matrix.factor()?;
        Some(Self {
            iterations,
            factor,
            nodes,
        })
    }
}

/// Free nodes, the lattice's shortest axis fastest: springs then join unknowns that are close.
fn order<const N: usize>(lattice: &Lattice<N>) -> Vec<usize> {
    let mut axes = [0, 1, 2];
    axes.sort_by_key(|axis| lattice.nodes[*axis]);
    let [fast, slow, slowest] = axes.map(|axis| lattice.nodes[axis]);
    let all = (0..slowest).flat_map(|c| (0..slow).flat_map(move |b| (0..fast).map(move |a| [a, b, c])));
    let index = |along: [u32; 3]| {
        let mut at = [0; 3];
        axes.into_iter().zip(along).for_each(|(axis, along)| at[axis] = along);
        lattice.index(at)
    };
    all.map(index).filter(|node| lattice.free[*node] > 0.0).collect()
}

/// Both ends and the weight of every spring [N/m].
fn ties(block: &Block) -> Vec<([usize; 2], f64)> {
    let lattice = &block.lattice;
    let [stiffness, ..] = &lattice.stiffness;
    let directions = (0..).zip(lattice.offsets()).zip(stiffness);
    let springs = directions.flat_map(|((direction, offset), stiffness)| {
        let slope = Spring::new(&block.material, direction).steepest();
        let there = stiffness.iter().enumerate().filter(|(_, k)| **k > 0.0);
        there.map(move |(low, k)| ([low, low + offset], f64::from(k * slope)))
    });
    springs.collect()
}

impl<const N: usize> Solver<N> for Pd {
    fn advance(
        &self,
        problem: &Problem<'_, N>,
        load: &Field<N>,
        tissue: &mut Tissue<N>,
        work: &mut Work<N>,
    ) -> [Vec3; POINTS] {
        let n = problem.lattice.len();
        let inertia = 1.0 / (DT * DT) + problem.material.mass_damping / DT;
        // The prediction u = dt v also moves the held node that has a velocity; u/dt is the new velocity all along.
        let before = tissue.velocity;
        for (x, v) in tissue.displacement.iter_mut().zip(&tissue.velocity) {
            x.iter_mut().zip(v).take(n).for_each(|(x, v)| *x += DT * v);
        }
        let mut sides: [Vec<f32>; 3] = std::array::from_fn(|_| vec![0.0; self.factor.padded()]);
        for _ in 0..self.iterations {
            let force = elastic_force(problem, tissue, work);
            for ((side, force), (load, (v, then))) in sides
                .iter_mut()
                .zip(force)
                .zip(load.iter().zip(tissue.velocity.iter().zip(&before)))
            {
                for (r, node) in side.iter_mut().zip(&self.nodes) {
                    let node = *node;
                    let m = problem.lattice.mass[node];
                    *r = force[node] + load[node] - m * (inertia * DT * v[node] - then[node] / DT);
                }
            }
            self.factor.solve(&mut sides);
            let parts = tissue.displacement.iter_mut().zip(&mut tissue.velocity);
            for ((x, v), side) in parts.zip(&sides) {
                for (change, node) in side.iter().zip(&self.nodes) {
                    x[*node] += change;
                    v[*node] += change / DT;
                }
            }
        }
        [Vec3::zeros(); POINTS]
    }
}
