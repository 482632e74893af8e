//! One stitch from end to end: what the built-in scene and the two beside it must do.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::PathBuf;
use std::sync::OnceLock;

use sutura::run::embedded::PcRig;
use sutura::run::report::Report;
use sutura_controller::lanes::Level;
use sutura_controller::lattice;
use sutura_controller::link::Plant as _;
use sutura_tests::scenario;

/// The stages of one stitch.
const STAGES: [&str; 8] = [
    "approach",
    "indent",
    "drive",
    "exit",
    "pull-through",
    "tension",
    "tie",
    "done",
];

/// The built-in scene, run once for all tests.
fn built_in() -> &'static Report {
    static REPORT: OnceLock<Report> = OnceLock::new();
    REPORT.get_or_init(|| scenario::run(None).unwrap())
}

/// The wound closes to a quarter at most and its edges do not pass each other, without a fault on the way.
fn closes(report: &Report) {
    let [gap] = report.wound_gap_mm.at_stitch.as_slice() else {
        panic!("one stitch: {:?}", report.wound_gap_mm)
    };
    assert!((-0.1..=0.25 * gap.before).contains(&gap.after), "{gap:?}");
    assert_eq!(report.faults, Vec::<&str>::new());
}

fn stage_names(report: &Report) -> Vec<&str> {
    report.stages.iter().map(|stage| stage.name).collect()
}

#[test]
fn the_wound_closes() {
    let report = built_in();
    closes(report);
    assert!(report.nodes >= 1500, "{}", report.nodes);
    assert!((10_000..=20_000).contains(&report.ticks), "{}", report.ticks);
    assert_eq!(report.link.errors, 0);
}

#[test]
fn every_stage_comes_once_and_in_order() {
    let report = built_in();
    assert_eq!(stage_names(report), STAGES);
    let mut next = 1;
    for stage in &report.stages {
        assert!(stage.from_tick == next && stage.to_tick >= next, "{stage:?}");
        next = stage.to_tick + 1;
    }
    assert_eq!(next, report.ticks + 1);
}

#[test]
fn the_skin_gives_way_at_f0() {
    let report = built_in();
    let sites: Vec<_> = report.punctures.iter().map(|puncture| puncture.site).collect();
    assert_eq!(sites, ["a", "b", "c", "d"]);
    for puncture in &report.punctures {
        assert!((puncture.force_n / puncture.f0_n - 1.0).abs() <= 0.03, "{puncture:?}");
    }
}

#[test]
fn the_thread_is_pulled_as_a_surgeon_would() {
    let tension = built_in().stages.iter().find(|stage| stage.name == "tension").unwrap();
    assert!((0.2..=3.0).contains(&tension.thread_peak_n), "{tension:?}");
}

/// A thread that lies level between its punctures draws them together with its whole tension.
#[test]
fn the_stitch_holds_the_wound_with_the_tension_of_its_thread() {
    let report = built_in();
    let rows = &report.score.as_ref().unwrap().rows;
    let left = rows
        .iter()
        .find(|row| row.name == "tension left in the stitch")
        .unwrap();
    let (tension, closing) = (left.value.unwrap(), f64::from(report.closing_n[0]));
    assert!(
        tension > 0.3 && (0.95..=1.0).contains(&(closing / tension)),
        "{closing} of {tension} N"
    );
}

#[test]
fn a_second_run_has_the_same_bits() {
    let second = scenario::run(None).unwrap();
    assert_eq!(second.state_hash, built_in().state_hash);
    assert_eq!(second.ticks, built_in().ticks);
}

/// The built-in scene with another solver.
fn sewn_with(solver: &str) -> Report {
    let text = std::fs::read_to_string(scenario::scene_file("stitch")).unwrap();
    let asked = text.lines().find(|line| line.starts_with("solver = ")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("stitch.toml");
    std::fs::write(&file, text.replace(asked, &format!("solver = \"{solver}\""))).unwrap();
    let report = scenario::run(Some(file)).unwrap();
    assert_eq!(report.solver, solver);
    report
}

/// Needle, thread and wound enter every implicit solver alike.
#[test]
fn every_implicit_solver_sews() {
    for solver in ["be-chebyshev:20", "vbd:8:1.5"] {
        let report = sewn_with(solver);
        closes(&report);
        assert_eq!(stage_names(&report), STAGES, "{solver}");
        assert_eq!(report.punctures.len(), 4, "{solver}");
        for puncture in &report.punctures {
            let ratio = puncture.force_n / puncture.f0_n;
            assert!((ratio - 1.0).abs() <= 0.03, "{solver}: {puncture:?}");
        }
    }
}

/// The skull's meshes are real, with all their faults.
#[test]
fn a_wound_in_a_real_head_closes() {
    if sutura_tests::shared("the stitch in a head", "data/anat_stl/cranium_skin.stl").is_none() {
        return;
    }
    let report = scenario::run(Some(scenario::scene_file("head-stl"))).unwrap();
    closes(&report);
    assert_eq!(stage_names(&report), STAGES);
}

/// The same ticks without the frames end in the same bits, and with every node at most 0.05 mm from where it began.
#[test]
fn touched_tissue_returns_to_rest() {
    let scene: PathBuf = scenario::scene_file("touch");
    let report = scenario::run(Some(scene.clone())).unwrap();
    assert_eq!(stage_names(&report), ["approach", "indent", "done"]);
    assert_eq!(report.faults, Vec::<&str>::new());

    let built = scenario::built(Some(&scene)).unwrap();
    let mut memory = scenario::memory();
    let mut rig = PcRig::new(&mut memory, Level::best());
    rig.load(&built.scene, &built.cells).unwrap();
    let mut farthest_mm = [0.0_f32; 2];
    for tick in 1..=report.ticks {
        rig.tick();
        if tick % 100 == 0 || tick == report.ticks {
            let moved_mm = farthest(&rig) * 1e3;
            farthest_mm = [farthest_mm[0].max(moved_mm), moved_mm];
        }
    }
    assert_eq!(format!("{:016x}", rig.state_hash()), report.state_hash);
    let [during, after] = farthest_mm;
    println!("farthest node: {during:.3} mm while touched, {after:.6} mm at the end");
    assert!(during > 1.0 && after <= 0.05, "{farthest_mm:?} mm");
}

/// Largest displacement of a node [m].
fn farthest(rig: &PcRig<'_>) -> f32 {
    let (lattice, tissue) = (rig.controller().lattice(), rig.controller().tissue());
    (0..lattice.len())
        .map(|node| lattice::at(&tissue.displacement, node).norm())
        .fold(0.0, f32::max)
}
