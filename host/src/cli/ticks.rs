//! `sutura ticks`: the child process in which the instructions of a tick are counted; not for people.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use sutura::study::effects;
use sutura_controller::lanes::Level;

#[derive(Args)]
pub(crate) struct TicksArgs {
    /// A scene as it is uploaded.
    file: PathBuf,
    /// How many.
    count: u32,
}

/// Ticks the scene and prints the hash of all that happened.
pub(crate) fn run(args: &TicksArgs) -> ExitCode {
    match effects::ticks(&args.file, args.count, Level::best()) {
        Ok(hash) => crate::say(format_args!("{hash:016x}\n")),
        Err(error) => return crate::fail(&error, false, error.exit_code()),
    }
    ExitCode::SUCCESS
}
