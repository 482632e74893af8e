//! The harness of Sutura's integration tests.
//!
//! - [`remote`]: a scenario against a controller behind any stream.
//! - [`scenario`]: scenes as they run, through the frames or tick by tick.
//! - [`tidy`]: what the layout and the look of the code promise, as rules over the tracked files.
//! - [`yardstick`]: what the machine allows, measured in the same run.
//!
//! Here: the ways in which a test may decline to run, always out loud.
#![forbid(unsafe_code)]

pub mod remote;
pub mod scenario;
pub mod tidy;
pub mod yardstick;

use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The repository's top folder.
#[must_use]
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Says that `name` is skipped because `needs` is not there.
// Straight to the stream: the test runner swallows what a passing test says through `eprintln!`.
pub fn skipped(name: &str, needs: &str) {
    writeln!(std::io::stderr(), "skipped: {name} needs {needs}").ok();
}

/// The path of `../shared/RELATIVE` beside the repository, or `None` after saying that `name` is skipped.
#[must_use]
pub fn shared(name: &str, relative: &str) -> Option<PathBuf> {
    let path = root().join("../shared").join(relative);
    if path.exists() {
        return Some(path);
    }
    skipped(name, &format!("../shared/{relative}"));
    None
}

/// Whether the tests that are too long for every commit run too; if not, says that `name` is skipped.
#[must_use]
pub fn full(name: &str) -> bool {
    let full = std::env::var_os("SUTURA_FULL").is_some_and(|value| value == "1");
    if !full {
        skipped(name, "SUTURA_FULL=1, as `.ci/run --full` sets it");
    }
    full
}
