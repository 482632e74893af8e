//! The program as a person calls it: what stands on stdout and stderr, exit codes, and what is left on the disk.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::{Command, Output};

fn sutura(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sutura"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

/// Asserts exit code 2 and one line on stderr that contains `what`; gives the line.
fn refused(output: &Output, what: &str) -> String {
    let line = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(output.status.code(), Some(2), "{line}");
    assert!(line.contains(what) && line.lines().count() == 1, "{line}");
    line
}

#[test]
fn the_built_in_scene_is_printed_and_reads_back() {
    let folder = tempfile::tempdir().unwrap();
    let output = sutura(folder.path(), &["scene", "--print-default"]);
    assert!(output.status.success());
    assert_eq!(output.stdout, sutura::scene::BUILT_IN.as_bytes());
    std::fs::write(folder.path().join("mine.toml"), output.stdout).unwrap();
    sutura::scene::load(Some(&folder.path().join("mine.toml"))).unwrap();
}

#[test]
fn a_short_run_ends_with_json_and_files() {
    let folder = tempfile::tempdir().unwrap();
    let output = sutura(
        folder.path(),
        &["run", "--headless", "--json", "--seconds", "0.05", "--out", "o"],
    );
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let report: serde_json::Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
    assert_eq!(report["ticks"], 50);
    assert_eq!(report["solver"], "be-pcg:10:1");
    assert_eq!(report["state_hash"].as_str().unwrap().len(), 16);
    assert_eq!(report["link"]["errors"], 0);
    let csv = std::fs::read_to_string(folder.path().join("o/force.csv")).unwrap();
    let head = "tick,stage,x_m,y_m,z_m,simulated_n,rendered_n,thread_n,gap_mm";
    assert_eq!((csv.lines().next(), csv.lines().count()), (Some(head), 51));
    let mut names: Vec<_> = std::fs::read_dir(folder.path().join("o"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    names.sort();
    let expected = "force.csv force.png motion.csv punctures.csv scene.toml score.json score.md wound.csv wound.png";
    assert_eq!(names, expected.split(' ').collect::<Vec<_>>());
    assert!(report.get("auto").is_none());
}

#[test]
fn an_error_is_one_line_and_an_object_under_json() {
    let folder = tempfile::tempdir().unwrap();
    let output = sutura(folder.path(), &["run", "missing.toml", "--json"]);
    let line = refused(&output, "missing.toml");
    let object: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(format!("error: {}\n", object["error"].as_str().unwrap()), line);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn meshes_that_are_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("empty.stl"), "").unwrap();
    std::fs::write(folder.path().join("text.stl"), "no mesh at all").unwrap();
    let mut cut = vec![0; 84];
    cut[80] = 9;
    std::fs::write(folder.path().join("cut.stl"), cut).unwrap();
    for file in ["missing.stl", "empty.stl", "text.stl", "cut.stl"] {
        refused(&sutura(folder.path(), &["voxelize", file, "--pitch-mm", "1"]), file);
        refused(
            &sutura(folder.path(), &["run", "--mesh", &format!("skin={file}")]),
            file,
        );
    }
    assert!(!folder.path().join("sutura-out").exists());
}

#[test]
fn a_tissue_that_the_scene_has_not_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let output = sutura(folder.path(), &["run", "--mesh", "liver=liver.stl"]);
    refused(&output, "no tissue `liver`, it has skin, muscle, bone");
}

#[test]
fn a_poke_ends_with_json_and_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let short = ["poke", "--nodes", "5x4x3", "--run-ms", "7", "--reference", "--json"];
    let files = ["--positions", "p.csv", "--forces", "f.csv"];
    let output = sutura(folder.path(), &[&short[..], &files].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    // 4·4·3 + 5·3·3 + 5·4·2 edges and four diagonals in each of 4·3·2 voxels.
    assert_eq!((&report["nodes"], &report["springs"]), (&60.into(), &229.into()));
    assert_eq!(report["solver"], "be-pcg:10:1");
    assert_eq!(report["finite"], true);
    for number in ["force_n", "force_error_rms", "force_error_max", "shape_error"] {
        assert!(report[number].as_f64().unwrap() > 0.0, "{number}");
    }
    for number in ["median", "p99", "max"] {
        assert!(report["us_per_tick"][number].is_f64(), "{number}");
    }
    assert!(report.get("ns_per_spring_substep").is_none());
    let lines = |name| {
        std::fs::read_to_string(folder.path().join(name))
            .unwrap()
            .lines()
            .count()
    };
    assert_eq!((lines("p.csv"), lines("f.csv")), (61, 8));
}

#[test]
fn a_poke_that_cannot_be_is_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, what) in [
        (&["--nodes", "8x8"][..], "8x8x4"),
        (&["--nodes", "1x8x4"], "2 or more"),
        (&["--nodes", "40x40x40"], "24x24x12"),
        (&["--node", "0,0,0"], "those of layer 0 are held"),
        (&["--node", "16,0,1"], "16x16x8"),
        (&["--solver", "leapfrog"], "xpbd[:substeps]"),
        (&["--solver", "be-pcg:100000"], "solver.iterations is 1 to 1000"),
        (&["--solver", "auto:0"], "a whole number from 1 to 1000"),
        (&["--solver", "explicit:2"], "explicit:6 is the smallest stable count"),
        (&["--solver", "pd", "--law", "volume"], "springs alone"),
        (&["--law", "hooke"], "there are isotropic"),
        (&["--law", "axial", "--poisson", "0.3"], "Poisson"),
        (&["--assembly", "each"], "per-voxel, every-edge"),
        (&["--path", "drag", "--lift-mm", "3"], "--path lift"),
        (&["--run-ms", "0"], "0 is not in 1..=60000"),
        (&["--young-kpa", "nan"], "a number from"),
        (&["--forces", "nowhere/f.csv", "--run-ms", "1"], "nowhere"),
    ] {
        let output = sutura(folder.path(), &[&["poke", "--json"], arguments].concat());
        let line = refused(&output, what);
        let object: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(format!("error: {}\n", object["error"].as_str().unwrap()), line);
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// What a clock chooses stands in the report and in the copy of the scene, and running the copy gives the same bits.
#[test]
fn a_choice_by_a_clock_is_recorded_and_repeats_from_the_copy() {
    let folder = tempfile::tempdir().unwrap();
    let scene = sutura::scene::BUILT_IN.replace("\nsolver = \"be-pcg:10:1\"", "\nsolver = \"auto:1000\"");
    std::fs::write(folder.path().join("mine.toml"), scene).unwrap();
    let run = |scene: &str, out: &str| -> serde_json::Value {
        let output = sutura(
            folder.path(),
            &["run", scene, "--json", "--seconds", "0.03", "--out", out],
        );
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let (chosen, again) = (run("mine.toml", "first"), run("first/scene.toml", "second"));
    assert_eq!(chosen["auto"]["budget_us"], 1000);
    for number in ["us_median", "us_p99", "force_error"] {
        assert!(chosen["auto"][number].as_f64().unwrap() > 0.0, "{number}");
    }
    assert!(again.get("auto").is_none());
    for key in ["solver", "state_hash"] {
        assert_eq!(chosen[key], again[key]);
    }
    let copy = |out: &str| std::fs::read_to_string(folder.path().join(out).join("scene.toml")).unwrap();
    assert!(copy("first").starts_with("# solver ") && copy("first").contains("auto:1000"));
    assert_eq!(copy("first"), copy("second"));
    // A copy may be run where it lies, and a scene of one's own is not replaced.
    assert_eq!(run("second/scene.toml", "second")["state_hash"], chosen["state_hash"]);
    std::fs::write(
        folder.path().join("scene.toml"),
        sutura::scene::BUILT_IN.replace("10:1", "10"),
    )
    .unwrap();
    let output = sutura(folder.path(), &["run", "scene.toml", "--seconds", "0.01", "--out", "."]);
    refused(&output, "another --out is right");
}

/// Whose hand it was stands in the report and in the copy of the scene, and running the copy gives the same bits.
#[test]
fn a_hand_of_a_skill_is_recorded_and_repeats_from_the_copy() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str], out: &str| -> serde_json::Value {
        let common = ["run", "--json", "--seconds", "0.03", "--out", out];
        let output = sutura(folder.path(), &[&common[..], arguments].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let novice = run(&["--operator", "novice", "--seed", "3"], "novice");
    assert_eq!((&novice["operator"], &novice["seed"]), (&"novice".into(), &3.into()));
    let again = run(&["novice/scene.toml"], "again");
    for key in ["operator", "seed", "state_hash"] {
        assert_eq!(novice[key], again[key], "{key}");
    }
    let copy = |out: &str| std::fs::read_to_string(folder.path().join(out).join("scene.toml")).unwrap();
    assert!(copy("novice").ends_with("\n[skill]\nname = \"novice\"\nseed = 3\n"));
    assert_eq!(copy("novice"), copy("again"));
    // Another hand in the place of the scene's; without a number the first of its skill.
    let expert = run(&["novice/scene.toml", "--operator", "expert"], "expert");
    assert_eq!((&expert["operator"], &expert["seed"]), (&"expert".into(), &0.into()));
    let script = run(&[], "script");
    assert!(script.get("operator").is_none() && script.get("seed").is_none());
    assert!(novice["state_hash"] != expert["state_hash"] && expert["state_hash"] != script["state_hash"]);
}

#[test]
fn a_hand_with_nothing_to_sew_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let touch = include_str!("../scenes/touch.toml");
    std::fs::write(folder.path().join("touch.toml"), touch).unwrap();
    let skill = "\n[skill]\nname = \"expert\"\nseed = 1\n";
    std::fs::write(folder.path().join("skill.toml"), touch.to_owned() + skill).unwrap();
    let master = sutura::scene::BUILT_IN.to_owned() + &skill.replace("expert", "master");
    std::fs::write(folder.path().join("master.toml"), master).unwrap();
    for (arguments, what) in [
        (
            &["touch.toml", "--operator", "expert"][..],
            "--operator expert: touch.toml has no stitch to sew",
        ),
        (&["skill.toml"], "section [skill] needs effect puncture"),
        (
            &["master.toml"],
            "skill.name = \"master\": there are expert, novice, clumsy",
        ),
        (&["--operator", "master"], "there are expert, novice, clumsy"),
        (&["--operator", "expert", "--seed", "-1"], "-1"),
        (&["--seed", "1"], "--operator <SKILL>"),
    ] {
        refused(&sutura(folder.path(), &[&["run"], arguments].concat()), what);
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
}

#[test]
fn a_poke_may_leave_its_solver_to_a_clock() {
    let folder = tempfile::tempdir().unwrap();
    let short = ["poke", "--nodes", "6x6x4", "--run-ms", "30", "--path", "drag", "--json"];
    let output = sutura(folder.path(), &[&short[..], &["--solver", "auto:1000"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["auto"]["budget_us"], 1000);
    assert!(report["auto"]["force_error"].as_f64().unwrap() <= 1e-3, "{report}");
    assert!(report["solver"].as_str().unwrap().contains(':'));
}

#[test]
fn a_budget_that_nothing_meets_names_a_smaller_lattice() {
    let folder = tempfile::tempdir().unwrap();
    let scene = sutura::scene::BUILT_IN.replace("\nsolver = \"be-pcg:10:1\"", "\nsolver = \"auto:1\"");
    std::fs::write(folder.path().join("mine.toml"), &scene).unwrap();
    let at = scene.lines().position(|line| line.starts_with("solver = ")).unwrap() + 1;
    let line = refused(&sutura(folder.path(), &["run", "mine.toml"]), "patch.size_mm = [");
    let start = format!("error: mine.toml:{at}: solver = \"auto:1\": no solver takes 1 µs or less a tick");
    assert!(line.starts_with(&start), "{line}");
    let poke = ["poke", "--nodes", "12x12x8", "--run-ms", "20", "--solver", "auto:1"];
    refused(&sutura(folder.path(), &poke), "--nodes ");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn the_study_of_a_scene_is_a_table_with_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let scene = include_str!("../scenes/touch.toml").replace("size_mm = [40, 30, 12]", "size_mm = [12, 12, 8]");
    std::fs::write(folder.path().join("touch.toml"), scene).unwrap();
    let study = ["study", "accuracy", "--out", "o", "--json", "--scene", "touch.toml"];
    let output = sutura(folder.path(), &study);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let table: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = table["rows"].as_array().unwrap();
    let chosen = rows.iter().find(|row| row["solver"] == table["solver"]).unwrap();
    assert_eq!(
        (&chosen["within"], &table["auto"]["budget_us"]),
        (&true.into(), &1000.into())
    );
    for number in ["us_median", "us_p99", "force_error"] {
        assert_eq!(chosen[number], table["auto"][number], "{number}");
    }
    let csv = std::fs::read_to_string(folder.path().join("o/budget.csv")).unwrap();
    assert_eq!(csv.lines().count(), rows.len() + 1);
    assert!(
        ["budget.json", "budget.png"]
            .iter()
            .all(|name| folder.path().join("o").join(name).exists())
    );
}

/// `sutura scene --print-default | head -0`, and the like of it.
#[test]
fn a_closed_stdout_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let short = ["run", "--json", "--seconds", "0.001", "--out", "o"];
    for arguments in [&["scene", "--print-default"][..], &short] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = Command::new(env!("CARGO_BIN_EXE_sutura"))
            .args(arguments)
            .current_dir(folder.path())
            .stdout(writer)
            .output()
            .unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
    }
    assert!(folder.path().join("o/force.csv").exists());
}

/// Ctrl+C: exit code 130 and no file, whole or half.
#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_sutura"))
        .args(["run", "--realtime", "--out", "o"])
        .current_dir(folder.path())
        .spawn()
        .unwrap();
    let out = folder.path().join("o");
    while !out.exists() {
        assert!(child.try_wait().unwrap().is_none(), "the run ended before it began");
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let killed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(killed.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(std::fs::read_dir(out).unwrap().count(), 0);
}

#[test]
fn moduli_are_one_json_object() {
    let folder = tempfile::tempdir().unwrap();
    let output = sutura(
        folder.path(),
        &[
            "moduli",
            "--block",
            "2x2x2",
            "--law",
            "volume",
            "--poisson",
            "0.45",
            "--json",
        ],
    );
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["asked"]["young_kpa"], 100.0);
    for (measured, expected) in [
        (&report["measured"]["young_kpa"]["x"], 100.0),
        (&report["measured"]["young_kpa"]["z"], 100.0),
        (&report["measured"]["poisson"], 0.45),
        (&report["measured"]["shear_kpa"], 100.0 / 2.9),
    ] {
        assert!((measured.as_f64().unwrap() / expected - 1.0).abs() < 1e-3, "{report}");
    }
    assert!(report["explicit_dt_max_us"].as_f64().unwrap() > 0.0);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn bad_flags_are_one_line() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, what) in [
        (&["moduli", "--law", "axial", "--poisson", "0.3"][..], "law volume only"),
        (
            &["moduli", "--segments", "0:100"],
            "--segments changes nothing without --curve",
        ),
        (&["moduli", "--block", "12"], "three counts are needed, such as 8x8x4"),
        (&["moduli", "--pitch-mm", "0"], "a number from 0.01 to 100 is needed"),
        (&["voxelize", "a.stl"], "--pitch-mm <P>"),
        (
            &["study", "accuracy", "--out", "o", "--budget-us", "1001"],
            "1001 is not in 1..=1000",
        ),
        (
            &["study", "accuracy", "--out", "o", "--quick", "--scene", "a.toml"],
            "--quick",
        ),
        (&["study", "accuracy", "--out", "o", "--scene", "a.toml"], "a.toml"),
    ] {
        refused(&sutura(folder.path(), arguments), what);
    }
}
