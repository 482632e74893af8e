//! Conjugate gradients, and the equilibrium of a linear elastic body with them.

use super::{Field, NoEquilibrium};

/// Residual that is left of the first one, by component.
const CONVERGED: f64 = 1e-11;
/// Residual over the largest force from which rounding alone cannot come.
const LOST: f64 = 1e-8;
/// Iterations after which there is no hope.
const ITERATIONS_MAX: usize = 10_000;

/// A symmetric stiffness K, positive definite on the components that are free.
pub trait Stiffness {
    /// `product` = K `p`, at held components too.
    fn apply(&self, p: &Field, product: &mut Field);
    /// `z` = about K⁻¹ `r` by a symmetric, positive definite operator; held components do not matter.
    fn precondition(&self, r: &Field, z: &mut Field);
    /// Whether a node moves, by component.
    fn free(&self) -> &[Vec<bool>; 3];
}

/// The x with K x = `residual` on the free components, until no component of what is left is above `enough` [N]; `None` where K turns
/// out not to be positive definite.
pub(super) fn solve(stiffness: &impl Stiffness, residual: &Field, enough: f64) -> Option<Field> {
    let free = stiffness.free();
    let n = residual.len();
    let [mut x, mut z, mut q] = [(); 3].map(|()| Field::zeros(n));
    let mut r = residual.clone();
    stiffness.precondition(&r, &mut z);
    z.clear_held(free);
    let mut p = z.clone();
    let mut rz = r.dot(&z);
    for _ in 0..ITERATIONS_MAX {
        if r.largest() <= enough {
            break;
        }
        stiffness.apply(&p, &mut q);
        q.clear_held(free);
        let curvature = p.dot(&q);
        if curvature <= 0.0 {
            return None;
        }
        x.blend(1.0, rz / curvature, &p);
        r.blend(1.0, -rz / curvature, &q);
        stiffness.precondition(&r, &mut z);
        z.clear_held(free);
        let next = r.dot(&z);
        p.blend(next / rz, 1.0, &z);
        rz = next;
    }
    Some(x)
}

/// Moves the free components u of `at` to where ½ uᵀKu − fᵀu is least under the `load` f [N], and gives the elastic energy ½ uᵀKu [J].
///
/// # Errors
/// K is not positive definite, or so nearly so that the iterations do not get there.
pub fn relax(stiffness: &impl Stiffness, at: &mut Field, load: &Field) -> Result<f64, NoEquilibrium> {
    let mut pull = Field::zeros(at.len());
    let residual = |at: &Field, pull: &mut Field| {
        stiffness.apply(at, pull);
        let mut residual = load.clone();
        residual.blend(1.0, -1.0, pull);
        residual.clear_held(stiffness.free());
        residual
    };
    let first = residual(at, &mut pull);
    let size = first.largest();
    let step = solve(stiffness, &first, size * CONVERGED).ok_or(NoEquilibrium { residual_n: size })?;
    at.blend(1.0, 1.0, &step);
    let left = residual(at, &mut pull).largest();
    if left > pull.largest() * LOST {
        return Err(NoEquilibrium { residual_n: left });
    }
    Ok(0.5 * at.dot(&pull))
}
