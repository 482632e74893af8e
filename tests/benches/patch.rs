//! The speed of the patch beside the leanest C kernel, in one table: `cargo bench -p sutura-tests --bench patch`.
//!
//! A row is the work of `sutura poke` on a block, its time the thread's CPU time of the solver alone. The C kernel does five explicit substeps
//! of the bare lattice of as many nodes, on the same core in turn with the row, and only the ratio means anything. It fails where a ratio is above
//! its goal. With SUTURA_FULL=1 the rows that state an accuracy are compared with the converged solution too, which takes minutes.

use std::error::Error;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use sutura::study::block::Spec;
use sutura::study::path::{Course, Path};
use sutura::study::poke::{self, DAMPING_PER_S, Request};
use sutura_controller::lanes::Level;
use sutura_shared::scene::{Assembly, Law};
use sutura_tests::{full, yardstick};

/// Turns of yardstick and row; the machine's other work only ever makes them slower, so the fastest counts.
const TURNS: usize = 5;
/// Largest force error of a row that states an accuracy: root mean square and maximum, over the reaction's root mean square.
const ACCURACY: [f64; 2] = [0.01, 0.05];
/// The one setting that is accurate on every block and path.
const ACCURATE: &str = "be-pcg:10:2";

/// One row of the table.
struct Row {
    solver: &'static str,
    nodes: [u32; 3],
    young_pa: f64,
    stiffening: bool,
    path: Path,
    /// Median and 99th percentile of a tick over the yardstick's median, at most.
    goal: [f64; 2],
    /// Whether the force is to be accurate.
    accurate: bool,
}

fn main() -> ExitCode {
    println!(
        "one core, instructions {}; C: five explicit substeps of as many nodes; times are CPU time a tick\n",
        Level::best().name()
    );
    println!(
        "{:<11} {:<9} {:>6} {:<6} {:<6} {:>8} {:>9} {:>6} {:>6} {:>9} {:>6} {:>6} {:>9} {:>9}",
        "solver",
        "nodes",
        "E MPa",
        "curve",
        "path",
        "C us",
        "median us",
        "ratio",
        "goal",
        "p99 us",
        "ratio",
        "goal",
        "rms err",
        "max err"
    );
    let compare = full("the errors of the accuracy rows");
    match rows()
        .iter()
        .map(|row| judge(row, compare))
        .collect::<Result<Vec<_>, _>>()
    {
        Ok(within) if within.iter().all(|within| *within) => ExitCode::SUCCESS,
        Ok(_) => {
            println!("\nabove a goal");
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn rows() -> Vec<Row> {
    let lift = |solver, nodes, goal| Row {
        solver,
        nodes,
        young_pa: 1e5,
        stiffening: false,
        path: Path::Lift { lift_m: 5e-3 },
        goal: [goal, f64::INFINITY],
        accurate: false,
    };
    let mut rows = vec![
        lift("explicit:5", [16, 16, 8], 1.1),
        lift("explicit:5", [24, 24, 12], 1.1),
        lift("be-pcg:10", [12, 12, 6], 5.5),
        lift("be-pcg:10", [16, 16, 8], 7.8),
    ];
    for young_pa in [1e5, 1e6, 1e7] {
        for path in [Path::Drag, Path::Tap] {
            rows.extend([false, true].map(|stiffening| Row {
                solver: ACCURATE,
                nodes: [24, 24, 12],
                young_pa,
                stiffening,
                path,
                goal: [4.7, 6.0],
                accurate: true,
            }));
        }
    }
    rows
}

/// Measures and prints a row; gives whether it is within its goals.
fn judge(row: &Row, compare: bool) -> Result<bool, Box<dyn Error>> {
    let mut request = request(row)?;
    let (mut limit, mut median, mut p99) = (Some(f64::INFINITY), f64::INFINITY, f64::INFINITY);
    for _ in 0..TURNS {
        limit = limit.and_then(|best| yardstick::limit_us(row.nodes).map(|now| best.min(now)));
        let time = poke::run(&request, &AtomicBool::new(false), |_, _| {})?.us_per_tick;
        (median, p99) = (median.min(time.median), p99.min(time.p99));
    }
    let errors = if compare && row.accurate {
        request.reference = true;
        poke::run(&request, &AtomicBool::new(false), |_, _| {})?.errors
    } else {
        None
    };
    let ratios = limit.map(|limit| [median / limit, p99 / limit]);
    let within = ratios.is_none_or(|ratios| ratios.iter().zip(&row.goal).all(|(ratio, goal)| ratio <= goal));
    let accurate = errors.is_none_or(|e| e.force_error_rms <= ACCURACY[0] && e.force_error_max <= ACCURACY[1]);
    print(
        row,
        limit,
        [median, p99],
        errors.map(|e| [e.force_error_rms, e.force_error_max]),
    );
    Ok(within && accurate)
}

fn print(row: &Row, limit: Option<f64>, times: [f64; 2], errors: Option<[f64; 2]>) {
    let [x, y, z] = row.nodes;
    let path = row.path.name();
    let columns = times.iter().zip(&row.goal).map(|(time, goal)| {
        let ratio = limit.map_or_else(|| "-".to_owned(), |limit| format!("{:.2}", time / limit));
        let goal = if goal.is_finite() {
            goal.to_string()
        } else {
            String::new()
        };
        format!("{time:>9.1} {ratio:>6} {goal:>6}")
    });
    let errors = errors.map_or_else(String::new, |errors| {
        errors.map(|error| format!("{:>8.2}%", 100.0 * error)).join(" ")
    });
    println!(
        "{:<11} {:<9} {:>6} {:<6} {path:<6} {:>8} {} {errors}",
        row.solver,
        format!("{x}x{y}x{z}"),
        format!("{:.1}", row.young_pa * 1e-6),
        if row.stiffening { "1:4:10" } else { "line" },
        limit.map_or_else(|| "-".to_owned(), |limit| format!("{limit:.1}")),
        columns.collect::<Vec<_>>().join(" ")
    );
}

/// The yardstick's own lattice: the paper's law, every edge whole.
fn request(row: &Row) -> Result<Request, Box<dyn Error>> {
    Ok(Request {
        block: Spec {
            nodes: row.nodes,
            pitch_m: 2e-3,
            young_pa: row.young_pa,
            density_kg_m3: 1000.0,
            law: Law::Paper,
            assembly: Assembly::EveryEdge,
            stiffening: row.stiffening,
            damping_per_s: DAMPING_PER_S,
        },
        mass_per_voxel: false,
        node: None,
        level: Level::best(),
        course: Course {
            path: row.path,
            ramp_s: 0.1,
        },
        ticks: 400,
        method: row.solver.parse()?,
        reference: false,
        positions: None,
        forces: None,
    })
}
