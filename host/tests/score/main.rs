//! The score card: rows against values worked out by hand, and that a run and its folder are scored alike.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used)]

mod recording;

use std::f64::consts::PI;
use std::path::Path;
use std::process::Command;

use recording::{RADIUS, Recording, STILL, TIP, Tick};
use sutura::score::{Row, Score};

/// The row of this name, of no stage.
fn row<'a>(score: &'a Score, name: &str) -> &'a Row {
    let mut found = score.rows.iter().filter(|row| row.name == name && row.stage.is_none());
    found.next().unwrap()
}

fn near(score: &Score, name: &str, expected: f64, within: f64) {
    let value = row(score, name).value.unwrap();
    assert!(
        (value - expected).abs() <= within,
        "{name}: {value}, expected {expected}"
    );
}

/// The grasp point of a needle that turns about a centre, at ψ.
fn grasp([x, z]: [f64; 2], psi: f64) -> [f64; 3] {
    [x + RADIUS * psi.cos(), 0.0, z + RADIUS * psi.sin()]
}

#[test]
fn a_straight_path_has_its_length_and_time() {
    let mut recording = Recording::default();
    for n in 0..=200 {
        let t = f64::from(n) / 200.0;
        recording.tick(&Tick {
            position: [0.03 * t, 0.04 * t, -0.12 * t],
            ..STILL
        });
    }
    recording.tick(&Tick {
        stage: "done",
        position: [0.03, 0.04, -0.12],
        ..STILL
    });
    let score = recording.scored();
    // 3, 4, 12: 13 cm, in 201 ticks.
    near(&score, "path of the hand", 0.13, 1e-12);
    near(&score, "time", 0.201, 1e-12);
    assert_eq!(row(&score, "time").meets, Some(true));
    // Never punctured, so no angle and no points.
    assert_eq!(row(&score, "entry angle").value, None);
    assert!(row(&score, "entry angle").points.unwrap().got <= 0.0);
}

/// F = A sin ωt over half a period of one second: peak A, mean 2A/π, impulse 2A/π · 1 s, and d/dt has the RMS Aω/√2.
#[test]
fn a_sine_of_force_has_its_impulse() {
    let amplitude = 5.0;
    let mut recording = Recording::default();
    for n in 0..=1000 {
        recording.tick(&Tick {
            stage: "indent",
            force: amplitude * (PI * f64::from(n) * 1e-3).sin(),
            ..STILL
        });
    }
    let score = recording.scored();
    let of_stage = |name: &str| {
        let mut rows = score
            .rows
            .iter()
            .filter(|row| row.stage == Some("indent") && row.name == name);
        rows.next().unwrap().value.unwrap()
    };
    for (name, expected) in [
        ("peak force", amplitude),
        ("mean force", 2.0 * amplitude / PI),
        ("impulse of force", 2.0 * amplitude / PI),
        ("change of force, RMS", amplitude * PI / 2.0_f64.sqrt()),
    ] {
        let value = of_stage(name);
        assert!(
            (value / expected - 1.0).abs() < 2e-3,
            "{name}: {value}, expected {expected}"
        );
    }
    near(&score, "peak force", amplitude, 1e-9);
    assert_eq!(row(&score, "peak force").meets, Some(false));
    // sin ωt > F/A between asin(F/A)/ω and the mirror image of that.
    for (name, force) in [
        ("time above 2.6 N, the experts' maximum", 2.6),
        ("time above 4.7 N, the novices' maximum", 4.7),
    ] {
        near(&score, name, 1.0 - 2.0 * (force / amplitude).asin() / PI, 1.001e-3);
    }
}

