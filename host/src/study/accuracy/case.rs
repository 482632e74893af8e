//! What every solver is given: blocks, materials and ways, and the dials of the solvers.

use std::fmt::{self, Display, Formatter};

use sutura_controller::lanes::Level;
use sutura_shared::check::Validate;
use sutura_shared::scene::{Assembly, Law, Solver};

use crate::study::block::{Block, Spec};
use crate::study::method::{Boxed, Method, NotBuilt};
use crate::study::path::{Course, Path};
use crate::study::poke;

/// Length of a run [ticks]: the ramp, and one period of the slower path.
pub const TICKS: u32 = 200;
/// Time in which a path reaches its full size [ms].
pub const RAMP_MS: u32 = 100;

/// One block on one way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// Nodes along x, y, z.
    pub nodes: [u32; 3],
    /// Young's modulus E of the first slope [Pa].
    pub young_pa: f64,
    /// Whether slopes are 1 : 4 : 10 with breaks at 3 and 6 %.
    pub stiffening: bool,
    /// Way of the moved node.
    pub path: Path,
}

impl Case {
    /// The work of `sutura poke` with its own defaults.
    #[must_use]
    pub fn request(&self, method: Method, level: Level) -> poke::Request {
        poke::Request {
            block: Spec {
                nodes: self.nodes,
                pitch_m: 2e-3,
                young_pa: self.young_pa,
                density_kg_m3: 1000.0,
                law: Law::Isotropic,
                assembly: Assembly::PerVoxel,
                stiffening: self.stiffening,
                damping_per_s: poke::DAMPING_PER_S,
            },
            mass_per_voxel: false,
            node: None,
            course: Course {
                path: self.path,
                ramp_s: f64::from(RAMP_MS) * 1e-3,
            },
            level,
            ticks: TICKS,
            method,
            reference: false,
            positions: None,
            forces: None,
        }
    }

    /// The same as words of the command line, for so many ticks.
    #[must_use]
    pub fn arguments(&self, method: Method, ticks: u32) -> Vec<String> {
        let mut arguments = vec!["poke".to_owned()];
        let flags = [
            ("--nodes", self.lattice()),
            ("--young-kpa", self.young_kpa().to_string()),
            ("--path", self.path.name().to_owned()),
            ("--solver", method.to_string()),
            ("--ramp-ms", RAMP_MS.to_string()),
            ("--run-ms", ticks.to_string()),
        ];
        arguments.extend(flags.into_iter().flat_map(|(flag, value)| [flag.to_owned(), value]));
        arguments.extend(self.stiffening.then(|| "--stiffening".to_owned()));
        arguments
    }

    /// Nodes along x, y and z, as `--nodes` takes them.
    #[must_use]
    pub fn lattice(&self) -> String {
        named(self.nodes)
    }

    /// Young's modulus [kPa].
    #[must_use]
    pub fn young_kpa(&self) -> f64 {
        self.young_pa * 1e-3
    }
}

/// A lattice by its nodes, as `--nodes` takes them.
#[must_use]
pub fn named([nx, ny, nz]: [u32; 3]) -> String {
    format!("{nx}x{ny}x{nz}")
}

/// A setting of a solver that means the same on every block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dial {
    /// Explicit substeps, as a multiple of the smallest stable count of the block.
    Explicit {
        /// How many times as many.
        times: u16,
    },
    /// A method with its numbers.
    Method(Method),
}

impl Dial {
    /// The solver's name alone.
    #[must_use]
    pub const fn solver(self) -> &'static str {
        match self {
            Self::Explicit { .. } | Self::Method(Method::Controller(Solver::Explicit { .. })) => "explicit",
            Self::Method(Method::Controller(Solver::BePcg { .. })) => "be-pcg",
            Self::Method(Method::Controller(Solver::BeChebyshev { .. })) => "be-chebyshev",
            Self::Method(Method::Controller(Solver::Vbd { .. })) => "vbd",
            Self::Method(Method::Xpbd { .. }) => "xpbd",
            Self::Method(Method::Pd { .. }) => "pd",
        }
    }

    /// The solver for a block, and the method with its numbers; `None` where it has none.
    #[must_use]
    pub fn build(self, block: &Block, level: Level) -> Option<(Method, Boxed)> {
        match self {
            Self::Method(method) => built(method, block, level),
            Self::Explicit { times } => {
                let (least, _) = built(Method::explicit(0), block, level)?;
                let substeps = least.explicit_substeps()?.checked_mul(times)?;
                let solver = Solver::Explicit { substeps };
                solver.validate().ok()?;
                built(Method::Controller(solver), block, level)
            }
        }
    }
}

fn built(method: Method, block: &Block, level: Level) -> Option<(Method, Boxed)> {
    let refused = |refused: NotBuilt| tracing::debug!("{refused}");
    method.build(block, level).map_err(refused).ok()
}

