//! What the machine allows: the leanest C kernel we know, compiled for one lattice and run beside whatever is measured.
//!
//! Times differ from machine to machine and from hour to hour; only ratios within one run mean anything.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

/// Where the kernel's source is beside a checkout of the repository, from the repository's top folder.
pub const SOURCE: &str = "../shared/bench/lattice_limit.c";
/// Flags of the kernel's own instructions, and its fastest variant.
const FLAGS: [&str; 6] = [
    "-O3",
    "-march=native",
    "-ffast-math",
    "-mprefer-vector-width=256",
    "-DVAR=4",
    "-w",
];
/// Young's modulus [Pa], explicit substeps a millisecond, milliseconds.
const WORK: [&str; 3] = ["1e5", "5", "3000"];

/// The kernel for one size of lattice; it is gone from the disk with its value.
#[derive(Debug)]
pub struct Limit {
    folder: TempDir,
}

impl Limit {
    /// Compiles the kernel at `source` for a lattice of so many nodes along x, y and z.
    ///
    /// # Errors
    /// See [`Missing`].
    pub fn compile(source: &Path, [nx, ny, nz]: [u32; 3]) -> Result<Self, Missing> {
        if !source.exists() {
            return Err(Missing::Source(source.to_owned()));
        }
        let folder = tempfile::tempdir().map_err(Missing::Folder)?;
        let limit = Self { folder };
        let output = Command::new("gcc")
            .args(FLAGS)
            .args([format!("-DNX={nx}"), format!("-DNY={ny}"), format!("-DNZ={nz}")])
            .arg(source)
            .arg("-o")
            .arg(limit.program())
            .arg("-lm")
            .output()
            .map_err(Missing::Compiler)?;
        if output.status.success() {
            Ok(limit)
        } else {
            Err(Missing::Compiled(source.to_owned()))
        }
    }

    /// Runs it once: the median time of one millisecond, five explicit substeps of the bare lattice [µs of CPU].
    ///
    /// # Errors
    /// See [`Missing`].
    pub fn us(&self) -> Result<f64, Missing> {
        let output = Command::new(self.program())
            .args(WORK)
            .output()
            .map_err(Missing::Program)?;
        median(&output.stdout).ok_or(Missing::Line)
    }

    fn program(&self) -> PathBuf {
        self.folder.path().join("limit")
    }
}

/// The median in the program's line of JSON [µs].
fn median(json: &[u8]) -> Option<f64> {
    serde_json::from_slice::<serde_json::Value>(json)
        .ok()?
        .get("med_us")?
        .as_f64()
}

/// What is missing, as the object of "needs"; one line each.
#[derive(Debug, thiserror::Error)]
pub enum Missing {
    /// No source.
    #[error("the C kernel {}", _0.display())]
    Source(PathBuf),
    /// No temporary folder.
    #[error("a temporary folder ({0})")]
    Folder(io::Error),
    /// No gcc.
    #[error("gcc ({0})")]
    Compiler(io::Error),
    /// A gcc that fails.
    #[error("a gcc that compiles {}", _0.display())]
    Compiled(PathBuf),
    /// The program does not start.
    #[error("its program to start ({0})")]
    Program(io::Error),
    /// The program says something else.
    #[error("a line of JSON with `med_us` from its program")]
    Line,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_read_and_its_absence_seen() {
        assert_eq!(median(b"{\"eng\":\"limitC\",\"med_us\":45.5,\"err\":-1}\n"), Some(45.5));
        assert_eq!(median(b"{\"eng\":\"limitC\"}"), None);
        assert_eq!(median(b""), None);
    }

    #[test]
    fn a_source_that_is_not_there_is_named() {
        let missing = Limit::compile(Path::new("no/kernel.c"), [8, 8, 4]).unwrap_err();
        assert_eq!(missing.to_string(), "the C kernel no/kernel.c");
    }
}