/// A needle that turns about a fixed centre from one puncture to the other meets the skin at asin(d/R), the best it can do, and never leaves
/// its circle; moved bodily by s on the way its tip is off the circle of half the way by up to s/2.
#[test]
fn a_needle_is_held_to_its_arc_and_to_its_bite() {
    for off in [0.0, 0.5e-3] {
        let half = 0.006;
        let up = (RADIUS * RADIUS - half * half).sqrt();
        let from = PI + (half / RADIUS).acos() - TIP;
        let turn = 2.0 * (half / RADIUS).asin();
        let mut recording = Recording::default();
        for n in 0..=1000_u32 {
            let t = f64::from(n) * 1e-3;
            let psi = from + turn * t;
            let [x, _, z] = grasp([0.0, up], psi);
            recording.tick(&Tick {
                stage: "drive",
                // Along the normal of the needle's plane.
                position: [x, off * t, z],
                psi,
                force: 1.0,
                side: 0.25,
                ..STILL
            });
            match n {
                0 => recording.puncture(1, "a", [-half, 0.0, 0.0]),
                1000 => recording.puncture(1, "d", [half, 0.0, 0.0]),
                _ => {}
            }
        }
        let score = recording.scored();
        let best = (half / RADIUS).asin().to_degrees();
        // A scene keeps its needle in single precision: the radius is off by 1e-7 of it.
        for name in ["entry angle", "exit angle"] {
            near(&score, name, best, 1e-5);
            assert!((row(&score, name).best.unwrap() - best).abs() < 1e-5);
            assert_eq!(row(&score, name).meets, None);
        }
        // 6 mm from the middle of a wound 4 mm wide.
        near(&score, "bite at the entry", 4.0, 1e-9);
        near(&score, "bite at the exit", 4.0, 1e-9);
        near(&score, "difference of the bites", 0.0, 1e-9);
        near(&score, "depth", (RADIUS - up) * 1e3, 1e-3);
        near(&score, "tip off the needle's arc, most", off * 1e3 / 2.0, 1e-5);
        // A ramp from −s/2 to s/2 has the RMS s/√12.
        near(
            &score,
            "tip off the needle's arc, RMS",
            off * 1e3 / 12.0_f64.sqrt(),
            1e-3,
        );
        near(&score, "side load on the needle, mean", 0.25, 1e-12);
        near(&score, "punctures beyond those needed", 0.0, 0.0);
    }
}

#[test]
fn thread_and_gap_are_read_where_they_belong() {
    let mut recording = Recording::default();
    for n in 0..600 {
        recording.tick(&Tick {
            stage: "tension",
            // 3 N at first, 1 N over the last 200 ticks.
            tension: [if n < 400 { 3.0 } else { 1.0 }, 1.5],
            gap: 0.2,
            ..STILL
        });
    }
    recording.tick(&Tick {
        stage: "done",
        tension: [0.0, 0.7],
        gap: 1.5,
        ..STILL
    });
    let score = recording.scored();
    near(&score, "peak tension of the thread", 3.0, 1e-12);
    near(&score, "tension held before the knot", 1.0, 1e-12);
    near(&score, "tension left in the stitch", 0.7, 1e-12);
    near(&score, "residual gap under the hand's pull", 0.2, 1e-12);
    near(&score, "residual gap", 1.5, 1e-12);
    assert_eq!(row(&score, "residual gap").meets, Some(false));
    // 9 mm in a wound of 18 mm.
    near(&score, "thread in the stitch over the wound's length", 0.5, 1e-12);
}

#[test]
fn several_stitches_have_a_spacing_and_share_a_rows_points() {
    let mut recording = Recording::default();
    for (stitch, y) in [(1, -0.006), (2, 0.0), (3, 0.004)] {
        recording.tick(&STILL);
        recording.puncture(stitch, "a", [-0.006, y, 0.0]);
        recording.tick(&STILL);
        recording.puncture(stitch, "d", [0.006, y, 0.0]);
    }
    recording.tick(&STILL);
    recording.puncture(3, "d", [0.005, 0.004, 0.0]);
    let score = recording.scored();
    // 6 and 4 mm: 5 ± 1.
    near(&score, "spacing", 5.0, 1e-9);
    near(&score, "spread of the spacing over its mean", 0.2, 1e-9);
    near(&score, "punctures beyond those needed", 1.0, 0.0);
    let bites: Vec<_> = score.rows.iter().filter(|row| row.name == "bite at the exit").collect();
    assert_eq!(
        bites.iter().map(|row| row.stitch).collect::<Vec<_>>(),
        [Some(1), Some(2), Some(3)]
    );
    // Of several punctures at one site the last one stays.
    assert!((bites[2].value.unwrap() - 3.0).abs() < 1e-9);
    assert!((bites.iter().map(|row| row.points.unwrap().of).sum::<f64>() - 2.0).abs() < 1e-12);
}

