//! The flags of `sutura study accuracy`.

use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use sutura::scene::setting::BUDGET_US;
use sutura::study::accuracy::case::Matrix;
use sutura::study::accuracy::statics::Extent;
use sutura::study::accuracy::{self, Progress, Request};
use sutura::study::budget::study;
use sutura::study::limit;
use sutura_controller::lanes::Level;

#[derive(Args)]
pub(crate) struct AccuracyArgs {
    /// Two small lattices and one stiffness, in a minute.
    #[arg(long, conflicts_with_all = ["scene", "budget_us"])]
    quick: bool,
    /// Whole ticks of this scene instead of plain blocks; with --budget-us alone of the built-in one.
    #[arg(long, value_name = "SCENE.toml")]
    scene: Option<PathBuf>,
    /// Chooses the most accurate solver of a scene whose tick takes no longer, in µs [default with --scene: 1000].
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(budget()))]
    budget_us: Option<u16>,
    /// Source of the C kernel that times are compared with; its path is relative to the current folder.
    #[arg(long, value_name = "PATH", default_value = limit::SOURCE, conflicts_with_all = ["scene", "budget_us"])]
    limit_source: PathBuf,
    /// Folder for accuracy.csv, .json, .md, .png and .svg, and pitch.png and .svg; of a scene budget.csv, .json and .png.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// The result as one JSON object on the last line of stdout.
    #[arg(long)]
    json: bool,
}

/// Steps of the bar.
const STEPS: u64 = 1000;

/// Studies.
pub(crate) fn run(args: &AccuracyArgs) -> ExitCode {
    if args.scene.is_some() || args.budget_us.is_some() {
        return run_scene(args);
    }
    let program = std::env::current_exe()
        .inspect_err(|error| tracing::warn!("no instructions are counted: this program cannot be found ({error})"))
        .ok();
    let request = Request {
        matrix: if args.quick { Matrix::quick() } else { Matrix::full() },
        statics: Some(if args.quick { Extent::Quick } else { Extent::Whole }),
        level: Level::best(),
        limit_source: args.limit_source.clone(),
        program,
        out: args.out.clone(),
    };
    let interrupted = crate::interrupt();
    let bar = ProgressBar::new(STEPS);
    if let Ok(style) = ProgressStyle::with_template("{prefix:>12} {bar:40} {percent:>3} %, {elapsed} elapsed") {
        bar.set_style(style);
    }
    let result = accuracy::run(&request, &interrupted, &|progress| {
        let (prefix, part) = match progress {
            Progress::Errors(part) => ("errors", part),
            Progress::Statics(part) => ("pitch, model", part),
            Progress::Times(part) => ("times", part),
            Progress::Instructions(part) => ("instructions", part),
        };
        bar.set_prefix(prefix);
        bar.set_position((part * STEPS as f64) as u64);
    });
    bar.finish_and_clear();
    match result {
        Ok(report) if args.json => crate::print_json(&report),
        Ok(report) => crate::say(format_args!("{report}")),
        Err(error) => return crate::fail(&error, args.json, error.exit_code()),
    }
    ExitCode::SUCCESS
}

/// Studies one scene.
fn run_scene(args: &AccuracyArgs) -> ExitCode {
    let request = study::Request {
        scene: args.scene.clone(),
        budget_us: args.budget_us.unwrap_or(*BUDGET_US.end()),
        level: Level::best(),
        out: args.out.clone(),
    };
    match study::run(&request, &crate::interrupt()) {
        Ok(table) if args.json => crate::print_json(&table),
        Ok(table) => crate::say(format_args!("{table}\n")),
        Err(error) => return crate::fail(&error, args.json, error.exit_code()),
    }
    ExitCode::SUCCESS
}

/// Budgets as clap counts them.
fn budget() -> RangeInclusive<i64> {
    i64::from(*BUDGET_US.start())..=i64::from(*BUDGET_US.end())
}
