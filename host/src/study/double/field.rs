//! A vector at every node, x, y and z apart.

use super::V;

/// A vector at every node.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Field {
    /// Components x, y, z by node.
    pub parts: [Vec<f64>; 3],
}

impl Field {
    /// Zero at `n` nodes.
    #[must_use]
    pub fn zeros(n: usize) -> Self {
        Self {
            parts: std::array::from_fn(|_| vec![0.0; n]),
        }
    }

    /// Nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        let [x, _, _] = &self.parts;
        x.len()
    }

    /// Whether there is no node.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The vector at a node.
    #[inline]
    #[must_use]
    pub fn get(&self, node: usize) -> V {
        let [x, y, z] = &self.parts;
        V::new(x[node], y[node], z[node])
    }

    /// Puts a vector at a node.
    #[inline]
    pub fn set(&mut self, node: usize, v: V) {
        self.parts
            .iter_mut()
            .zip(v.iter())
            .for_each(|(part, v)| part[node] = *v);
    }

    /// Adds a vector at a node.
    #[inline]
    pub fn add(&mut self, node: usize, v: V) {
        self.parts
            .iter_mut()
            .zip(v.iter())
            .for_each(|(part, v)| part[node] += v);
    }

    /// Zero everywhere.
    pub fn clear(&mut self) {
        self.parts.iter_mut().for_each(|part| part.fill(0.0));
    }

    /// self ← scale · self + factor · other.
    pub fn blend(&mut self, scale: f64, factor: f64, other: &Self) {
        for (part, other) in self.parts.iter_mut().zip(&other.parts) {
            part.iter_mut()
                .zip(other)
                .for_each(|(a, b)| *a = scale * *a + factor * b);
        }
    }

    /// Inner product.
    #[must_use]
    pub fn dot(&self, other: &Self) -> f64 {
        let parts = self.parts.iter().zip(&other.parts);
        parts
            .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>())
            .sum()
    }

    /// Largest component's magnitude.
    pub(super) fn largest(&self) -> f64 {
        self.parts
            .iter()
            .flatten()
            .fold(0.0, |most, value| value.abs().max(most))
    }

    /// Zero wherever a component is not `free`.
    pub(super) fn clear_held(&mut self, free: &[Vec<bool>; 3]) {
        for (part, keep) in self.parts.iter_mut().zip(free) {
            let held = part.iter_mut().zip(keep).filter(|(_, keep)| !**keep);
            held.for_each(|(value, _)| *value = 0.0);
        }
    }
}
