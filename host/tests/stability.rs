//! `sutura study stability` as a person calls it.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::{Command, Output};

fn study(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sutura"))
        .args(["study", "stability", "--out", "o", "--json"])
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

/// One explicit substep a tick of 1 ms is above 0.913 a √(ρ/E) = 0.18 ms of 100 kPa in voxels of 2 mm: under every law a formula refuses it.
#[test]
fn what_a_formula_refuses_is_listed_as_refused() {
    let folder = tempfile::tempdir().unwrap();
    let output = study(folder.path(), &["--case", "tool-reversed", "--solver", "explicit:1"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let report: serde_json::Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
    let rows = report["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 8, "one for each law");
    for row in rows {
        let of = |key: &str| row[key].as_str().unwrap().to_owned();
        assert_eq!([of("case"), of("solver")], ["tool-reversed:50-hz", "explicit:1"]);
        assert!(of("why").contains("is the smallest stable count"), "{row}");
        assert!(row["passed"] == false && row["worst"].as_f64().unwrap() >= 6.0, "{row}");
    }
    let read = |name: &str| std::fs::read_to_string(folder.path().join("o").join(name)).unwrap();
    assert_eq!(
        serde_json::from_str::<serde_json::Value>(&read("stability.json")).unwrap(),
        report
    );
    assert_eq!(read("stability.csv").lines().count(), 9);
    assert!(read("stability.md").contains("| refused (1) |"));
    for picture in ["stability.png", "stability.svg"] {
        assert!(folder.path().join("o").join(picture).exists(), "{picture}");
    }
}

#[test]
fn unknown_names_are_refused_in_one_line_that_lists_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, what) in [
        (["--case", "earthquake"], "tool-teleported"),
        (["--solver", "leapfrog"], "be-chebyshev[:iterations]"),
    ] {
        let output = study(folder.path(), &arguments);
        let line = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{line}");
        assert!(line.contains(what) && line.lines().count() == 1, "{line}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
