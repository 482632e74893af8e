//! Steps in time of one millisecond: backward Euler, and symplectic Euler in substeps.

use super::newton::{Inertia, NoEquilibrium};
use super::{Field, Model, V};

/// The period [s].
const DT: f64 = 1e-3;

/// A held node that is moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moved {
    /// Which node.
    pub node: usize,
    /// Its displacement at the end of the tick [m].
    pub place: V,
}

/// A model on its way.
#[derive(Clone, Debug)]
pub struct March<'a> {
    model: &'a Model,
    /// Displacement from rest [m].
    pub displacement: Field,
    velocity: Field,
    /// Velocity a tick before: what the next tick's first guess is extrapolated from.
    before: Field,
}

impl<'a> March<'a> {
    /// At rest.
    #[must_use]
    pub fn new(model: &'a Model) -> Self {
        let zeros = Field::zeros(model.len());
        Self {
            model,
            displacement: zeros.clone(),
            velocity: zeros.clone(),
            before: zeros,
        }
    }

    /// One tick of backward Euler, x⁺ = x + dt v⁺ and m (v⁺ − v)/dt = f(x⁺) − α m v⁺, to a residual of 1e-11 N.
    ///
    /// # Errors
    /// Newton's method does not converge.
    pub fn backward_euler(&mut self, moved: Moved) -> Result<(), NoEquilibrium> {
        // c |u − y|²/2 with c = (1 + α dt)/dt² and c (y − x) = v/dt has the slope of inertia and damping.
        let scale = 1.0 + self.model.damping * DT;
        let mut toward = self.displacement.clone();
        toward.blend(1.0, DT / scale, &self.velocity);
        let mut at = self.displacement.clone();
        at.blend(1.0, 2.0 * DT, &self.velocity);
        at.blend(1.0, -DT, &self.before);
        for node in (0..self.model.len()).filter(|node| !self.model.moves(*node)) {
            at.set(node, self.displacement.get(node));
        }
        at.set(moved.node, moved.place);
        let inertia = Inertia {
            rate: scale / (DT * DT),
            toward: &toward,
        };
        self.model.settle(&mut at, inertia)?;
        std::mem::swap(&mut self.before, &mut self.velocity);
        self.velocity.clone_from(&at);
        self.velocity.blend(1.0 / DT, -1.0 / DT, &self.displacement);
        self.displacement = at;
        Ok(())
    }

    /// One tick of symplectic Euler in `substeps`, the damping implicit; the moved node goes straight to its place.
    pub fn symplectic_euler(&mut self, moved: Moved, substeps: u32) {
        let h = DT / f64::from(substeps);
        let keep = 1.0 / (1.0 + self.model.damping * h);
        let mut force = Field::zeros(self.model.len());
        let start = self.displacement.get(moved.node);
        for substep in 1..=substeps {
            self.model.elastic(&self.displacement, &mut force);
            force.clear_held(&self.model.free);
            let parts = self.velocity.parts.iter_mut().zip(&mut self.displacement.parts);
            for ((velocity, displacement), force) in parts.zip(&force.parts) {
                let nodes = velocity
                    .iter_mut()
                    .zip(displacement)
                    .zip(force.iter().zip(&self.model.mass));
                // Nodes of the box that do not exist have no mass.
                for ((v, u), (f, m)) in nodes.filter(|(_, (_, m))| **m > 0.0) {
                    *v = (*v + h * f / m) * keep;
                    *u += h * *v;
                }
            }
            let way = f64::from(substep) / f64::from(substeps);
            self.displacement.set(moved.node, start + (moved.place - start) * way);
        }
    }
}
