//! The fastest vibration of a model, which bounds the step of an explicit scheme.

use super::gradients::Stiffness;
use super::tangent::{Form, Tangent};
use super::{Family, Field, Model};

/// Power iterations; the largest eigenvalue is then known to about a thousandth.
const ITERATIONS: usize = 400;

impl Model {
    /// Largest angular frequency ω at rest if every spring had the steepest slope of its curve [rad/s]: the largest eigenvalue ω² of M⁻¹K,
    /// by power iteration. Symplectic Euler is stable for steps below 2/ω.
    #[must_use]
    pub fn fastest(&self) -> f64 {
        let mut steep = self.clone();
        for family in &mut steep.families {
            let slope = family.curve.steepest;
            family.stiffness.iter_mut().for_each(|k| *k *= slope);
            family.curve = super::Curve::default();
        }
        let n = self.len();
        let tangent = Tangent::new(&steep, &Field::zeros(n), 0.0, Form::Exact);
        let mut mode = Field::zeros(n);
        for (axis, part) in mode.parts.iter_mut().enumerate() {
            // Neighbours in opposite directions, as in the fastest mode, and uneven so that no symmetry is kept.
            for (node, value) in part.iter_mut().enumerate() {
                *value = if (node + axis) % 2 == 0 { 1.0 } else { -1.0 } + 1e-3 * (node % 17) as f64;
            }
        }
        mode.clear_held(&self.free);
        let mut image = Field::zeros(n);
        let mut square = 0.0;
        for _ in 0..ITERATIONS {
            tangent.apply(&mode, &mut image);
            image.clear_held(&self.free);
            for part in &mut image.parts {
                let nodes = part.iter_mut().zip(&self.mass).filter(|(_, mass)| **mass > 0.0);
                nodes.for_each(|(value, mass)| *value /= mass);
            }
            let size = image.dot(&image).sqrt();
            square = size / mode.dot(&mode).sqrt();
            mode.clear();
            mode.blend(0.0, 1.0 / size, &image);
        }
        square.sqrt()
    }

    /// How far the slope of any spring at displacements `at` is above the steepest of its curve, as a ratio ≥ 1: locked springs have
    /// slopes without a bound.
    #[must_use]
    pub fn steepness(&self, at: &Field) -> f64 {
        let of = |family: &Family| {
            let slopes = family.springs().map(|low| {
                let spring = family.stretch(low, at.get(low + family.offset) - at.get(low));
                spring.slope / (family.stiffness[low] * family.curve.steepest)
            });
            slopes.fold(1.0, f64::max)
        };
        self.families.iter().map(of).fold(1.0, f64::max)
    }
}
