//! The lattice at small strain: its stiffness at rest, and what that gives where some of the nodes are moved or loaded.

use super::gradients::relax;
use super::tangent::{Form, Tangent};
use super::{Field, Model, NoEquilibrium};

impl Model {
    /// Moves the free components of `at` to where the energy of small displacements, ½ uᵀKu with the stiffness K at rest, is least, and
    /// gives that energy [J].
    ///
    /// # Errors
    /// The stiffness is not positive definite.
    pub fn relax(&self, at: &mut Field) -> Result<f64, NoEquilibrium> {
        self.relax_under(&Field::zeros(self.len()), at)
    }

    /// The same under a `load` on its nodes [N]: the elastic energy where ½ uᵀKu − fᵀu is least.
    ///
    /// # Errors
    /// The stiffness is not positive definite.
    pub fn relax_under(&self, load: &Field, at: &mut Field) -> Result<f64, NoEquilibrium> {
        let rest = Field::zeros(self.len());
        relax(&Tangent::new(self, &rest, 0.0, Form::Exact), at, load)
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
