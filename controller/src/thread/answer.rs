//! The points' own answer, while the thread is advanced in thought.

use super::factor::Factor;
use super::front::Condensed;
use crate::coupling::POINTS;
use crate::math::{Mat3, Vec3};

/// The displacements c that `reduced` and springs of `stiffness` [N/m] on every point agree on: (S + k) c = `load`.
pub(super) fn answer(reduced: &Condensed, stiffness: f32, load: &[Vec3; POINTS]) -> [Vec3; POINTS] {
    let (mut blocks, mut c) = (reduced.stiffness, *load);
    let len = reduced.len;
    for p in 0..len.min(POINTS) {
        let own = blocks[p][p] + Mat3::from_diagonal_element(stiffness);
        let factor = Factor::new(&own);
        let row = blocks[p];
        c[p] = factor.solve(c[p]);
        for q in p + 1..len.min(POINTS) {
            let to_q = row[q].transpose();
            let column = factor.solve_columns(&row[q]);
            blocks[p][q] = column;
            c[q] -= to_q * c[p];
            for r in p + 1..=q {
                let less = row[r].transpose() * column;
                blocks[r][q] -= less;
            }
        }
    }
    for p in (0..len.min(POINTS)).rev() {
        for q in p + 1..len.min(POINTS) {
            let moved = blocks[p][q] * c[q];
            c[p] -= moved;
        }
    }
    c
}
