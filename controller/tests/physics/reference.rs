//! The same springs computed apart: a plain list, double precision, converged.
//!
//! Every voxel owns the springs between its eight corners: k_n E a/4 where two corners differ in one coordinate, k_d E a where
//! they differ in all three. Nothing is merged and nothing is taken from the lattice but the numbering of its nodes.

use super::block::{Block, DENSITY, Hold, PITCH};
use nalgebra::Vector3;
use sutura_controller::lattice::{Field, at};
use sutura_shared::scene::Law;

/// A vector in double precision.
pub(crate) type V = Vector3<f64>;

const DT: f64 = 1e-3;

struct Spring {
    ends: [usize; 2],
    rest: V,
    stiffness: f64,
}

/// Springs, masses and what is held.
pub(crate) struct Springs {
    springs: Vec<Spring>,
    pub(crate) mass: Vec<f64>,
    free: Vec<bool>,
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
        let pitch = f64::from(PITCH);
        let (edge, diagonal) = match law {
            Law::Isotropic => (0.8, 0.3),
            Law::Axial => (f64::from(2.0 / 3.0_f32).sqrt(), 0.25),
            Law::Paper => (0.45, 0.25),
        };
        let [nx, ny, nz] = block.lattice.nodes.map(|n| n as usize);
        let n = nx * ny * nz;
        let mut all = Self {
            springs: Vec::new(),
            mass: vec![0.0; n],
            free: block.lattice.free[..n].iter().map(|free| *free > 0.0).collect(),
        };
        let lowest = (0..n).filter(|n| n % nx + 1 < nx && n / nx % ny + 1 < ny && n / nx / ny + 1 < nz);
        for low in lowest {
            let corner = |c: usize| low + (c & 1) + (c >> 1 & 1) * nx + (c >> 2) * nx * ny;
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
                        stiffness: stiffness * young * pitch,
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

    fn clear_held(&self, values: &mut [V]) {
        let held = values.iter_mut().zip(&self.free).filter(|(_, free)| !**free);
        held.for_each(|(value, _)| *value = V::zeros());
    }

    /// The tangent at `u`, its transverse part cut off at zero, times `p`.
    fn tangent(&self, u: &[V], p: &[V], hold: &Hold, damping: Option<f64>) -> Vec<V> {
        let inertia = damping.map_or(0.0, |alpha| 1.0 / (DT * DT) + alpha / DT);
        let mut product: Vec<V> = p.iter().zip(&self.mass).map(|(p, m)| p * (m * inertia)).collect();
        for s in &self.springs {
            let [a, b] = s.ends;
            let d = s.rest + u[b] - u[a];
            let unit = d.normalize();
            let turn = s.stiffness * (1.0 - s.rest.norm() / d.norm()).max(0.0);
            let apart = p[b] - p[a];
            let pull = unit * ((s.stiffness - turn) * unit.dot(&apart)) + apart * turn;
            product[a] -= pull;
            product[b] += pull;
        }
        let pull = mean(hold, p) * f64::from(hold.stiffness);
        for (node, w) in &hold.nodes {
            product[*node] += pull * f64::from(*w);
        }
        self.clear_held(&mut product);
        product
    }

    fn conjugate_gradients(&self, u: &[V], residual: &[V], hold: &Hold, damping: Option<f64>) -> Vec<V> {
        let dot = |a: &[V], b: &[V]| -> f64 { a.iter().zip(b).map(|(a, b)| a.dot(b)).sum() };
        let mut x = vec![V::zeros(); u.len()];
        let mut r = residual.to_vec();
        let mut p = r.clone();
        let mut rr = dot(&r, &r);
        let enough = rr * 1e-24;
        for _ in 0..5000 {
            if rr <= enough {
                break;
            }
            let q = self.tangent(u, &p, hold, damping);
            let along = rr / dot(&p, &q);
            x.iter_mut().zip(&p).for_each(|(x, p)| *x += p * along);
            r.iter_mut().zip(&q).for_each(|(r, q)| *r -= q * along);
            let next = dot(&r, &r);
            p.iter_mut().zip(&r).for_each(|(p, r)| *p = r + *p * (next / rr));
            rr = next;
        }
        x
    }
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
