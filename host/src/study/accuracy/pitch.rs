//! What the pitch costs: the same body, tool and depth at several pitches against closed forms, and the order with which the error falls.
//!
//! The lattice at small strain and at rest, isotropic law, per-voxel assembly, in double precision, without the controller's capacity.
//! A smooth rigid sphere and a flat punch on a half-space, and a cantilever under a load on its end.
//!
//! What counts is the pitch over what has to be resolved: 3 to 12 voxels in the radius of the contact, or through the beam. A tool is a
//! rule on nodes: the punch takes those within its radius, the sphere those that it would otherwise pass through; neither pulls. As a
//! disc of nodes is a staircase, `punch` is held against the circle whose area its nodes stand for, a² each, and `punch-nominal` against its radius.

mod beam;
mod halfspace;

use std::sync::atomic::{AtomicUsize, Ordering};

use serde::Serialize;
use sutura_shared::scene::{Assembly, Law};

use super::body::Body;
use super::statics::{self, Extent};
use crate::study::block::{self, Spec};
use crate::study::{parallel, poke};

/// Pitches of the whole study [mm].
const PITCHES_MM: [f64; 5] = [4.0, 3.0, 2.0, 1.5, 1.0];
/// How many of them a quick one leaves out: the finest take most of the time.
const LEFT_OUT: usize = 2;

/// E [Pa].
const YOUNG: f64 = 1e5;
/// ν of the isotropic lattice.
const POISSON: f64 = 0.25;
/// The cases, in the order of the rows, and what people call them.
pub(super) const CASES: [(&str, &str); 4] = [
    (HERTZ, "sphere (Hertz)"),
    (PUNCH, "flat punch (Boussinesq)"),
    (NOMINAL, "flat punch, nominal radius"),
    (CANTILEVER, "cantilever (Timoshenko)"),
];
const HERTZ: &str = "hertz";
const PUNCH: &str = "punch";
const NOMINAL: &str = "punch-nominal";
const CANTILEVER: &str = "cantilever";

/// One case at one pitch.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// `hertz`, `punch`, `punch-nominal` or `cantilever`.
    pub case: &'static str,
    /// Voxel edge a [mm].
    pub pitch_mm: f64,
    /// Nodes of the lattice: of a half-space, of the quarter that symmetry leaves to solve.
    pub nodes: usize,
    /// What the lattice gives.
    pub measured: f64,
    /// What the closed form gives.
    pub expected: f64,
    /// Unit of both.
    pub unit: &'static str,
    /// Measured over expected, minus one.
    pub error: f64,
    /// Root mean square of the force's error on the way to that depth, over that of the force: of a sphere, whose contact grows node
    /// by node; else the size of `error`, at every depth the same.
    pub path_error: f64,
    /// Order of the case over all its pitches: slope of log `path_error` over log pitch, by least squares.
    pub order: f64,
}

/// What solves the cases of one body at a pitch [m].
type Solve = fn(f64) -> Result<Vec<Force>, poke::Error>;
const BODIES: [Solve; 2] = [halfspace::forces, beam::forces];

/// Solves every case at every pitch; `go_on` may end it between two solves, `progress` is told how much is done, from 0 to 1.
///
/// # Errors
/// That of `go_on`, or a body that the controller refuses or that does not come to rest: a defect of ours.
pub fn run(
    extent: Extent,
    go_on: &(impl Fn() -> Result<(), poke::Error> + Sync),
    progress: &(impl Fn(f64) + Sync),
) -> Result<Vec<Row>, poke::Error> {
    let pitches_mm = match extent {
        Extent::Quick => &PITCHES_MM[..PITCHES_MM.len() - LEFT_OUT],
        Extent::Whole => &PITCHES_MM[..],
    };
    // The finest takes most of the time, so it comes first.
    let finest_first = pitches_mm.iter().rev();
    let works: Vec<_> = finest_first
        .flat_map(|pitch| BODIES.map(|solve| (solve, pitch * 1e-3)))
        .collect();
    let done = AtomicUsize::new(0);
    let work = |(solve, pitch_m): &(Solve, f64)| -> Result<_, poke::Error> {
        go_on()?;
        let forces = solve(*pitch_m)?;
        progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / works.len() as f64);
        Ok(forces)
    };
    let forces = parallel::map(&works, statics::workers(), work)?;
    let forces: Vec<Force> = forces.into_iter().rev().flatten().collect();
    Ok(CASES.into_iter().flat_map(|(case, _)| rows(case, &forces)).collect())
}

/// A force, and what it should be.
struct Force {
    case: &'static str,
    pitch_m: f64,
    nodes: usize,
    /// [N].
    measured: f64,
    /// [N].
    expected: f64,
    path_error: f64,
}

impl Force {
    /// Of a body whose force goes with the depth.
    fn linear(case: &'static str, [measured, expected]: [f64; 2], pitch_m: f64, nodes: usize) -> Self {
        Self {
            case,
            pitch_m,
            nodes,
            measured,
            expected,
            path_error: (measured / expected - 1.0).abs(),
        }
    }
}

fn rows(case: &'static str, forces: &[Force]) -> Vec<Row> {
    let mine = || forces.iter().filter(|force| force.case == case);
    let points: Vec<_> = mine().map(|force| (force.pitch_m, force.path_error)).collect();
    let order = order(&points);
    let row = |force: &Force| Row {
        case,
        pitch_mm: force.pitch_m * 1e3,
        nodes: force.nodes,
        measured: force.measured,
        expected: force.expected,
        unit: "N",
        error: force.measured / force.expected - 1.0,
        path_error: force.path_error,
        order,
    };
    mine().map(row).collect()
}

/// Slope of log error over log pitch, by least squares.
fn order(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let logs = || points.iter().map(|(pitch, error)| (pitch.ln(), error.ln()));
    let (sum_x, sum_y) = logs().fold((0.0, 0.0), |(x, y), at| (x + at.0, y + at.1));
    let (mean_x, mean_y) = (sum_x / count, sum_y / count);
    let along: f64 = logs().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let spread: f64 = logs().map(|(x, _)| (x - mean_x).powi(2)).sum();
    along / spread
}

/// A full box of `size_mm`, which the pitch divides.
fn body(size_mm: [f64; 3], pitch_m: f64) -> Result<Body, block::Error> {
    Body::new(&Spec {
        nodes: voxels(size_mm, pitch_m).map(|n| n + 1),
        pitch_m,
        young_pa: YOUNG,
        density_kg_m3: 1000.0,
        law: Law::Isotropic,
        assembly: Assembly::PerVoxel,
        stiffening: false,
        damping_per_s: 0.0,
    })
}

fn voxels(size_mm: [f64; 3], pitch_m: f64) -> [u32; 3] {
    size_mm.map(|size| (size * 1e-3 / pitch_m).round() as u32)
}

#[cfg(test)]
mod tests;
