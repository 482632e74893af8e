//! The same springs computed apart: a plain list, double precision, converged.
//!
//! Every voxel owns the springs between its eight corners: k_n E a/4 where two corners differ in one coordinate, k_d E a where
//! they differ in all three. Nothing is merged and nothing is taken from the lattice but the numbering of its nodes.

use super::block::{Block, DENSITY, Hold, PITCH};
use nalgebra::{Matrix3, Vector3};
use sutura_controller::lattice::{Field, at};
use sutura_shared::scene::Law;

/// A vector in double precision.
pub(crate) type V = Vector3<f64>;
/// A block in double precision.
pub(crate) type M = Matrix3<f64>;
/// A spring's two ends and its tangent.
pub(crate) type Tie = ([usize; 2], M);

/// The period [s].
pub(crate) const DT: f64 = 1e-3;

struct Spring {
    ends: [usize; 2],
    rest: V,
    stiffness: f64,
}

/// Springs, masses and what is held.
pub(crate) struct Springs {
    springs: Vec<Spring>,
    pub(crate) mass: Vec<f64>,
    pub(crate) free: Vec<bool>,
}

/// Displacement and velocity at the beginning of a backward Euler step, and the mass damping α [1/s].
pub(crate) struct Before<'a> {
    pub(crate) displacement: &'a [V],
    pub(crate) velocity: &'a [V],
    pub(crate) damping: f64,
}

/// A solver's field in double precision.
pub(crate) fn wide<const N: usize>(field: &Field<N>, n: usize) -> Vec<V> {
    (0..n).map(|node| at(field, node).map(f64::from)).collect()
}

impl Springs {
    /// A full block of one tissue, held where `block` is held.
    pub(crate) fn new(block: &Block, law: Law, young: f64) -> Self {
        Self::layered(block, law, |_| young)
    }

    /// A full block held where `block` is held, of Young's modulus `young` [Pa] by layer of voxels, the lowest first.
    pub(crate) fn layered(block: &Block, law: Law, young: impl Fn(usize) -> f64) -> Self {
        let stiffness = match law {
            Law::Isotropic => [0.8, 0.3],
            Law::Axial => [f64::from(2.0 / 3.0_f32).sqrt(), 0.25],
            Law::Paper => [0.45, 0.25],
            Law::Volume { .. } => unreachable!("these are springs alone"),
        };
        Self::of(block, stiffness, young)
    }

    /// The same with k_n and k_d over E a of any law.
    pub(crate) fn of(block: &Block, [edge, diagonal]: [f64; 2], young: impl Fn(usize) -> f64) -> Self {
        let pitch = f64::from(PITCH);
        let n = block.lattice.len();
        let mut all = Self {
            springs: Vec::new(),
            mass: vec![0.0; n],
            free: block.lattice.free[..n].iter().map(|free| *free > 0.0).collect(),
        };
        let [nx, ny, nz] = block.lattice.nodes;
        let lowest = block
            .nodes()
            .filter(|(_, [i, j, k])| i + 1 < nx && j + 1 < ny && k + 1 < nz);
        for (_, [i, j, k]) in lowest {
            let corner = |c: usize| {
                block
                    .lattice
                    .index([i + (c as u32 & 1), j + (c as u32 >> 1 & 1), k + (c as u32 >> 2)])
            };
            for a in 0..8 {
                all.mass[corner(a)] += f64::from(DENSITY) * pitch.powi(3) / 8.0;
                for b in a + 1..8 {
                    let apart = a ^ b;
                    let stiffness = match apart.count_ones() {
                        1 => edge / 4.0,
                        3 => diagonal,
                        _ => continue,
                    };
                    let along = |bit: usize| ((b >> bit & 1) as f64 - (a >> bit & 1) as f64) * pitch;
                    all.springs.push(Spring {
                        ends: [corner(a), corner(b)],
                        rest: V::new(along(0), along(1), along(2)),
                        stiffness: stiffness * young(k as usize) * pitch,
                    });
                }
            }
        }
        all
    }

    /// Elastic energy [J].
    pub(crate) fn energy(&self, u: &[V]) -> f64 {
        let of = |s: &Spring| {
            let d = s.rest + u[s.ends[1]] - u[s.ends[0]];
            0.5 * s.stiffness * (d.norm() - s.rest.norm()).powi(2)
        };
        self.springs.iter().map(of).sum()
    }

    /// Kinetic energy [J].
    pub(crate) fn kinetic(&self, v: &[V]) -> f64 {
        self.mass.iter().zip(v).map(|(m, v)| 0.5 * m * v.norm_squared()).sum()
    }

    /// Momentum [kg·m/s].
    pub(crate) fn momentum(&self, v: &[V]) -> V {
        self.mass.iter().zip(v).map(|(m, v)| v * *m).sum()
    }

    /// Elastic force on every node [N].
    pub(crate) fn force(&self, u: &[V]) -> Vec<V> {
        let mut force = vec![V::zeros(); u.len()];
        for s in &self.springs {
            let [a, b] = s.ends;
            let d = s.rest + u[b] - u[a];
            let pull = d * (s.stiffness * (1.0 - s.rest.norm() / d.norm()));
            force[a] += pull;
            force[b] -= pull;
        }
        force
    }

