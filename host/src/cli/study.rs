//! The commands of `sutura study`, one file each.

mod stability;

use std::process::ExitCode;

use clap::Subcommand;

#[derive(Subcommand)]
pub(crate) enum Study {
    /// Tries hard cases under every solver and law, and says which of them come to rest.
    Stability(stability::StabilityArgs),
}

/// Studies.
pub(crate) fn run(study: &Study) -> ExitCode {
    match study {
        Study::Stability(args) => stability::run(args),
    }
}
