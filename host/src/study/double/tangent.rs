//! Second derivative of energy and inertia at a place, as an operator.
//!
//! A spring's tangent is k_t d dᵀ + (T/l)(I − d dᵀ). Under compression T/l < 0 can make the sum indefinite; [`Form::Definite`] cuts it
//! off at zero, as a solver that must not fail has to.

use nalgebra::Matrix3;

use super::gradients::{self, Stiffness};
use super::volume::Swelling;
use super::{Field, Model};

/// What becomes of compressed springs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// The second derivative itself.
    Exact,
    /// Positive definite: T/l not below zero.
    Definite,
}

/// Springs of one direction: unit vector, k_t − T/l and T/l by lower node.
struct Ties {
    offset: usize,
    direction: [Vec<f64>; 3],
    along: Vec<f64>,
    turn: Vec<f64>,
}

/// The operator D + K of a model at a place, D on the diagonal.
pub(super) struct Tangent<'a> {
    ties: Vec<Ties>,
    diagonal: Vec<f64>,
    swelling: Swelling<'a>,
    free: &'a [Vec<bool>; 3],
    /// Inverse of the 3 × 3 block of each node.
    inverse: Vec<Matrix3<f64>>,
}

/// Springs whose pull is computed before it is added to their nodes: what stays in the first cache.
const CHUNK: usize = 256;

impl<'a> Tangent<'a> {
    /// Of the springs at displacements `at`, and `inertia` times the mass at every node [1/s²].
    pub(super) fn new(model: &'a Model, at: &Field, inertia: f64, form: Form) -> Self {
        let n = model.len();
        let diagonal: Vec<f64> = model.mass.iter().map(|mass| mass * inertia).collect();
        let mut blocks: Vec<Matrix3<f64>> = diagonal.iter().map(|d| Matrix3::identity() * *d).collect();
        let ties = model.families.iter().map(|family| {
            let zeros = || vec![0.0; n - family.offset];
            let mut ties = Ties {
                offset: family.offset,
                direction: [zeros(), zeros(), zeros()],
                along: zeros(),
                turn: zeros(),
            };
            for low in family.springs() {
                let high = low + family.offset;
                let spring = family.stretch(low, at.get(high) - at.get(low));
                let exact = spring.tension / spring.length;
                let definite = exact.max(0.0);
                let turn = if form == Form::Exact { exact } else { definite };
                for (part, d) in ties.direction.iter_mut().zip(spring.direction.iter()) {
                    part[low] = *d;
                }
                (ties.along[low], ties.turn[low]) = (spring.slope - turn, turn);
                let outer = spring.direction * spring.direction.transpose();
                let block = outer * (spring.slope - definite) + Matrix3::identity() * definite;
                blocks[low] += block;
                blocks[high] += block;
            }
            ties
        });
        let ties = ties.collect();
        Self {
            ties,
            swelling: Swelling::new(&model.voxels, at, form, &mut blocks),
            diagonal,
            free: &model.free,
            inverse: blocks
                .into_iter()
                .map(|block| block.try_inverse().unwrap_or_else(Matrix3::zeros))
                .collect(),
        }
    }

    /// The x with (D + K) x = `residual` on the free components, until no component of what is left is above `enough` [N]; `None` where
    /// the operator turns out not to be positive definite.
    pub(super) fn solve(&self, residual: &Field, enough: f64) -> Option<Field> {
        gradients::solve(self, residual, enough)
    }
}

impl Stiffness for Tangent<'_> {
    fn apply(&self, p: &Field, product: &mut Field) {
        for (q, p) in product.parts.iter_mut().zip(&p.parts) {
            for ((q, p), d) in q.iter_mut().zip(p).zip(&self.diagonal) {
                *q = p * d;
            }
        }
        self.ties.iter().for_each(|ties| ties.apply(p, product));
        self.swelling.apply(p, product);
    }

    fn precondition(&self, r: &Field, z: &mut Field) {
        for (node, inverse) in self.inverse.iter().enumerate() {
            z.set(node, inverse * r.get(node));
        }
    }

    fn free(&self) -> &[Vec<bool>; 3] {
        self.free
    }
}

impl Ties {
    /// Adds the springs' part of the product.
    fn apply(&self, p: &Field, product: &mut Field) {
        let springs = self.along.len();
        for low in (0..springs).step_by(CHUNK) {
            let m = CHUNK.min(springs - low);
            let [near, far] = [low, low + self.offset].map(|at| p.parts.each_ref().map(|part| &part[at..at + m]));
            let [dx, dy, dz] = self.direction.each_ref().map(|part| &part[low..low + m]);
            let (along, turn) = (&self.along[low..low + m], &self.turn[low..low + m]);
            let mut pull = [[0.0; CHUNK]; 3];
            let [px, py, pz] = &mut pull;
            let ([ax, ay, az], [bx, by, bz]) = (near, far);
            let (px, py, pz) = (&mut px[..m], &mut py[..m], &mut pz[..m]);
            for i in 0..m {
                let (x, y, z) = (bx[i] - ax[i], by[i] - ay[i], bz[i] - az[i]);
                let stretch = along[i] * (dx[i] * x + dy[i] * y + dz[i] * z);
                px[i] = dx[i] * stretch + turn[i] * x;
                py[i] = dy[i] * stretch + turn[i] * y;
                pz[i] = dz[i] * stretch + turn[i] * z;
            }
            for (part, pull) in product.parts.iter_mut().zip(&pull) {
                part[low..low + m].iter_mut().zip(pull).for_each(|(q, f)| *q -= f);
                let high = low + self.offset;
                part[high..high + m].iter_mut().zip(pull).for_each(|(q, f)| *q += f);
            }
        }
    }
}