/// Every row that counts makes the total fall as it gets worse.
#[test]
fn the_total_falls_with_the_force() {
    let total = |force: f64| {
        let mut recording = Recording::default();
        (0..100).for_each(|_| recording.tick(&Tick { force, ..STILL }));
        recording.scored().total
    };
    let totals = [0.5, 1.0, 2.0, 3.0, 5.0, 9.0].map(total);
    assert!(totals.is_sorted_by(|a, b| a > b), "{totals:?}");
    assert!(totals.iter().all(|total| (0.0..100.0).contains(total)));
}

fn sutura(folder: &Path, arguments: &[&str]) -> std::process::Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sutura"));
    command.args(arguments).current_dir(folder).output().unwrap()
}

#[test]
fn a_run_and_its_folder_are_scored_alike() {
    let folder = tempfile::tempdir().unwrap();
    let output = sutura(folder.path(), &["run", "--headless", "--json", "--out", "o"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let files = ["o/score.json", "o/score.md"].map(|name| folder.path().join(name));
    let read = || files.each_ref().map(|file| std::fs::read_to_string(file).unwrap());
    let first = read();
    files.iter().for_each(|file| std::fs::remove_file(file).unwrap());
    let again = sutura(folder.path(), &["score", "o", "--json"]);
    assert!(again.status.success(), "{}", String::from_utf8_lossy(&again.stderr));
    assert_eq!(read(), first);
    let scored: serde_json::Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!(scored, report["score"]);
    assert_eq!(scored, serde_json::from_str::<serde_json::Value>(&first[0]).unwrap());
    let rows = scored["rows"].as_array().unwrap();
    for row in rows {
        assert!(row["value"].is_number(), "{row}");
        let published = !row["threshold"].is_null();
        let says_none = row["source"].as_str().unwrap().contains("no published threshold");
        assert!(published || says_none, "{row}");
    }
    assert!(
        scored["note"]
            .as_str()
            .unwrap()
            .contains("not validated for credentialing")
    );
    let total = scored["total"].as_f64().unwrap();
    assert!(total > 0.0 && total < 100.0, "{total}");
}

#[test]
fn a_folder_that_is_no_whole_run_is_refused_in_one_line() {
    let mut recording = Recording::default();
    (0..9).for_each(|_| recording.tick(&STILL));
    recording.puncture(1, "a", [0.0; 3]);
    let cut = |text: &str, bytes: usize| text[..text.len() - bytes].to_owned();
    let line = |text: &str| text[..text.trim_end().rfind('\n').unwrap() + 1].to_owned();
    type Damage<'a> = &'a dyn Fn(&str) -> Option<String>;
    let damages: [(&str, Damage<'_>, &str); 9] = [
        ("scene.toml", &|_| None, "scene.toml"),
        ("force.csv", &|_| None, "force.csv"),
        ("motion.csv", &|_| None, "motion.csv"),
        ("punctures.csv", &|_| None, "punctures.csv"),
        ("force.csv", &|text| Some(cut(text, 3)), "its last line is cut off"),
        (
            "motion.csv",
            &|text| Some(line(text)),
            "8 ticks, but force.csv has 9: one of them is cut off",
        ),
        (
            "force.csv",
            &|text| Some(text.replace("\n4,", "\n5,")),
            "tick 5 stands where tick 4 is to be",
        ),
        (
            "motion.csv",
            &|text| Some(text.replace("0.009", "NaN")),
            "not every number is finite",
        ),
        (
            "force.csv",
            &|text| Some(text.replace("thread_n", "thread")),
            "thread_n",
        ),
    ];
    for (name, damage, what) in damages {
        let folder = tempfile::tempdir().unwrap();
        recording.write(folder.path());
        let path = folder.path().join(name);
        match damage(&std::fs::read_to_string(&path).unwrap()) {
            Some(text) => std::fs::write(&path, text).unwrap(),
            None => std::fs::remove_file(&path).unwrap(),
        }
        let output = sutura(folder.path(), &["score", ".", "--json"]);
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains(what) && stderr.lines().count() == 1, "{name}: {stderr}");
        assert!(!folder.path().join("score.json").exists());
    }
}
