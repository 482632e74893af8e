//! What an effect that is off may cost: at most ten instructions a tick and nothing per node, against a scene that never mentions it.
//!
//! Instructions are counted by callgrind in `sutura ticks`, on two sizes of patch, of scenes whose effects are off one by one while their
//! parameters are filled in. That the functions of an effect are not entered is seen by counting theirs.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;
use std::process::Command;

use sutura::run::embedded::NODES_MAX;
use sutura::scene::{BUILT_IN, Source, build, check};
use sutura::study::callgrind::{self, instructions};
use sutura::study::effects::{without, write};
use sutura_shared::check::Validate;
use sutura_shared::scene::{Body, Effect, Effects, Motion, Scene, Solver};

/// Voxels along x, y and z of the two patches, as the built-in scene has them at other sizes [mm].
const SIZES: [[u32; 3]; 2] = [[24, 14, 12], [40, 30, 12]];
/// Ticks that are counted: the hand is at the skin from the first on.
const TICKS: u32 = 10;
/// What an effect that is off may add to a tick.
const ADDED: f64 = 10.0;

fn program() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_sutura"))
}

/// Whether instructions can be counted here; if not, says so.
fn counts(test: &str) -> bool {
    let present = callgrind::present();
    if let Err(error) = &present {
        eprintln!("skipped: {test}: {error}");
    }
    present.is_ok()
}

/// The built-in scene on a patch of this size, its hand at the skin, and its cells.
fn stitch(size_mm: [u32; 3]) -> (Scene, Vec<u8>) {
    let [x, y, z] = size_mm;
    let text = BUILT_IN
        .replace("size_mm = [40, 30, 12]", &format!("size_mm = [{x}, {y}, {z}]"))
        .replace("length_mm = 18", "length_mm = 10");
    let source = Source {
        name: "stitch".to_owned(),
        text,
    };
    let built = build::build(&check::check(&source, &source.parse().unwrap()).unwrap(), NODES_MAX).unwrap();
    let mut scene = built.scene;
    let hand = scene.hand.as_mut().unwrap();
    if let Motion::Line { to } = hand.steps[0].motion {
        hand.start = to;
    }
    hand.steps.remove(0);
    let thread = scene.thread.as_mut().unwrap();
    (thread.friction, thread.bending_n_m2) = (0.2, 2.3e-7);
    for tissue in &mut scene.tissues {
        if let Body::Soft { strength_n, .. } = &mut tissue.body {
            *strength_n = 20.0;
        }
    }
    // So many ticks tell as much of a solve with fewer iterations.
    scene.solver = Solver::BePcg {
        iterations: 3,
        newton: 1,
    };
    (scene, built.cells)
}

/// The scene with its effect's bit off and all its parameters in place.
fn switched_off(scene: &Scene, effect: Effect) -> Scene {
    Scene {
        effects: Effects(scene.effects.0 & !(effect as u32)),
        ..scene.clone()
    }
}

/// Instructions of a tick, of `function` alone, in all of `TICKS`.
fn counted(scene: &Scene, cells: &[u8], function: &str) -> Result<u64, callgrind::Error> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene");
    write(&file, scene, cells).unwrap();
    instructions(
        program(),
        &["ticks".into(), file.into_os_string(), TICKS.to_string().into()],
        function,
    )
}

