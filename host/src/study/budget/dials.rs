//! The solvers that are looked at, family by family, each from its cheapest on.

use sutura_shared::scene::Solver;

/// Iterations of a linear solve.
const ITERATIONS: [u16; 7] = [3, 5, 7, 10, 15, 20, 30];
/// Newton steps.
const NEWTON: [u16; 3] = [1, 2, 3];
/// Sweeps of vertex block descent, and its over-relaxation.
const SWEEPS: [u16; 5] = [2, 4, 8, 16, 32];
const OMEGA: f32 = 1.5;

/// All of them; `substeps` are the fewest explicit ones that are stable.
pub(crate) fn families(substeps: Option<u16>) -> Vec<Vec<Solver>> {
    let conjugate = NEWTON.map(|newton| {
        let dials = ITERATIONS.map(|iterations| Solver::BePcg { iterations, newton });
        dials.to_vec()
    });
    let chebyshev = ITERATIONS.map(|iterations| Solver::BeChebyshev { iterations });
    let descent = SWEEPS.map(|sweeps| Solver::Vbd { sweeps, omega: OMEGA });
    let explicit = substeps.map(|substeps| Solver::Explicit { substeps });
    let others = [chebyshev.to_vec(), descent.to_vec(), explicit.into_iter().collect()];
    conjugate.into_iter().chain(others).collect()
}
