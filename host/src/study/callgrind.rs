//! Instructions of one function in a child process, counted by valgrind's callgrind: exact and the same on a busy machine, where times are not.
//!
//! Valgrind 3.19 knows AVX2 but not AVX-512, so a child that takes the best instructions it finds runs on AVX2 at most.

use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The program that counts.
const VALGRIND: &str = "valgrind";

/// Counts the instructions that calls of `function` take while `program` runs with `arguments`, callees included. `function` is the
/// demangled name, `*` stands for any part of it; it must not be inlined.
///
/// # Errors
/// See [`Error`].
pub fn instructions(program: &Path, arguments: &[impl AsRef<OsStr>], function: &str) -> Result<u64, Error> {
    let folder = tempfile::tempdir().map_err(Error::Folder)?;
    let counts = folder.path().join("counts");
    let mut option = std::ffi::OsString::from("--callgrind-out-file=");
    option.push(&counts);
    let output = Command::new(VALGRIND)
        .args(["--quiet", "--tool=callgrind"])
        .arg(option)
        .arg(format!("--toggle-collect={function}"))
        .arg(program)
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .map_err(Error::Missing)?;
    if !output.status.success() {
        let last = String::from_utf8_lossy(&output.stderr);
        return Err(Error::Failed {
            program: program.to_owned(),
            line: last.lines().next_back().unwrap_or_default().to_owned(),
        });
    }
    let text = std::fs::read_to_string(&counts).map_err(Error::Folder)?;
    match total(&text) {
        Some(total) if total > 0 => Ok(total),
        _ => Err(Error::Nothing {
            function: function.to_owned(),
        }),
    }
}

/// Whether valgrind can be started; if not, what is needed.
///
/// # Errors
/// [`Error::Missing`].
pub fn present() -> Result<(), Error> {
    let status = Command::new(VALGRIND)
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    status.map(drop).map_err(Error::Missing)
}

/// The sum of all collected instructions in callgrind's own format.
fn total(text: &str) -> Option<u64> {
    let mut lines = text.lines().filter_map(|line| line.strip_prefix("totals: "));
    lines.next_back()?.trim().parse().ok()
}

/// Why nothing was counted; one line each.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No valgrind.
    #[error("counting instructions needs valgrind, such as Debian's package of that name ({0})")]
    Missing(io::Error),
    /// No temporary folder, or no file in it.
    #[error("counting instructions: {0}")]
    Folder(io::Error),
    /// The program failed.
    #[error("{} failed under valgrind: {line}", program.display())]
    Failed {
        /// Which.
        program: PathBuf,
        /// Its last line.
        line: String,
    },
    /// The function was never called, or is not there under this name.
    #[error("no instructions of {function} were counted: the program needs its symbols")]
    Nothing {
        /// Which.
        function: String,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines as the manual's "Callgrind Format Specification" has them.
    #[test]
    fn the_total_is_read_and_its_absence_seen() {
        assert_eq!(total("events: Ir\nsummary: 12\n\nfn=(1)\n1 12\ntotals: 34\n"), Some(34));
        assert_eq!(total("events: Ir\n"), None);
    }
}
