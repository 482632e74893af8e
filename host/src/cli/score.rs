//! `sutura score`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use sutura::score;

/// Flags of `sutura score`.
#[derive(Args)]
pub(crate) struct ScoreArgs {
    /// Folder of a run: its scene.toml, force.csv, motion.csv and punctures.csv.
    session: PathBuf,
    /// The score as one JSON object.
    #[arg(long)]
    json: bool,
}

/// Scores a recorded run anew and writes its score.json and score.md.
pub(crate) fn run(args: &ScoreArgs) -> ExitCode {
    let scored = score::of(&args.session).and_then(|score| {
        score::write(&args.session, &score)?;
        Ok(score)
    });
    match scored {
        Ok(score) if args.json => crate::print_json(&score),
        Ok(score) => crate::say(format_args!("{score}\n")),
        Err(error) => return crate::fail(&error, args.json, 2),
    }
    ExitCode::SUCCESS
}
