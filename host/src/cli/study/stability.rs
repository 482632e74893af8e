//! The flags of `sutura study stability`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use sutura::study::stability::{self, Request};
use sutura_controller::lanes::Level;
use sutura_shared::scene::Solver;

use crate::cli::flags::simd;

#[derive(Args)]
pub(crate) struct StabilityArgs {
    /// One case, or a family of them such as tool-teleported; without it every case.
    #[arg(long, value_name = "NAME")]
    case: Option<String>,
    /// explicit[:substeps], be-pcg[:iterations[:newton]], be-chebyshev[:iterations] or vbd[:sweeps[:omega]]; without it every solver.
    #[arg(long)]
    solver: Option<Solver>,
    /// Folder for stability.csv, .json, .md, .png and .svg.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Instructions to run on, instead of the best this processor has: off, sse2, avx2 or avx512. Results are the same.
    #[arg(long, value_name = "LEVEL", value_parser = simd)]
    simd: Option<Level>,
    /// The result as one JSON object on the last line of stdout.
    #[arg(long)]
    json: bool,
}

/// Tries.
pub(crate) fn run(args: &StabilityArgs) -> ExitCode {
    let request = Request {
        case: args.case.clone(),
        solver: args.solver,
        level: args.simd.unwrap_or_else(Level::best),
        out: args.out.clone(),
    };
    let interrupted = crate::interrupt();
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} runs, {elapsed} elapsed, {eta} left") {
        bar.set_style(style);
    }
    let result = stability::run(&request, &interrupted, |done, all| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    });
    bar.finish_and_clear();
    match result {
        Ok(report) if args.json => crate::print_json(&report),
        Ok(report) => crate::say(format_args!("{report}\n")),
        Err(error) => return crate::fail(&error, args.json, error.exit_code()),
    }
    ExitCode::SUCCESS
}
