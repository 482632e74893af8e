//! Sums in a fixed order: sixteen lanes, then a tree, on every target.

use crate::lattice::Field;

const LANES: usize = 16;

/// Inner product of two fields over their first `n` nodes.
pub(super) fn dot<const N: usize>(a: &Field<N>, b: &Field<N>, n: usize) -> f32 {
    let mut lanes = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        accumulate(&mut lanes, a.get(..n).unwrap_or(a), b.get(..n).unwrap_or(b));
    }
    sum(lanes)
}

#[inline]
pub(super) fn accumulate(lanes: &mut [f32; LANES], a: &[f32], b: &[f32]) {
    let (a_chunks, a_rest) = a.as_chunks::<LANES>();
    let (b_chunks, b_rest) = b.as_chunks::<LANES>();
    for (a, b) in a_chunks.iter().zip(b_chunks) {
        for (lane, (a, b)) in lanes.iter_mut().zip(a.iter().zip(b)) {
            *lane += a * b;
        }
    }
    for (lane, (a, b)) in lanes.iter_mut().zip(a_rest.iter().zip(b_rest)) {
        *lane += a * b;
    }
}

/// Sum of the lanes as a tree: halves are added until one lane is left.
pub(super) fn sum(lanes: [f32; LANES]) -> f32 {
    let [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = lanes;
    let eight = [a + i, b + j, c + k, d + l, e + m, f + n, g + o, h + p];
    let [a, b, c, d, e, f, g, h] = eight;
    let [a, b, c, d] = [a + e, b + f, c + g, d + h];
    (a + c) + (b + d)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dot_product_counts_every_node_once() {
        let mut a = [[0.0_f32; 100]; 3];
        let mut b = a;
        for (c, (a, b)) in a.iter_mut().zip(&mut b).enumerate() {
            for (n, (a, b)) in a.iter_mut().zip(b).enumerate() {
                (*a, *b) = (n as f32, (c + 1) as f32);
            }
        }
        // Σ_{n<37} n · (1 + 2 + 3)
        assert!((dot(&a, &b, 37) - 6.0 * 666.0).abs() < 1e-3);
    }
}
