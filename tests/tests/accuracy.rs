//! `sutura study accuracy`: what its rows say of every solver, held to what is known of the methods.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used)]

use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

use sutura::study::accuracy::case::{Case, Dial, Matrix};
use sutura::study::accuracy::{self, Report, Request, Row};
use sutura::study::path::Path;
use sutura::study::poke;
use sutura_controller::lanes::Level;

const NODES: [u32; 3] = [8, 8, 4];
const YOUNG_PA: f64 = 1e5;

fn method(solver: &str) -> Dial {
    Dial::Method(solver.parse().unwrap())
}

/// The study of the smallest lattice, without kernel and counts, once for all tests.
fn report() -> &'static Report {
    static REPORT: OnceLock<Report> = OnceLock::new();
    REPORT.get_or_init(|| {
        let solvers = [
            "be-pcg:5:2",
            "be-pcg:10:2",
            "be-pcg:20:2",
            "be-chebyshev:5",
            "be-chebyshev:10",
            "vbd:2:1",
            "vbd:4:1",
            "vbd:8:1",
            "vbd:8:1.7",
            "xpbd:10",
            "xpbd:20",
            "pd:4",
        ];
        let explicit = [1, 2].map(|times| Dial::Explicit { times });
        let folder = tempfile::tempdir().unwrap();
        let request = Request {
            matrix: Matrix {
                lattices: vec![NODES],
                young_pa: vec![YOUNG_PA],
                paths: vec![Path::Drag],
                dials: explicit.into_iter().chain(solvers.map(method)).collect(),
                counted: 0,
            },
            statics: None,
            level: Level::best(),
            limit_source: folder.path().join("kernel.c"),
            program: None,
            out: folder.path().join("out"),
        };
        accuracy::run(&request, &AtomicBool::new(false), &|_| {}).unwrap()
    })
}

fn row(solver: &str, stiffening: bool) -> &'static Row {
    let found = |row: &&Row| row.solver == solver && row.stiffening == stiffening;
    report().rows.iter().find(found).unwrap()
}

fn solver_error(solver: &str, stiffening: bool) -> f64 {
    row(solver, stiffening).solver_error.unwrap()
}

#[test]
fn every_solver_has_a_row_and_stays_finite() {
    let report = report();
    assert_eq!(report.rows.len(), 2 * 14);
    for row in &report.rows {
        assert!(row.finite && row.us_median > 0.0, "{}", row.solver);
    }
    assert_eq!(report.lattices[0].settings.len(), 14);
}

/// Each solver converges to its scheme: the more work, the less error.
#[test]
fn errors_fall_as_the_dials_rise() {
    for stiffening in [false, true] {
        for solvers in [
            ["be-pcg:5:2", "be-pcg:10:2", "be-pcg:20:2"].as_slice(),
            &["be-chebyshev:5", "be-chebyshev:10"],
            &["vbd:2:1", "vbd:4:1", "vbd:8:1", "vbd:8:1.7"],
            &["xpbd:10", "xpbd:20"],
        ] {
            let errors: Vec<_> = solvers.iter().map(|solver| solver_error(solver, stiffening)).collect();
            assert!(
                errors.windows(2).all(|pair| pair[1] < pair[0]),
                "{solvers:?}: {errors:?}"
            );
        }
        let explicit = report()
            .rows
            .iter()
            .filter(|row| row.solver.starts_with("explicit") && row.stiffening == stiffening);
        let errors: Vec<_> = explicit.map(|row| row.solver_error.unwrap()).collect();
        assert!(errors[1] < errors[0], "explicit: {errors:?}");
    }
}

/// The solution of the equation of motion, that of backward Euler and a solver's are the corners of a triangle: total and solver error of
/// any solver of the scheme differ by no more than the scheme's own error. That is about 0.1 % where the step of 1 ms resolves the way (the
/// scheme is of first order: it lags by half a step of 2π·10 Hz·0.5 ms = 3 % in what depends on velocity alone, here inertia and damping).
#[test]
fn the_time_steps_own_error_stands_between_solver_and_total_error() {
    for stiffening in [false, true] {
        let best = row("vbd:8:1.7", stiffening);
        let (least, total) = (best.solver_error.unwrap(), best.total_error.unwrap());
        let own = total + least;
        assert!(total > 2e-4 && total - least < 5e-3, "{least:e} {total:e}");
        for solver in ["be-pcg:5:2", "be-pcg:20:2", "be-chebyshev:10", "vbd:2:1", "pd:4"] {
            let row = row(solver, stiffening);
            let apart = row.total_error.unwrap() - row.solver_error.unwrap();
            // Both are relative to their own reference's force, which differ by as much.
            assert!(apart.abs() < 1.05 * own, "{solver}: {apart:e} of {own:e}");
        }
        for solver in ["xpbd:10", "xpbd:20"] {
            let row = row(solver, stiffening);
            assert_eq!(
                row.solver_error, row.total_error,
                "{solver} approximates the equation of motion itself"
            );
        }
    }
}

/// The shared references give what `sutura poke --reference` computes beside its own run.
#[test]
fn a_row_is_what_poke_says() {
    for (solver, stiffening) in [("be-pcg:10:2", true), ("xpbd:10", false)] {
        let case = Case {
            nodes: NODES,
            young_pa: YOUNG_PA,
            stiffening,
            path: Path::Drag,
        };
        let mut request = case.request(solver.parse().unwrap(), Level::best());
        request.reference = true;
        let errors = poke::run(&request, &AtomicBool::new(false), |_, _| {})
            .unwrap()
            .errors
            .unwrap();
        let row = row(solver, stiffening);
        for (ours, its) in [
            (row.solver_error, errors.force_error_rms),
            (row.force_error_max, errors.force_error_max),
            (row.shape_error, errors.shape_error),
        ] {
            assert!((ours.unwrap() / its - 1.0).abs() < 1e-9, "{solver}: {ours:?} {its}");
        }
    }
}

#[test]
fn what_is_missing_is_noted() {
    let report = report();
    let ratios = report.rows.iter().map(|row| row.limit_ratio);
    assert!(ratios.clone().all(|ratio| ratio.is_none()));
    assert!(report.rows.iter().all(|row| row.instructions.is_none()));
    assert!(
        report.notes.iter().any(|note| note.contains("kernel.c")),
        "{:?}",
        report.notes
    );
}
