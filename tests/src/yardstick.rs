//! What the machine allows: the leanest C kernel we know, compiled and run beside whatever is measured.
//!
//! Times differ from machine to machine and from hour to hour; only ratios within one run mean anything.

use std::path::Path;
use std::process::Command;

/// The kernel's source beside the repository.
const SOURCE: &str = "bench/lattice_limit.c";
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

/// Median time of the limit for one millisecond of a lattice of `nx` × `ny` × `nz` nodes [µs of CPU], or `None` after saying what is missing.
#[must_use]
pub fn limit_us(nx: usize, ny: usize, nz: usize) -> Option<f64> {
    let source = crate::shared("the yardstick", SOURCE)?;
    let measured = tempfile::tempdir()
        .map_err(|error| format!("a temporary folder ({error})"))
        .and_then(|folder| {
            let program = compile(&source, folder.path(), [nx, ny, nz])?;
            run(&program)
        });
    measured.map_err(|needs| crate::skipped("the yardstick", &needs)).ok()
}

/// Compiles the kernel for one size; on failure, what is needed.
fn compile(source: &Path, folder: &Path, [nx, ny, nz]: [usize; 3]) -> Result<std::path::PathBuf, String> {
    let program = folder.join("limit");
    let output = Command::new("gcc")
        .args(FLAGS)
        .args([format!("-DNX={nx}"), format!("-DNY={ny}"), format!("-DNZ={nz}")])
        .arg(source)
        .arg("-o")
        .arg(&program)
        .arg("-lm")
        .output()
        .map_err(|error| format!("gcc ({error})"))?;
    if output.status.success() {
        Ok(program)
    } else {
        Err(format!("a gcc that compiles {}", source.display()))
    }
}

/// Runs the kernel and takes the median from its line of JSON; on failure, what is needed.
fn run(program: &Path) -> Result<f64, String> {
    let output = Command::new(program)
        .args(WORK)
        .output()
        .map_err(|error| format!("its program to start ({error})"))?;
    median(&output.stdout).ok_or_else(|| "a line of JSON with `med_us` from its program".to_owned())
}

fn median(json: &[u8]) -> Option<f64> {
    serde_json::from_slice::<serde_json::Value>(json)
        .ok()?
        .get("med_us")?
        .as_f64()
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
}