    /// Displacement at rest under `hold`, or after one backward Euler step: Newton's method until no node moves by 1e-14 m.
    pub(crate) fn solve(&self, start: &[V], hold: &Hold, before: Option<&Before<'_>>) -> Vec<V> {
        let mut u = start.to_vec();
        for _ in 0..200 {
            let step = self.conjugate_gradients(&u, &self.residual(&u, hold, before), hold, before.map(|b| b.damping));
            u.iter_mut().zip(&step).for_each(|(u, s)| *u += s);
            if step.iter().all(|s| s.norm() < 1e-14) {
                return u;
            }
        }
        panic!("the reference does not converge");
    }

    fn residual(&self, u: &[V], hold: &Hold, before: Option<&Before<'_>>) -> Vec<V> {
        let mut residual = self.force(u);
        let stretch = hold.anchor.map(f64::from) - mean(hold, u);
        for (node, w) in &hold.nodes {
            residual[*node] += stretch * (f64::from(hold.stiffness) * f64::from(*w));
        }
        if let Some(before) = before {
            let then = before.displacement.iter().zip(before.velocity).zip(&self.mass);
            for ((r, u), ((x, v), m)) in residual.iter_mut().zip(u).zip(then) {
                let velocity = (u - x) / DT;
                *r -= ((velocity - v) / DT + velocity * before.damping) * *m;
            }
        }
        self.clear_held(&mut residual);
        residual
    }

    /// Zero at every held node.
    pub(crate) fn clear_held(&self, values: &mut [V]) {
        let held = values.iter_mut().zip(&self.free).filter(|(_, free)| !**free);
        held.for_each(|(value, _)| *value = V::zeros());
    }

    /// The springs' tangents at `u`, their transverse part cut off at zero.
    pub(crate) fn tangents(&self, u: &[V]) -> Vec<Tie> {
        let of = |s: &Spring| {
            let [a, b] = s.ends;
            let d = s.rest + u[b] - u[a];
            let turn = s.stiffness * (1.0 - s.rest.norm() / d.norm()).max(0.0);
            (s.ends, tangent(d, s.stiffness, turn))
        };
        self.springs.iter().map(of).collect()
    }

    /// Newton's step at `u`.
    fn conjugate_gradients(&self, u: &[V], residual: &[V], hold: &Hold, damping: Option<f64>) -> Vec<V> {
        let ties = self.tangents(u);
        let inertia = damping.map_or(0.0, |alpha| 1.0 / (DT * DT) + alpha / DT);
        let product = |p: &[V]| {
            let mut product: Vec<V> = p.iter().zip(&self.mass).map(|(p, m)| p * (m * inertia)).collect();
            add_ties(&ties, p, &mut product);
            let pull = mean(hold, p) * f64::from(hold.stiffness);
            for (node, w) in &hold.nodes {
                product[*node] += pull * f64::from(*w);
            }
            self.clear_held(&mut product);
            product
        };
        conjugate_gradients(residual, &vec![M::identity(); u.len()], 1e-24, product)
    }
}

/// Tangent of a spring along `d`: `along` in its direction, `turn` across it [N/m].
pub(crate) fn tangent(d: V, along: f64, turn: f64) -> M {
    let unit = d.normalize();
    unit * unit.transpose() * (along - turn) + M::identity() * turn
}

/// Adds what springs answer the displacements `p` with.
pub(crate) fn add_ties(ties: &[Tie], p: &[V], product: &mut [V]) {
    for ([a, b], block) in ties {
        let pull = block * (p[*b] - p[*a]);
        product[*a] -= pull;
        product[*b] += pull;
    }
}

/// Inner product of two fields.
pub(crate) fn dot(a: &[V], b: &[V]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

/// The x with A x = `residual`, A by its `product`, preconditioned by the blocks `scale`, until the square of the residual has fallen to
/// `enough` of what it was.
pub(crate) fn conjugate_gradients(
    residual: &[V],
    scale: &[M],
    enough: f64,
    product: impl Fn(&[V]) -> Vec<V>,
) -> Vec<V> {
    let scaled = |r: &[V]| -> Vec<V> { r.iter().zip(scale).map(|(r, s)| s * r).collect() };
    let mut x = vec![V::zeros(); residual.len()];
    let mut r = residual.to_vec();
    let mut p = scaled(&r);
    let mut rz = dot(&r, &p);
    let enough = rz * enough;
    for _ in 0..5000 {
        if rz <= enough {
            break;
        }
        let q = product(&p);
        let along = rz / dot(&p, &q);
        x.iter_mut().zip(&p).for_each(|(x, p)| *x += p * along);
        r.iter_mut().zip(&q).for_each(|(r, q)| *r -= q * along);
        let z = scaled(&r);
        let next = dot(&r, &z);
        p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + *p * (next / rz));
        rz = next;
    }
    x
}

/// Weighted mean of a field at the hold's nodes.
fn mean(hold: &Hold, u: &[V]) -> V {
    hold.nodes.iter().map(|(node, w)| u[*node] * f64::from(*w)).sum()
}

/// Largest difference of two fields over the largest vector of the second.
pub(crate) fn error(field: &[V], expected: &[V]) -> f64 {
    let largest = |of: &mut dyn Iterator<Item = f64>| of.fold(0.0, f64::max);
    let difference = largest(&mut field.iter().zip(expected).map(|(a, b)| (a - b).norm()));
    difference / largest(&mut expected.iter().map(|e| e.norm()))
}
