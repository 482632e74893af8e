//! The commands of `sutura study`, one file each.

mod accuracy;
mod effects;
mod stability;

use std::process::ExitCode;

use clap::Subcommand;

#[derive(Subcommand)]
pub(crate) enum Study {
    /// Tells what accuracy costs in time: every solver over its dial, its error beside the time of its tick.
    Accuracy(accuracy::AccuracyArgs),
    /// Tries hard cases under every solver and law, and says which of them come to rest.
    Stability(stability::StabilityArgs),
    /// Measures what each effect of a scene costs, and how far force and wound move without it.
    Effects(effects::EffectsArgs),
}

/// Studies.
pub(crate) fn run(study: &Study) -> ExitCode {
    match study {
        Study::Accuracy(args) => accuracy::run(args),
        Study::Stability(args) => stability::run(args),
        Study::Effects(args) => effects::run(args),
    }
}
