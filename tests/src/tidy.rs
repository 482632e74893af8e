//! The tidy rules: who may import whom, how long a file and a function may be, what may not be left lying about.
//!
//! A rule is a function from the tracked files to its violations; `tests/tests/tidy.rs` runs each of them over the repository, and each has a unit test
//! beside it that shows it a snippet it must find.
//!
//! - [`structure`]: packages, manifests, the top level.
//! - [`layers`]: the floors inside the controller.
//! - [`size`]: length of files and functions.
//! - [`words`]: what may not be written.
//! - [`text`]: code apart from comments and literals.

pub mod layers;
pub mod size;
pub mod structure;
pub mod text;
pub mod words;

use std::fmt;
use std::path::Path;
use std::process::Command;

/// One text file of the repository.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// Path from the top folder, with `/` between its parts.
    pub path: String,
    /// All of it.
    pub text: String,
}

impl Source {
    /// Whether it is Rust.
    #[must_use]
    pub fn is_rust(&self) -> bool {
        Path::new(&self.path)
            .extension()
            .is_some_and(|extension| extension == "rs")
    }

    /// Its code without what is only built for tests; empty for a file of tests.
    #[must_use]
    pub fn shipped(&self) -> &str {
        let tests = self.path.split('/').any(|part| part == "tests" || part == "tests.rs");
        if tests { "" } else { text::before_tests(&self.text) }
    }
}

/// One place that breaks a rule.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// The file's path from the top folder.
    pub path: String,
    /// Line from 1, or 0 where the whole file is meant.
    pub line: usize,
    /// What is wrong there and what would be right.
    pub what: String,
}

impl Violation {
    fn new(source: &Source, line: usize, what: impl Into<String>) -> Self {
        Self {
            path: source.path.clone(),
            line,
            what: what.into(),
        }
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.path, self.line, self.what)
    }
}

/// The text files that git tracks or would track below `root`, or `None` where that is no git checkout.
#[must_use]
pub fn sources(root: &Path) -> Option<Vec<Source>> {
    let listing = Command::new("git")
        .args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"])
        .current_dir(root)
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    let paths = String::from_utf8(listing.stdout).ok()?;
    let read = |path: &str| {
        let text = std::fs::read_to_string(root.join(path)).ok()?;
        Some(Source {
            path: path.to_owned(),
            text,
        })
    };
    Some(paths.split_terminator('\0').filter_map(read).collect())
}