/// The hash of all that happens.
fn hash(scene: &Scene, cells: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene");
    write(&file, scene, cells).unwrap();
    let output = Command::new(program())
        .arg("ticks")
        .arg(&file)
        .arg(TICKS.to_string())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Holds the scene with the parameters of what is off to the one that has none.
fn costs_nothing(mentions: &Scene, never: &Scene, cells: &[u8], what: &str) {
    assert_ne!(mentions, never, "{what}: it has parameters to fill in");
    let [more, less] = [mentions, never].map(|scene| counted(scene, cells, "*PcRig*tick*").unwrap());
    let added = (more as f64 - less as f64) / f64::from(TICKS);
    let nodes = never.lattice.cells.iter().fold(1, |all, cells| all * (cells + 1));
    eprintln!(
        "{what}, {nodes} nodes: {added} instructions a tick beside {}",
        less / u64::from(TICKS)
    );
    assert!(added.abs() <= ADDED, "{what}: {added} instructions a tick");
    assert_eq!(hash(mentions, cells), hash(never, cells), "{what}");
}

#[test]
fn an_effect_that_is_off_costs_ten_instructions_a_tick_at_most() {
    if !counts("an_effect_that_is_off_costs_ten_instructions_a_tick_at_most") {
        return;
    }
    // Gravity and the barrier have no parameters. A stitch and a thread cannot come without their effects: the wire refuses them.
    let effects = [
        Effect::Stiffening,
        Effect::SpringDamping,
        Effect::ShaftFriction,
        Effect::ThreadContact,
        Effect::WoundContact,
        Effect::Passivity,
        Effect::SkinTension,
        Effect::ThreadFriction,
        Effect::Knot,
        Effect::ThreadBending,
        Effect::Tearing,
    ];
    for (scene, cells) in SIZES.map(stitch) {
        for effect in effects {
            costs_nothing(
                &switched_off(&scene, effect),
                &without(&scene, effect),
                &cells,
                effect.name(),
            );
        }
    }
}

/// On a patch of more than 2,000 nodes, with the default solver.
#[test]
fn a_thread_of_a_hundred_links_costs_half_a_tick_at_most() {
    if !counts("a_thread_of_a_hundred_links_costs_half_a_tick_at_most") {
        return;
    }
    let (mut scene, cells) = stitch(SIZES[1]);
    scene.solver = Solver::default();
    let thread = scene.thread.as_mut().unwrap();
    (thread.nodes, thread.link_m) = (101, 0.002);
    let none = without(&scene, Effect::Thread);
    let [with, without] = [&scene, &none].map(|scene| counted(scene, &cells, "*PcRig*tick*").unwrap());
    let ratio = with as f64 / without as f64;
    eprintln!("a thread of 100 links: {ratio:.3} of a tick without");
    assert!(ratio <= 1.5, "{ratio}");
}

#[test]
fn a_scene_without_any_effect_pays_for_none() {
    if !counts("a_scene_without_any_effect_pays_for_none") {
        return;
    }
    for (scene, cells) in SIZES.map(stitch) {
        let never = Effect::ALL
            .into_iter()
            .fold(scene.clone(), |scene, effect| without(&scene, effect));
        let mut mentions = scene;
        mentions.effects = Effects::default();
        (mentions.stitch, mentions.thread) = (None, None);
        mentions.hand.clone_from(&never.hand);
        costs_nothing(&mentions, &never, &cells, "no effect");
        // The same under explicit substeps, which follow curves and dashpots in passes of their own.
        let explicit = |scene: &Scene| Scene {
            solver: Solver::Explicit { substeps: 0 },
            ..scene.clone()
        };
        costs_nothing(&explicit(&mentions), &explicit(&never), &cells, "no effect, explicit");
    }
}

#[test]
fn a_stitch_or_a_thread_without_its_effect_is_refused() {
    let (scene, _) = stitch(SIZES[0]);
    for (effect, field) in [(Effect::Puncture, "stitch"), (Effect::Thread, "thread")] {
        let error = switched_off(&scene, effect).validate().unwrap_err();
        assert_eq!(error.field, field);
    }
}

#[test]
fn functions_of_an_effect_that_is_off_are_not_entered() {
    if !counts("functions_of_an_effect_that_is_off_are_not_entered") {
        return;
    }
    let (scene, cells) = stitch(SIZES[0]);
    let functions = [
        (Effect::Thread, "*sutura_controller::thread::solve::condense*"),
        (Effect::ThreadContact, "*sutura_controller::tick::sewing::Skin*"),
    ];
    for (effect, function) in functions {
        if let Err(callgrind::Error::Nothing { .. }) = counted(&scene, &cells, function) {
            eprintln!("skipped: {function} is inlined: it cannot be seen whether it is entered");
            continue;
        }
        let entered = counted(&without(&scene, effect), &cells, function);
        assert!(
            matches!(entered, Err(callgrind::Error::Nothing { .. })),
            "{function}: {entered:?}"
        );
    }
}

/// A plain scene of a soft body has no curve beyond the first slope left once stiffening is out of it.
#[test]
fn without_stiffening_curves_are_lines() {
    let (scene, _) = stitch(SIZES[0]);
    for tissue in without(&scene, Effect::Stiffening).tissues {
        if let Body::Soft { curve, .. } = tissue.body {
            assert_eq!(curve.len(), 1);
        }
    }
}

/// A ball cannot puncture, and its scene has no wound: said instead of measured.
const NOT_FOR_A_BALL: [&str; 11] = [
    "gravity",
    "puncture",
    "shaft-friction",
    "thread",
    "thread-contact",
    "wound-contact",
    "skin-tension",
    "thread-friction",
    "knot",
    "thread-bending",
    "tearing",
];

#[test]
fn the_study_ends_with_json_and_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("touch.toml");
    let touch = include_str!("../scenes/touch.toml");
    // A patch of 6 × 5 × 4 voxels, and a ball that has done its work soon.
    let small = touch
        .replace("size_mm = [40, 30, 12]", "size_mm = [12, 10, 8]")
        .replace("approach_mm_per_s = 40", "approach_mm_per_s = 400")
        .replace("push_mm_per_s = 8", "push_mm_per_s = 80");
    fs::write(&scene, small).unwrap();
    let output = Command::new(program())
        .args([
            "study",
            "effects",
            "--quick",
            "--json",
            "--out",
            "o",
            "--scene",
            "touch.toml",
        ])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = report["rows"].as_array().unwrap();
    let names: Vec<_> = rows.iter().map(|row| row["effect"].as_str().unwrap()).collect();
    assert_eq!(names, Effect::ALL.map(Effect::name));
    for row in rows {
        let name = row["effect"].as_str().unwrap();
        // The barrier is off, but can be added.
        let measured = !NOT_FOR_A_BALL.contains(&name);
        assert_eq!(row["on"], measured && name != "barrier", "{name}");
        assert_eq!(row["why"].is_string(), !measured, "{name}");
        assert_eq!(row["us_with"].is_f64(), measured, "{name}");
        assert!(row["state_bytes"].is_u64() && row["stages"].is_array(), "{name}");
        let counted = report["counted_ticks"].is_u64();
        assert_eq!(row["instructions_with"].is_f64(), counted && measured, "{name}");
    }
    let stiffening = &rows[1];
    assert!(stiffening["force_change_rms_n"].as_f64().unwrap() > 0.0);
    for kind in ["csv", "json", "md", "png", "svg"] {
        assert!(folder.path().join("o/effects").with_extension(kind).exists(), "{kind}");
    }
    let csv = fs::read_to_string(folder.path().join("o/effects.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + Effect::ALL.len());
}
