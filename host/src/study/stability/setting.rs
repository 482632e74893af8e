//! What a case is run under: a solver, a law, and the shape of the tissue's curve.

use std::fmt::{self, Display, Formatter};

use sutura_shared::scene::{Assembly, Law, Solver};

/// A solver and what the springs are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// How the tissue is advanced.
    pub solver: Solver,
    /// From E to springs.
    pub springs: Springs,
}

/// What the springs are; its text is the `law` of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Springs {
    /// From E to stiffness.
    pub law: Law,
    /// What voxels that share an edge give it.
    pub assembly: Assembly,
    /// Stress over strain.
    pub curve: Curve,
}

/// Stress over strain of the tissue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curve {
    /// One slope; voxels that lose volume do not lock.
    Linear,
    /// Slopes 1 : 4 : 10 with breaks at strains of 3 and 6 %.
    Stiffening,
}

impl Setting {
    /// What scenes have where they choose nothing.
    pub const DEFAULT: Self = Self {
        solver: SOLVERS[0],
        springs: SPRINGS[0],
    };
}

/// The solvers of the table; the first is the default.
pub const SOLVERS: [Solver; 6] = [
    Solver::BePcg {
        iterations: 10,
        newton: 1,
    },
    Solver::BePcg {
        iterations: 10,
        newton: 2,
    },
    Solver::BeChebyshev { iterations: 10 },
    Solver::Vbd { sweeps: 8, omega: 1.5 },
    Solver::Vbd { sweeps: 8, omega: 1.0 },
    Solver::Explicit { substeps: 0 },
];

/// The springs of the table; the first are the default.
pub const SPRINGS: [Springs; 8] = [
    stiffening(Law::Isotropic),
    Springs {
        curve: Curve::Linear,
        ..stiffening(Law::Isotropic)
    },
    stiffening(Law::Axial),
    stiffening(Law::Paper),
    Springs {
        assembly: Assembly::EveryEdge,
        ..stiffening(Law::Paper)
    },
    stiffening(Law::Volume { poisson: 0.3 }),
    stiffening(Law::Volume { poisson: 0.45 }),
    stiffening(Law::Volume { poisson: 0.49 }),
];

/// Every solver, or the one named, with all springs.
#[must_use]
pub fn all(solver: Option<Solver>) -> Vec<Setting> {
    let solvers = solver.map_or_else(|| SOLVERS.to_vec(), |solver| vec![solver]);
    let with = |solver| SPRINGS.map(|springs| Setting { solver, springs });
    solvers.into_iter().flat_map(with).collect()
}

const fn stiffening(law: Law) -> Springs {
    Springs {
        law,
        assembly: Assembly::PerVoxel,
        curve: Curve::Stiffening,
    }
}

impl Display for Springs {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(self.law.name())?;
        if let Law::Volume { poisson } = self.law {
            write!(f, ":{poisson}")?;
        }
        if self.assembly == Assembly::EveryEdge {
            write!(f, " {}", self.assembly.name())?;
        }
        if self.curve == Curve::Linear {
            f.write_str(" linear")?;
        }
        Ok(())
    }
}
