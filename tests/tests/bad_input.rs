//! Bad input to a run: one line that says what, where and what would be right, exit code 2, nothing written.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used)]

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use sutura::run::{self, Request};
use sutura::scene::BUILT_IN;
use sutura_controller::lanes::Level;
use toml::{Table, Value};

/// Runs the built-in scene with some of its keys set, named as `section.key`; gives the error's line.
fn refused(changes: &[(&str, Value)], meshes: &[(&str, PathBuf)]) -> String {
    let mut scene: Table = BUILT_IN.parse().unwrap();
    for (key, value) in changes {
        let mut keys: Vec<_> = key.split('.').collect();
        let last = keys.pop().unwrap();
        let section = keys
            .into_iter()
            .fold(&mut scene, |table, key| table[key].as_table_mut().unwrap());
        section.insert(last.to_owned(), value.clone());
    }
    refused_text(&scene.to_string(), meshes)
}

/// Runs a scene; gives the error's line.
fn refused_text(text: &str, meshes: &[(&str, PathBuf)]) -> String {
    let folder = tempfile::tempdir().unwrap();
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
        level: Level::best(),
        out: out.clone(),
        frames: None,
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
        &refused(&[("stitch.byte_mm", 4.0.into())], &[]),
        &["scene.toml:", "unknown field `byte_mm`", "`bite_mm`"],
    );
}

#[test]
fn a_value_out_of_range() {
    says(
        &refused(&[("operator.sew.tension_n", (-1.0).into())], &[]),
        &["scene.toml:", "operator.sew.tension_n = -1", "0.05 to 10"],
    );
}

/// With dashpots of 1 ms and skin of 3.7 MPa a tick takes far more than five explicit substeps.
#[test]
fn a_solver_that_is_unstable() {
    says(
        &refused(&[("solver", "explicit:5".into())], &[]),
        &["scene.toml:", "solver = \"explicit:5\"", "is the smallest stable count"],
    );
}

#[test]
fn a_file_that_is_no_toml() {
    says(&refused_text("[patch\n", &[]), &["scene.toml:1:"]);
}

/// 81 × 61 × 25 nodes at 0.5 mm; the capacity is 24 × 24 × 12 = 6,912.
#[test]
fn a_pitch_that_gives_too_many_nodes() {
    let line = refused(
        &[
            ("patch.pitch_mm", 0.5.into()),
            // At most 3.5 pitches.
            ("contact.kernel_mm", 1.5.into()),
        ],
        &[],
    );
    says(
        &line,
        &["scene.toml:", "81 × 61 × 25 = 123525 nodes", "6912", "pitch", "fits"],
    );
}

#[test]
fn a_site_off_the_skin() {
    let line = refused(&[("patch.site_mm", vec![0.0, 0.0, 80.0].into())], &[]);
    says(&line, &["site (0.0, 0.0, 80.0) mm", "from the nearest surface"]);
}

/// The bite is from the wound's edge, so with a gap of 4 mm a puncture at 19 mm would be beyond the patch's last free column.
#[test]
fn a_puncture_outside_of_the_patch() {
    let changes = [("stitch.bite_mm", 17.0.into()), ("needle.length_mm", 80.0.into())];
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
            ("patch.size_mm", vec![40.0, 30.0, 4.0].into()),
            ("wound.depth_mm", 2.0.into()),
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

/// The needle's circle and a thread of 300 mm do not fit into a workspace of 381 × 267 × 191 mm.
#[test]
fn a_thread_that_the_arm_cannot_pull_taut() {
    says(
        &refused(&[("thread.length_mm", 300.0.into())], &[]),
        &["thread.length_mm = 300 is out of range", "at most"],
    );
}

#[test]
fn a_mesh_that_is_not_there() {
    says(
        &refused(&[], &[("skin", PathBuf::from("nowhere.stl"))]),
        &["nowhere.stl"],
    );
}
