//! Cholesky factor of a symmetric, positive definite band matrix, and solves with three right-hand sides at once.
//!
//! For the lattice numbered along its shortest axes first the band is nearly full after factoring, and its columns are contiguous, which
//! a sparse factor's are not.

/// Lanes in which a column's products are summed.
const LANES: usize = 8;

/// The factor L of A = L Lᵀ.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// Entries of a column below its diagonal.
    band: usize,
    /// By column `band` entries of L below the diagonal, zero past the last row.
    below: Vec<f32>,
    /// 1/L_jj.
    inverse: Vec<f32>,
}

/// A symmetric band matrix: its diagonal and what is below.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    band: usize,
    /// By column the diagonal and `band` entries below it.
    columns: Vec<f64>,
}

impl Band {
    /// Zeros for `n` unknowns of which no two further apart than `band` share an entry.
    #[must_use]
    pub fn zeros(n: usize, band: usize) -> Self {
        let band = band.max(1);
        Self {
            band,
            columns: vec![0.0; n * (band + 1)],
        }
    }

    /// Adds to the entry of unknowns `a` and `b`, at most `band` apart.
    pub fn add(&mut self, a: usize, b: usize, value: f64) {
        let (column, row) = (a.min(b), a.max(b));
        self.columns[column * (self.band + 1) + row - column] += value;
    }

    /// Factors; `None` where the matrix is not positive definite.
    #[must_use]
    pub fn factor(mut self) -> Option<Factor> {
        let width = self.band + 1;
        let n = self.columns.len() / width;
        for column in 0..n {
            let (own, later) = self.columns[column * width..].split_at_mut(width);
            let pivot = own[0];
            if pivot.is_nan() || pivot <= 0.0 {
                return None;
            }
            let scale = 1.0 / pivot.sqrt();
            own.iter_mut().for_each(|entry| *entry *= scale);
            for (apart, target) in (1..width).zip(later.chunks_exact_mut(width)) {
                let factor = own[apart];
                let entries = target.iter_mut().zip(&own[apart..]);
                entries.for_each(|(entry, l)| *entry -= factor * l);
            }
        }
        let columns = self.columns.chunks_exact(width);
        Some(Factor {
            band: self.band,
            below: columns
                .clone()
                .flat_map(|column| &column[1..])
                .map(|l| *l as f32)
                .collect(),
            inverse: columns.map(|column| (1.0 / column[0]) as f32).collect(),
        })
    }
}

impl Factor {
    /// Unknowns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.inverse.len()
    }

    /// Whether there is no unknown.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.inverse.is_empty()
    }

    /// Length of each right-hand side: as many as there are unknowns, and a band of zeros.
    #[must_use]
    pub fn padded(&self) -> usize {
        self.len() + self.band
    }

    /// Solves A x = b in place for three right-hand sides of [`Factor::padded`] length.
    pub fn solve(&self, sides: &mut [Vec<f32>; 3]) {
        let columns = || self.below.chunks_exact(self.band).zip(&self.inverse).enumerate();
        for (j, (below, inverse)) in columns() {
            for side in sides.iter_mut() {
                let Some((x, rest)) = side[j..].split_first_mut() else {
                    continue;
                };
                *x *= inverse;
                rest.iter_mut().zip(below).for_each(|(r, l)| *r -= *x * l);
            }
        }
        for (j, (below, inverse)) in columns().rev() {
            for side in sides.iter_mut() {
                let Some((x, rest)) = side[j..].split_first_mut() else {
                    continue;
                };
                *x = (*x - dot(below, rest)) * inverse;
            }
        }
    }
}

/// Inner product over the shorter of both, in a fixed order.
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let n = a.len().min(b.len());
    let (a_chunks, a_rest) = a[..n].as_chunks::<LANES>();
    let (b_chunks, b_rest) = b[..n].as_chunks::<LANES>();
    let mut lanes = [0.0; LANES];
    for (a, b) in a_chunks.iter().zip(b_chunks) {
        lanes
            .iter_mut()
            .zip(a.iter().zip(b))
            .for_each(|(lane, (a, b))| *lane += a * b);
    }
    let rest: f32 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    lanes.iter().sum::<f32>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Poisson's matrix on a grid of 5 × 7, band 5, against what it makes of a known vector.
    #[test]
    fn a_factor_solves_its_system() {
        let (nx, ny) = (5, 7);
        let n = nx * ny;
        let mut matrix = Band::zeros(n, nx);
        let pairs = (0..n).flat_map(|a| [(a % nx + 1 < nx, a, a + 1), (a + nx < n, a, a + nx)]);
        for (_, a, b) in pairs.filter(|(there, ..)| *there) {
            matrix.add(a, b, -1.0);
            matrix.add(a, a, 1.0);
            matrix.add(b, b, 1.0);
        }
        (0..n).for_each(|a| matrix.add(a, a, 0.5));
        let entry = |a: usize, b: usize| {
            let (low, high) = (a.min(b), a.max(b));
            if high - low > nx {
                0.0
            } else {
                matrix.columns[low * (nx + 1) + high - low] as f32
            }
        };
        let x = |side: usize, a: usize| ((a * 7 + side * 3) % 11) as f32 - 5.0;
        let mut sides: [Vec<f32>; 3] = std::array::from_fn(|side| {
            let row = |a| (0..n).map(|b| entry(a, b) * x(side, b)).sum();
            (0..n).map(row).chain(std::iter::repeat_n(0.0, nx)).collect()
        });
        matrix.clone().factor().unwrap().solve(&mut sides);
        for (side, solution) in sides.iter().enumerate() {
            for (a, value) in solution.iter().enumerate().take(n) {
                assert!((value - x(side, a)).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn an_indefinite_matrix_has_no_factor() {
        let mut matrix = Band::zeros(2, 1);
        matrix.add(0, 0, 1.0);
        matrix.add(1, 1, 1.0);
        matrix.add(0, 1, 2.0);
        assert_eq!(matrix.factor(), None);
    }
}
