//! The flags of `sutura study accuracy`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use sutura::study::accuracy::case::Matrix;
use sutura::study::accuracy::{self, Progress, Request};
use sutura::study::limit;
use sutura_controller::lanes::Level;

#[derive(Args)]
pub(crate) struct AccuracyArgs {
    /// Two small lattices and one stiffness, in a minute.
    #[arg(long)]
    quick: bool,
    /// Source of the C kernel that times are compared with; its path is relative to the current folder.
    #[arg(long, value_name = "PATH", default_value = limit::SOURCE)]
    limit_source: PathBuf,
    /// Folder for accuracy.csv, .json, .md, .png and .svg.
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
    let program = std::env::current_exe()
        .inspect_err(|error| tracing::warn!("no instructions are counted: this program cannot be found ({error})"))
        .ok();
    let request = Request {
        matrix: if args.quick { Matrix::quick() } else { Matrix::full() },
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