impl Display for Dial {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Explicit { times: 1 } => f.write_str("explicit"),
            Self::Explicit { times } => write!(f, "explicit ×{times}"),
            Self::Method(method) => method.fmt(f),
        }
    }
}

/// Everything that is to be measured: every dial on every combination.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// Nodes along x, y, z.
    pub lattices: Vec<[u32; 3]>,
    /// Young's moduli E [Pa].
    pub young_pa: Vec<f64>,
    /// Ways of the moved node.
    pub paths: Vec<Path>,
    /// Settings of the solvers.
    pub dials: Vec<Dial>,
    /// Largest lattice on which instructions are counted [nodes].
    pub counted: u32,
}

impl Matrix {
    /// The whole study.
    #[must_use]
    pub fn full() -> Self {
        Self {
            lattices: vec![[8, 8, 4], [12, 12, 6], [16, 16, 8], [24, 24, 12]],
            young_pa: vec![2e4, 1e5, 1e6, 1e7],
            paths: vec![Path::Drag, Path::Tap],
            dials: dials(
                &[1, 2],
                [&[2, 5, 10, 20, 40], &[5, 10, 20, 40], &[2, 4, 8, 16]],
                [&[5, 10, 20], &[2, 4, 8]],
            ),
            counted: u32::MAX,
        }
    }

    /// What is done in a minute: the two smaller lattices, E = 100 kPa, `drag`, and instructions on the smallest alone.
    #[must_use]
    pub fn quick() -> Self {
        Self {
            lattices: vec![[8, 8, 4], [12, 12, 6]],
            young_pa: vec![1e5],
            paths: vec![Path::Drag],
            dials: dials(&[1, 2], [&[5, 10, 20], &[5, 10, 20], &[2, 4, 8]], [&[5, 10], &[2, 4]]),
            counted: 8 * 8 * 4,
        }
    }

    /// All combinations on one lattice.
    pub(super) fn cases(&self, nodes: [u32; 3]) -> Vec<Case> {
        let mut cases = Vec::new();
        for &young_pa in &self.young_pa {
            for stiffening in [false, true] {
                cases.extend(self.paths.iter().map(|&path| Case {
                    nodes,
                    young_pa,
                    stiffening,
                    path,
                }));
            }
        }
        cases
    }
}

/// Every solver over its dial: multiples of the smallest explicit count; iterations of `be-pcg` with one and two Newton steps, iterations
/// of `be-chebyshev`, sweeps of `vbd` with and without over-relaxation; substeps of `xpbd` and iterations of `pd`.
fn dials(times: &[u16], [pcg, chebyshev, vbd]: [&[u16]; 3], [xpbd, pd]: [&[u16]; 2]) -> Vec<Dial> {
    let ours = |solver| Dial::Method(Method::Controller(solver));
    let mut dials: Vec<_> = times.iter().map(|&times| Dial::Explicit { times }).collect();
    for newton in [1, 2] {
        dials.extend(pcg.iter().map(|&iterations| ours(Solver::BePcg { iterations, newton })));
    }
    dials.extend(
        chebyshev
            .iter()
            .map(|&iterations| ours(Solver::BeChebyshev { iterations })),
    );
    for omega in [1.0, 1.7] {
        dials.extend(vbd.iter().map(|&sweeps| ours(Solver::Vbd { sweeps, omega })));
    }
    dials.extend(xpbd.iter().map(|&substeps| Dial::Method(Method::Xpbd { substeps })));
    dials.extend(pd.iter().map(|&iterations| Dial::Method(Method::Pd { iterations })));
    dials
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_dial_of_the_whole_study_is_a_method_of_the_command_line() {
        let matrix = Matrix::full();
        for dial in &matrix.dials {
            if let Dial::Method(method) = dial {
                assert_eq!(method.to_string().parse::<Method>(), Ok(*method));
            }
        }
        let names: std::collections::BTreeSet<_> = matrix.dials.iter().map(Dial::to_string).collect();
        assert_eq!(names.len(), matrix.dials.len());
        assert_eq!(matrix.cases([8, 8, 4]).len(), 4 * 2 * 2);
    }

    #[test]
    fn explicit_dials_are_multiples_and_end_where_scenes_end() {
        let case = Case {
            nodes: [4, 4, 3],
            young_pa: 1e7,
            stiffening: true,
            path: Path::Drag,
        };
        let level = Level::best();
        let block = Block::new(&case.request(Method::explicit(0), level).block).unwrap();
        let count = |times| {
            let (method, _) = Dial::Explicit { times }.build(&block, level)?;
            method.explicit_substeps()
        };
        let least = count(1).unwrap();
        assert_eq!(count(2), Some(2 * least));
        // A scene holds 1000 substeps at most.
        assert!(least > 250 && count(4).is_none(), "{least}");
    }
}
