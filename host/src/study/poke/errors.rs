//! How far a solver is from the converged solution.

use serde::Serialize;
use sutura_controller::math::TICK_HZ;

use super::drive::{Poke, State};
use crate::study::double::{March, Model, Moved, NoEquilibrium, V};
use crate::study::method::Method;

/// Substeps of the explicit reference: the tick over 200, or what makes its step half of the largest stable one, with springs as steep
/// as they are at the tick's start.
const SUBSTEPS: u32 = 200;

/// Errors, each relative to the root mean square of the converged solution over the whole run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Errors {
    /// Root mean square over all ticks of the reaction's error.
    pub force_error_rms: f64,
    /// Its largest magnitude.
    pub force_error_max: f64,
    /// Root mean square over all nodes and ticks of the displacement's error.
    pub shape_error: f64,
}

/// A converged solution on the same way, and sums of squares.
pub(super) struct Comparison<'a> {
    poke: &'a Poke,
    model: &'a Model,
    march: March<'a>,
    /// Largest angular frequency that an explicit reference has to resolve [rad/s]; none for backward Euler.
    fastest: Option<f64>,
    ticks: f64,
    force: [f64; 2],
    force_most: f64,
    shape: [f64; 2],
}

impl<'a> Comparison<'a> {
    /// At rest; `method` says which equation is solved.
    pub(super) fn new(poke: &'a Poke, model: &'a Model, method: Method) -> Self {
        Self {
            poke,
            model,
            march: March::new(model),
            fastest: method.is_substepped().then(|| model.fastest()),
            ticks: 0.0,
            force: [0.0; 2],
            force_most: 0.0,
            shape: [0.0; 2],
        }
    }

    /// Advances the converged solution by a tick and compares.
    pub(super) fn compare(&mut self, state: &State) -> Result<(), NoEquilibrium> {
        let moved = Moved {
            node: self.poke.node,
            place: V::from(self.poke.place(state.tick).map(f64::from)),
        };
        match self.fastest {
            Some(fastest) => {
                let now = fastest * self.model.steepness(&self.march.displacement).sqrt();
                // Stable are ω dt/2 and more.
                let substeps = (now / f64::from(TICK_HZ)).ceil() as u32;
                self.march.symplectic_euler(moved, substeps.max(SUBSTEPS));
            }
            None => self.march.backward_euler(moved)?,
        }
        let converged = &self.march.displacement;
        let expected = self.model.reaction(self.poke.node, |node| converged.get(node));
        let force = self.model.reaction(self.poke.node, |node| state.displacement(node));
        let error = (force - expected).norm();
        self.ticks += 1.0;
        add(&mut self.force, [error * error, expected.norm_squared()]);
        self.force_most = if error > self.force_most || error.is_nan() {
            error
        } else {
            self.force_most
        };
        for node in 0..self.model.len() {
            let expected = converged.get(node);
            let error = state.displacement(node) - expected;
            add(&mut self.shape, [error.norm_squared(), expected.norm_squared()]);
        }
        Ok(())
    }

    /// What it comes to.
    pub(super) fn errors(&self) -> Errors {
        let relative = |[error, whole]: [f64; 2]| (error / whole).sqrt();
        Errors {
            force_error_rms: relative(self.force),
            force_error_max: self.force_most / (self.force[1] / self.ticks).sqrt(),
            shape_error: relative(self.shape),
        }
    }
}

fn add(sums: &mut [f64; 2], terms: [f64; 2]) {
    sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
}
