//! Bad input to a run: one line that says what, where and what would be right, exit code 2, nothing written.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used)]

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use sutura::run::{self, Request};
use sutura::scene::BUILT_IN;

/// Runs the built-in scene with some of its text replaced; gives the error's line.
fn refused(changes: &[(&str, &str)], meshes: &[(&str, PathBuf)]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let mut text = BUILT_IN.to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, text).unwrap();
    let out = folder.path().join("out");
    let meshes = meshes
        .iter()
        .map(|(tissue, path)| ((*tissue).to_owned(), path.clone()))
        .collect();
    let request = Request {
        scene: Some(scene),
        meshes,
        seconds: Some(0.01),
        realtime: false,
        out: out.clone(),
    };
    let error = run::run(&request, &AtomicBool::new(false), |_| {}).unwrap_err();
    assert_eq!(error.exit_code(), 2, "{error}");
    assert!(!out.exists());
    let line = error.to_string();
    assert!(!line.contains('\n'), "{line}");
    line
}

fn says(line: &str, parts: &[&str]) {
    for part in parts {
        assert!(line.contains(part), "`{part}` is not in: {line}");
    }
}

#[test]
fn an_unknown_key() {
    says(
        &refused(&[("bite_mm", "byte_mm")], &[]),
        &["scene.toml:", "unknown field `byte_mm`", "`bite_mm`"],
    );
}

#[test]
fn a_value_out_of_range() {
    says(
        &refused(&[("tension_n = 1.0", "tension_n = -1")], &[]),
        &["scene.toml:", "operator.sew.tension_n = -1", "0.05 to 10"],
    );
}

#[test]
fn a_file_that_is_no_toml() {
    says(&refused(&[("[patch]", "[patch")], &[]), &["scene.toml:"]);
}

/// 81 × 61 × 25 nodes at 0.5 mm; the capacity is 24 × 24 × 12 = 6,912.
#[test]
fn a_pitch_that_gives_too_many_nodes() {
    let line = refused(
        &[
            ("pitch_mm = 2 ", "pitch_mm = 0.5 "),
            ("kernel_mm = 3.5 ", "kernel_mm = 2 "),
        ],
        &[],
    );
    says(&line, &["81 × 61 × 25 = 123525 nodes", "6912", "pitch", "fits"]);
}

#[test]
fn a_site_off_the_skin() {
    let line = refused(
        &[("along = [0, 1, 0]", "along = [0, 1, 0]\nsite_mm = [0, 0, 80]\n")],
        &[],
    );
    says(&line, &["site (0.0, 0.0, 80.0) mm", "from the nearest surface"]);
}

/// The bite is from the wound's edge, so with a gap of 4 mm a puncture at 19 mm would be beyond the patch's last free column.
#[test]
fn a_puncture_outside_of_the_patch() {
    let changes = [
        ("bite_mm = 4 ", "bite_mm = 17 "),
        ("length_mm = 26 ", "length_mm = 80 "),
    ];
    says(
        &refused(&changes, &[]),
        &["stitch.bite_mm = 17 is out of range", "0.5 to 16"],
    );
}

/// A half circle of 26 mm through punctures 12 mm apart goes 2.57 mm deep, and 2 mm more are asked for.
#[test]
fn too_little_soft_tissue_for_the_needle() {
    let line = refused(
        &[
            ("size_mm = [40, 30, 12]", "size_mm = [40, 30, 4]"),
            ("depth_mm = 6", "depth_mm = 2"),
        ],
        &[],
    );
    says(&line, &["only 4 mm of soft tissue", "mm are needed"]);
}

#[test]
fn a_wound_over_bone() {
    let folder = tempfile::tempdir().unwrap();
    let [_, _, skin] = sutura::geometry::phantom::write(folder.path()).unwrap();
    says(&refused(&[], &[("bone", skin)]), &["only 0 mm of soft tissue", "bone"]);
}

#[test]
fn a_mesh_that_is_not_there() {
    says(
        &refused(&[], &[("skin", PathBuf::from("nowhere.stl"))]),
        &["nowhere.stl"],
    );
}
