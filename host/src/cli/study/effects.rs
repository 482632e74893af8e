//! The flags of `sutura study effects`.

use std::io::IsTerminal;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use indicatif::ProgressBar;
use sutura::study::effects::{self, Request};
use sutura_controller::lanes::Level;

use crate::cli::flags;

#[derive(Args)]
pub(crate) struct EffectsArgs {
    /// Scene file; without one the built-in scene.
    #[arg(long, value_name = "SCENE.toml")]
    scene: Option<PathBuf>,
    /// Folder for effects.csv, .json, .md, .png and .svg.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Counts instructions over fewer ticks: under a minute in all.
    #[arg(long)]
    quick: bool,
    /// Instructions to take times on, instead of the best this processor has: off, sse2, avx2 or avx512.
    #[arg(long, value_name = "LEVEL", value_parser = flags::simd)]
    simd: Option<Level>,
    /// The result as one JSON object on the last line of stdout.
    #[arg(long)]
    json: bool,
}

/// Studies.
pub(crate) fn run(args: &EffectsArgs) -> ExitCode {
    let request = Request {
        scene: args.scene.clone(),
        quick: args.quick,
        level: args.simd.unwrap_or_else(Level::best),
        program: match std::env::current_exe() {
            Ok(program) => program,
            Err(error) => return crate::fail(&error, args.json, 2),
        },
        out: args.out.clone(),
    };
    let bar = if std::io::stderr().is_terminal() {
        ProgressBar::new_spinner()
    } else {
        ProgressBar::hidden()
    };
    let result = effects::run(&request, &crate::interrupt(), &mut |what| {
        bar.set_message(what.to_owned());
        bar.tick();
    });
    bar.finish_and_clear();
    match result {
        Ok(report) if args.json => crate::print_json(&report),
        Ok(report) => crate::say(format_args!("{report}\n")),
        Err(error) => return crate::fail(&error, args.json, error.exit_code()),
    }
    ExitCode::SUCCESS
}
