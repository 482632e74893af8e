//! The lattice at small strain: its stiffness at rest, and what that gives where some of the nodes are moved.

use super::tangent::{Form, Tangent};
use super::{Field, Model, NoEquilibrium};

/// What is left of the residual over what it was at first.
const CONVERGED: f64 = 1e-11;

impl Model {
    /// Moves the free components of `at` to where the energy of small displacements, ½ uᵀKu with the stiffness K at rest, is least, and
    /// gives that energy [J].
    ///
    /// # Errors
    /// The stiffness is not positive definite.
    pub fn relax(&self, at: &mut Field) -> Result<f64, NoEquilibrium> {
        let n = self.len();
        let rest = Field::zeros(n);
        let whole = self.released();
        let whole = Tangent::new(&whole, &rest, 0.0, Form::Exact);
        let mut pull = Field::zeros(n);
        whole.apply(at, &mut pull);
        let mut residual = Field::zeros(n);
        residual.blend(0.0, -1.0, &pull);
        residual.clear_held(&self.free);
        let left = residual.largest();
        let step = Tangent::new(self, &rest, 0.0, Form::Exact)
            .solve(&residual, left * CONVERGED)
            .ok_or(NoEquilibrium { residual_n: left })?;
        at.blend(1.0, 1.0, &step);
        whole.apply(at, &mut pull);
        Ok(0.5 * at.dot(&pull))
    }

    /// The same with every component free.
    fn released(&self) -> Self {
        Self {
            free: std::array::from_fn(|_| vec![true; self.len()]),
            ..self.clone()
        }
    }

    /// Lets every node move freely, then holds the components that `held` says of a node.
    pub fn hold(&mut self, held: impl Fn(usize) -> [bool; 3]) {
        for node in 0..self.len() {
            let held = held(node);
            let there = self.mass[node] > 0.0;
            for (free, held) in self.free.iter_mut().zip(held) {
                free[node] = there && !held;
            }
        }
    }
}
