//! The lifted block at rest, computed apart: every spring of a plain list, in double precision, Newton's method on a dense matrix.
//!
//! Edges of k_n = 0.45 E a along x, y and z and four body diagonals of k_d = 0.25 E a in every voxel (Lian & Chen Eqs 5, 6), each edge a
//! whole spring. Nothing is taken from the program but the order of the nodes in its files: x fastest.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// A vector in double precision.
pub(crate) type V = Vector3<f64>;

/// A block of springs with its bottom layer held and one node lifted.
pub(crate) struct Block {
    pub(crate) nodes: [usize; 3],
    /// Voxel edge [m].
    pub(crate) pitch: f64,
    /// Young's modulus [Pa].
    pub(crate) young: f64,
    /// The lifted node.
    pub(crate) lifted: [usize; 3],
    /// How far [m].
    pub(crate) lift: f64,
}

/// Displacements of all nodes [m] and the force of the springs on the lifted one [N].
pub(crate) struct Rest {
    pub(crate) displacement: Vec<V>,
    pub(crate) reaction: V,
}

struct Spring {
    ends: [usize; 2],
    rest: V,
    stiffness: f64,
}

/// Steps in which the node is lifted, and what is left of the residual at the end of each [N].
const STEPS: usize = 20;
const LEFT: f64 = 1e-12;

impl Block {
    /// Where every node is once all motion has died out.
    pub(crate) fn at_rest(&self) -> Rest {
        let springs = self.springs();
        let [nx, ny, nz] = self.nodes;
        let lifted = self.index(self.lifted);
        let free: Vec<usize> = (nx * ny..nx * ny * nz).filter(|node| *node != lifted).collect();
        let mut u = vec![V::zeros(); nx * ny * nz];
        for step in 1..=STEPS {
            u[lifted] = V::new(0.0, 0.0, self.lift * step as f64 / STEPS as f64);
            settle(&springs, &free, &mut u);
        }
        let reaction = forces(&springs, &u)[lifted];
        Rest {
            displacement: u,
            reaction,
        }
    }

    fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        let [nx, ny, _] = self.nodes;
        (k * ny + j) * nx + i
    }

    fn springs(&self) -> Vec<Spring> {
        let [nx, ny, nz] = self.nodes;
        let [edge, diagonal] = [0.45, 0.25].map(|part| part * self.young * self.pitch);
        let mut springs = Vec::new();
        for (k, j, i) in (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (k, j, i)))) {
            let ways = [
                ([1, 0, 0], edge),
                ([0, 1, 0], edge),
                ([0, 0, 1], edge),
                ([1, 1, 1], diagonal),
                ([-1, 1, 1], diagonal),
                ([1, -1, 1], diagonal),
                ([-1, -1, 1], diagonal),
            ];
            for (way, stiffness) in ways {
                let [x, y, z]: [isize; 3] = way;
                let far = [
                    i.checked_add_signed(x),
                    j.checked_add_signed(y),
                    k.checked_add_signed(z),
                ];
                let [Some(p), Some(q), Some(r)] = far else { continue };
                if p < nx && q < ny && r < nz {
                    springs.push(Spring {
                        ends: [self.index([i, j, k]), self.index([p, q, r])],
                        rest: V::new(x as f64, y as f64, z as f64) * self.pitch,
                        stiffness,
                    });
                }
            }
        }
        springs
    }
}

/// Force of the springs on every node.
fn forces(springs: &[Spring], u: &[V]) -> Vec<V> {
    let mut forces = vec![V::zeros(); u.len()];
    for Spring {
        ends: [a, b],
        rest,
        stiffness,
    } in springs
    {
        let now = rest + u[*b] - u[*a];
        let pull = now * (stiffness * (1.0 - rest.norm() / now.norm()));
        forces[*a] += pull;
        forces[*b] -= pull;
    }
    forces
}

/// Newton's method on the free nodes, with steps halved until the residual falls.
fn settle(springs: &[Spring], free: &[usize], u: &mut Vec<V>) {
    let residual = |u: &[V]| {
        let forces = forces(springs, u);
        DVector::from_iterator(
            3 * free.len(),
            free.iter()
                .flat_map(|node| forces[*node].iter().copied().collect::<Vec<_>>()),
        )
    };
    for _ in 0..50 {
        let left = residual(u);
        if left.amax() < LEFT {
            return;
        }
        let step = tangent(springs, free, u)
            .lu()
            .solve(&left)
            .expect("the block is not at a limit of stability");
        let mut part = 1.0;
        let moved = loop {
            let mut moved = u.clone();
            for (unknown, node) in free.iter().enumerate() {
                moved[*node] += V::from_iterator(step.rows(3 * unknown, 3).iter().copied()) * part;
            }
            if residual(&moved).norm() < left.norm() || part < 1e-6 {
                break moved;
            }
            part *= 0.5;
        };
        *u = moved;
    }
    panic!(
        "the static solve does not converge: {:e} N are left",
        residual(u).amax()
    );
}

/// Second derivative of the energy by the free nodes.
fn tangent(springs: &[Spring], free: &[usize], u: &[V]) -> DMatrix<f64> {
    let mut unknown = vec![None; u.len()];
    free.iter()
        .enumerate()
        .for_each(|(at, node)| unknown[*node] = Some(3 * at));
    let mut matrix = DMatrix::zeros(3 * free.len(), 3 * free.len());
    for Spring { ends, rest, stiffness } in springs {
        let [a, b] = *ends;
        let now = rest + u[b] - u[a];
        let across = 1.0 - rest.norm() / now.norm();
        let unit = now.normalize();
        let block: Matrix3<f64> =
            (unit * unit.transpose() * (1.0 - across) + Matrix3::identity() * across) * *stiffness;
        for (row, column, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
            if let (Some(row), Some(column)) = (unknown[row], unknown[column]) {
                let mut part = matrix.fixed_view_mut::<3, 3>(row, column);
                part += block * sign;
            }
        }
    }
    matrix
}
