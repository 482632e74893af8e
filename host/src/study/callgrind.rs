//! Instructions of one function in a child process, counted by valgrind's callgrind: exact and the same on a busy machine, where times are not.
//!
//! Valgrind 3.19 knows AVX2 but not AVX-512, so a child that takes the best instructions it finds runs on AVX2 at most.

use std::ffi::OsStr;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::Duration;

/// The program that counts.
const VALGRIND: &str = "valgrind";

/// The file of counts.
const COUNTS: &str = "counts";
/// From one look for new files of counts to the next.
const LOOK: Duration = Duration::from_millis(100);

/// Counts the instructions that calls of `function` take while `program` runs with `arguments`, callees included. `function` is the
/// demangled name, `*` stands for any part of it; it must not be inlined.
///
/// # Errors
/// See [`Error`].
pub fn instructions(program: &Path, arguments: &[impl AsRef<OsStr>], function: &str) -> Result<u64, Error> {
    let folder = tempfile::tempdir().map_err(Error::Folder)?;
    let mut command = counting(folder.path(), function);
    let output = command.arg(program).args(arguments).output().map_err(Error::Missing)?;
    succeeded(program, output.status, &output.stderr)?;
    match total(&read(&folder.path().join(COUNTS))?) {
        Some(total) if total > 0 => Ok(total),
        _ => Err(nothing(function)),
    }
}

/// Counts the instructions of every single call of `function`, in order; see [`instructions`].
///
/// # Errors
/// See [`Error`].
pub fn calls(program: &Path, arguments: &[impl AsRef<OsStr>], function: &str) -> Result<Vec<u64>, Error> {
    let folder = tempfile::tempdir().map_err(Error::Folder)?;
    let mut command = counting(folder.path(), function);
    // As a call begins, what was counted goes into a file of its own.
    command.arg(format!("--dump-before={function}"));
    let child = command.arg(program).args(arguments).stdout(Stdio::null());
    let mut child = child.stderr(Stdio::null()).spawn().map_err(Error::Missing)?;
    let mut totals = Vec::new();
    let mut status = None;
    while status.is_none() {
        std::thread::sleep(LOOK);
        status = child.try_wait().map_err(Error::Folder)?;
        // The newest file may still be written.
        let mut next = totals.len() + 1;
        while status.is_some() || numbered(folder.path(), next + 1).exists() {
            let file = numbered(folder.path(), next);
            if !file.exists() {
                break;
            }
            totals.push(total(&read(&file)?).unwrap_or(0));
            std::fs::remove_file(&file).map_err(Error::Folder)?;
            next += 1;
        }
    }
    succeeded(program, status.unwrap_or_default(), b"")?;
    totals.extend(total(&read(&folder.path().join(COUNTS))?));
    // Nothing was counted before the first call.
    match totals.split_first() {
        Some((_, calls)) if !calls.is_empty() => Ok(calls.to_vec()),
        _ => Err(nothing(function)),
    }
}

/// Callgrind that counts `function` into a file of `folder`; what it is to run is yet to be named.
fn counting(folder: &Path, function: &str) -> Command {
    let mut option = std::ffi::OsString::from("--callgrind-out-file=");
    option.push(folder.join(COUNTS));
    let mut command = Command::new(VALGRIND);
    command
        .args(["--quiet", "--tool=callgrind"])
        .arg(option)
        .arg(format!("--toggle-collect={function}"))
        .stdin(Stdio::null());
    command
}

fn numbered(folder: &Path, number: usize) -> PathBuf {
    folder.join(format!("{COUNTS}.{number}"))
}

fn read(path: &Path) -> Result<String, Error> {
    std::fs::read_to_string(path).map_err(Error::Folder)
}

fn succeeded(program: &Path, status: ExitStatus, stderr: &[u8]) -> Result<(), Error> {
    match status.success() {
        true => Ok(()),
        false => Err(Error::Failed {
            program: program.to_owned(),
            line: String::from_utf8_lossy(stderr)
                .lines()
                .next_back()
                .unwrap_or_default()
                .to_owned(),
        }),
    }
}

fn nothing(function: &str) -> Error {
    Error::Nothing {
        function: function.to_owned(),
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
