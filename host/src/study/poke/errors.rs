//! How far a solver is from the converged solution.

use serde::Serialize;

use super::drive::State;
use crate::study::double::{Field, V};

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

/// Sums of squares over the ticks so far, of errors and of what is expected.
#[derive(Clone, Debug, Default)]
pub(crate) struct Distance {
    ticks: f64,
    force: [f64; 2],
    force_most: f64,
    shape: [f64; 2],
}

impl Distance {
    /// Compares a tick's reaction [N].
    pub(crate) fn add_force(&mut self, force: V, expected: V) {
        let error = (force - expected).norm();
        self.ticks += 1.0;
        add(&mut self.force, [error * error, expected.norm_squared()]);
        self.force_most = if error > self.force_most || error.is_nan() {
            error
        } else {
            self.force_most
        };
    }

    /// Compares a tick's displacement at all nodes [m].
    pub(crate) fn add_shape(&mut self, state: &State, expected: &Field) {
        for node in 0..expected.len() {
            let expected = expected.get(node);
            let error = state.displacement(node) - expected;
            add(&mut self.shape, [error.norm_squared(), expected.norm_squared()]);
        }
    }

    /// What it comes to.
    pub(crate) fn errors(&self) -> Errors {
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
