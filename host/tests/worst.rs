//! How even a tick's work is: the dearest tick of a whole stitch against the median, in instructions.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use sutura::study::callgrind;

/// Quarter of an hour, so with SUTURA_FULL=1 only.
#[test]
fn the_dearest_tick_of_a_stitch_takes_little_more_than_the_median() {
    if std::env::var_os("SUTURA_FULL").is_none() {
        eprintln!("skipped: the dearest tick of a stitch: it needs SUTURA_FULL=1, as `.ci/run --full` sets it");
        return;
    }
    if let Err(error) = callgrind::present() {
        eprintln!("skipped: the dearest tick of a stitch: {error}");
        return;
    }
    let program = Path::new(env!("CARGO_BIN_EXE_sutura"));
    let out = tempfile::tempdir().unwrap();
    let arguments = ["run", "--headless", "--out", out.path().to_str().unwrap()];
    let mut ticks = callgrind::calls(program, &arguments, "sutura_controller::tick::Controller<_>::tick").unwrap();
    ticks.sort_unstable();
    let (median, most) = (ticks[ticks.len() / 2], ticks[ticks.len() - 1]);
    let ratio = most as f64 / median as f64;
    println!(
        "{} ticks: median {median}, most {most} instructions: {ratio:.3}",
        ticks.len()
    );
    assert!(ticks.len() > 10_000 && ratio <= 1.2, "{ratio}");
}
