//! `sutura poke`: every solver against an independent solve, its files, and its refusals.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod statics;

use std::path::Path as FilePath;
use std::sync::atomic::AtomicBool;

use statics::V;
use sutura::study::block::Spec;
use sutura::study::path::{Course, Path};
use sutura::study::poke::{self, DAMPING_PER_S, Error, Report, Request};
use sutura_controller::lanes::Level;
use sutura_shared::scene::{Assembly, Law};

/// Difference from the static solve, relative to the norm of its displacement and to its reaction.
const TOLERANCE: f64 = 2e-4;
/// Every solver there is, with what brings it to rest exactly enough.
const SOLVERS: [&str; 7] = [
    "explicit",
    "be-pcg:10",
    "be-pcg:10:2",
    "be-chebyshev:10",
    "vbd:8:1.5",
    "xpbd:200",
    "pd:8",
];
/// Long enough for all motion to die out [ticks].
const TICKS: u32 = 400;

/// The yardstick's work at 8×8×4.
fn request(solver: &str) -> Request {
    Request {
        block: Spec {
            nodes: [8, 8, 4],
            pitch_m: 2e-3,
            young_pa: 1e5,
            density_kg_m3: 1000.0,
            law: Law::Paper,
            assembly: Assembly::EveryEdge,
            stiffening: false,
            damping_per_s: DAMPING_PER_S,
        },
        mass_per_voxel: false,
        node: None,
        course: Course {
            path: Path::Lift { lift_m: 5e-3 },
            ramp_s: 0.1,
        },
        level: Level::best(),
        ticks: TICKS,
        method: solver.parse().unwrap(),
        reference: false,
        positions: None,
        forces: None,
    }
}

fn run(request: &Request) -> Result<Report, Error> {
    poke::run(request, &AtomicBool::new(false), |_, _| {})
}

/// The rows of a file of numbers, and its header.
fn table(path: &FilePath) -> (String, Vec<Vec<f64>>) {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header = lines.next().unwrap().to_owned();
    let rows = lines.map(|line| line.split(',').map(|number| number.parse().unwrap()).collect());
    (header, rows.collect())
}

fn block() -> statics::Block {
    statics::Block {
        nodes: [8, 8, 4],
        pitch: 2e-3,
        young: 1e5,
        lifted: [4, 4, 3],
        lift: 5e-3,
    }
}

/// `peers/ref.py` of the yardsticks, another double-precision solve of the same block (SciPy's sparse direct solver), gives
/// (−0.01043401784, −0.01043401784, −1.43645990517) N and a displacement norm of 7.963782961796 mm.
#[test]
fn the_static_solve_agrees_with_another() {
    let rest = block().at_rest();
    let expected = V::new(-0.010_434_017_84, -0.010_434_017_84, -1.436_459_905_17);
    assert!((rest.reaction - expected).norm() < 1e-9);
    let norm = rest.displacement.iter().map(V::norm_squared).sum::<f64>().sqrt();
    assert!((norm - 7.963_782_961_796e-3).abs() < 1e-12);
}

#[test]
fn every_solver_comes_to_rest_where_the_springs_balance() {
    let rest = block().at_rest();
    let norm = rest.displacement.iter().map(V::norm_squared).sum::<f64>().sqrt();
    let folder = tempfile::tempdir().unwrap();
    for solver in SOLVERS {
        let [positions, forces] = ["positions.csv", "forces.csv"].map(|name| folder.path().join(name));
        let report = run(&Request {
            positions: Some(positions.clone()),
            forces: Some(forces.clone()),
            ..request(solver)
        })
        .unwrap();
        assert!(report.finite, "{solver}");
        let (header, places) = table(&positions);
        assert_eq!((header.as_str(), places.len()), ("x_m,y_m,z_m", 256));
        let apart = places.iter().enumerate().map(|(node, place)| {
            let at = [node % 8, node / 8 % 8, node / 64].map(|n| n as f64 * 2e-3);
            (V::from_row_slice(place) - V::from(at) - rest.displacement[node]).norm_squared()
        });
        let shape = apart.sum::<f64>().sqrt() / norm;
        assert!(shape < TOLERANCE, "{solver}: shape {shape:e}");
        let (header, rows) = table(&forces);
        assert_eq!((header.as_str(), rows.len()), ("tick,fx_n,fy_n,fz_n", TICKS as usize));
        let last = rows.last().unwrap();
        let force = (V::from_row_slice(&last[1..]) - rest.reaction).norm() / rest.reaction.norm();
        assert!(force < TOLERANCE, "{solver}: force {force:e}");
        assert!((report.force_n - V::from_row_slice(&last[1..]).norm()).abs() < 1e-12);
    }
}

/// Bits of all places, all reactions and the report of one run.
fn bits(solver: &str, path: Path) -> (Vec<u8>, Vec<u8>, u64) {
    let folder = tempfile::tempdir().unwrap();
    let [positions, forces] = ["p", "f"].map(|name| folder.path().join(name));
    let mut request = request(solver);
    request.block.stiffening = true;
    request.course.path = path;
    request.ticks = 60;
    let report = run(&Request {
        positions: Some(positions.clone()),
        forces: Some(forces.clone()),
        ..request
    })
    .unwrap();
    (
        std::fs::read(positions).unwrap(),
        std::fs::read(forces).unwrap(),
        report.force_n.to_bits(),
    )
}

#[test]
fn two_runs_of_a_solver_end_in_the_same_bits() {
    for solver in SOLVERS {
        assert!(bits(solver, Path::Drag) == bits(solver, Path::Drag), "{solver}");
    }
}

/// More iterations come closer to the converged solution, and a Newton step more comes closer still.
#[test]
fn errors_against_the_converged_solution_fall_with_the_work() {
    let errors = ["be-pcg:3", "be-pcg:6", "be-pcg:40:3"].map(|solver| {
        let mut request = request(solver);
        request.course.path = Path::Tap;
        request.ticks = 100;
        request.reference = true;
        run(&request).unwrap().errors.unwrap()
    });
    let [few, more, many] = errors.map(|errors| [errors.force_error_rms, errors.force_error_max, errors.shape_error]);
    for ((few, more), many) in few.into_iter().zip(more).zip(many) {
        assert!(few > 1.5 * more && more > 10.0 * many, "{few:e} {more:e} {many:e}");
    }
    // What single precision leaves of a converged solve.
    assert!(many.into_iter().all(|error| error < 2e-5), "{many:?}");
}

/// Between two taps the tissue comes to rest: the rounding that is left of its energy holds nothing back when it is touched again.
#[test]
fn a_touch_after_a_pause_is_felt_in_full() {
    let mut request = request("be-chebyshev:10");
    request.block = Spec {
        nodes: [12, 12, 6],
        young_pa: 1e7,
        law: Law::Isotropic,
        assembly: Assembly::PerVoxel,
        ..request.block
    };
    request.course.path = Path::Tap;
    request.ticks = 200;
    request.reference = true;
    let errors = run(&request).unwrap().errors.unwrap();
    assert!(errors.force_error_max < 0.05, "{errors:?}");
}
