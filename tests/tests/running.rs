//! A running suture: three stitches with one thread, against what a static solve in double precision makes of the same punctures and tension.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::{Path, PathBuf};

use sutura::run::embedded::PcRig;
use sutura::run::report::Report;
use sutura::scene::build::Built;
use sutura::study::double::{Field, Model, V};
use sutura_controller::coupling::Kernel;
use sutura_controller::lanes::Level;
use sutura_controller::lattice::{Lattice, PC_NODES, Tissue};
use sutura_controller::link::Plant as _;
use sutura_controller::math::Vec3;
use sutura_controller::record::Output;
use sutura_controller::{surface, tissue, wound};
use sutura_shared::scene::Stage;
use sutura_tests::scenario;

/// Most ticks of a run, and ticks of it after the knot.
const TICKS_MAX: usize = 60_000;
const AFTER: usize = 1500;

fn file() -> PathBuf {
    scenario::scene_file("running-suture")
}

/// The scene with another value for one of its keys, in a file of its own.
fn changed(folder: &Path, from: &str, to: &str) -> PathBuf {
    let text = std::fs::read_to_string(file()).unwrap();
    assert!(text.contains(from), "{from}");
    let path = folder.join("changed.toml");
    std::fs::write(&path, text.replace(from, to)).unwrap();
    path
}

fn closes(report: &Report) {
    let gaps = &report.wound_gap_mm.at_stitch;
    assert_eq!(gaps.len(), 3);
    for gap in gaps {
        assert!((-0.1..0.3).contains(&gap.after), "{gap:?}");
    }
    assert_eq!(report.faults, Vec::<&str>::new());
}

#[test]
fn three_stitches_close_the_wound() {
    let report = scenario::run(Some(file())).unwrap();
    closes(&report);
    let punctures: Vec<_> = report.punctures.iter().map(|p| (p.stitch, p.site)).collect();
    let expected: Vec<_> = (1..=3)
        .flat_map(|stitch| ["a", "b", "c", "d"].map(|site| (stitch, site)))
        .collect();
    assert_eq!(punctures, expected);
    for puncture in &report.punctures {
        assert!((puncture.force_n / puncture.f0_n - 1.0).abs() <= 0.03, "{puncture:?}");
    }
    let stages: Vec<_> = report.stages.iter().map(|stage| (stage.stitch, stage.name)).collect();
    let each = ["approach", "indent", "drive", "exit", "pull-through", "tension"];
    let mut expected: Vec<_> = (1..=3).flat_map(|stitch| each.map(|name| (stitch, name))).collect();
    expected.extend([(3, "tie"), (3, "done")]);
    assert_eq!(stages, expected);
    let score = report.score.unwrap();
    let missing: Vec<_> = score.rows.iter().filter(|row| row.value.is_none()).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

/// What is left of a run: the rest places of the punctures that hold the thread, in order from its tail, its tension, and the mean gap [m].
struct Sewn {
    points: Vec<Vec3>,
    tension: f64,
    gap: f64,
}

fn sew(built: &Built) -> Sewn {
    let mut memory = scenario::memory();
    let mut rig = PcRig::new(&mut memory, Level::best());
    rig.load(&built.scene, &built.cells).unwrap();
    let mut outputs: Vec<Output> = Vec::new();
    let mut points = Vec::new();
    let mut done = 0;
    while outputs.len() < TICKS_MAX && done < AFTER {
        let output = rig.tick();
        if output
            .puncture
            .is_some_and(|puncture| matches!(puncture.site.name(), "a" | "d"))
        {
            let site = output.puncture.unwrap().site;
            let mut sites = rig.controller().sites();
            points.push(sites.find(|(other, _)| *other == site).unwrap().1.point().unwrap().rest);
        }
        done = if output.stage == Stage::Done { done + 1 } else { 0 };
        outputs.push(output);
    }
    Sewn {
        points,
        tension: rig.controller().pull().stitch.into(),
        gap: outputs.last().unwrap().gap_mean.into(),
    }
}

/// The wound as the static solve has it.
struct Wound {
    model: Model,
    lattice: Box<Lattice<PC_NODES>>,
    faces: wound::Faces,
    /// The thread's points and their places at rest.
    points: Vec<(Kernel, V)>,
}

impl Wound {
    fn new(built: &Built, points: &[Vec3]) -> Self {
        let mut lattice: Box<Lattice<PC_NODES>> = bytemuck::zeroed_box();
        let material = tissue::assemble(&built.scene, &built.cells, &mut lattice).unwrap();
        let faces = wound::faces(
            built.scene.wound.as_ref().unwrap(),
            built.scene.stitch.as_ref(),
            &lattice,
        )
        .unwrap();
        let rest: Box<Tissue<PC_NODES>> = bytemuck::zeroed_box();
        let radius = built.scene.contact.kernel_m;
        let held = |p: &Vec3| (surface::kernel_at(&lattice, &rest, *p, radius), p.map(f64::from));
        Self {
            model: Model::new(&lattice, &material),
            points: points.iter().map(held).collect(),
            faces,
            lattice,
        }
    }

    /// Force on every node that moves: springs, faces that meet, and the thread, which pulls with `tension` along straight pieces [N].
    fn forces(&self, u: &Field, tension: f64, force: &mut Field) {
        self.model.elastic(u, force);
        let penalty = f64::from(self.faces.penalty);
        for (left, right) in self.faces.pairs() {
            let rest = f64::from(self.faces.width(0.0, 0.0));
            let overlap = (rest + u.get(right).x - u.get(left).x).min(0.0);
            force.add(left, V::x() * penalty * overlap);
            force.add(right, V::x() * -penalty * overlap);
        }
        let place = |(kernel, rest): &(Kernel, V)| {
            kernel
                .iter()
                .fold(*rest, |sum, (node, weight)| sum + u.get(node) * f64::from(weight))
        };
        for (from, to) in self.points.iter().zip(self.points.iter().skip(1)) {
            let pull = (place(to) - place(from)).normalize() * tension;
            for (point, pull) in [(from, pull), (to, -pull)] {
                point
                    .0
                    .iter()
                    .for_each(|(node, weight)| force.add(node, pull * f64::from(weight)));
            }
        }
        for node in 0..u.len() {
            if self.lattice.free[node] <= 0.0 {
                force.set(node, V::zeros());
            }
        }
    }

    /// Mean gap at rest under `tension` [m]: nodes of one mass each slide down the energy and are stopped when they would climb (Bitzek 2006).
    fn gap(&self, tension: f64) -> f64 {
        // Springs of skin at its steepest, all that meet in a node: heavier than is stable at steps of 1.
        let mass = 2e5;
        let n = self.model.len();
        let [mut u, mut v, mut force] = [(); 3].map(|()| Field::zeros(n));
        for _ in 0..20_000 {
            self.forces(&u, tension, &mut force);
            let most = (0..n).map(|node| force.get(node).norm()).fold(0.0, f64::max);
            if most < 1e-6 {
                break;
            }
            if v.dot(&force) < 0.0 {
                v.clear();
            }
            v.blend(1.0, 1.0 / mass, &force);
            u.blend(1.0, 1.0, &v);
        }
        let mut moved: Box<Tissue<PC_NODES>> = bytemuck::zeroed_box();
        for node in 0..n {
            let at = u.get(node);
            for c in 0..3 {
                moved.displacement[c][node] = at[c] as f32;
            }
        }
        wound::gap(&self.faces, &self.lattice, &moved).mean.into()
    }
}

/// With a pull that leaves the wound half open, and with that of the scene.
#[test]
fn the_gap_is_that_of_a_static_solve() {
    let folder = tempfile::tempdir().unwrap();
    let half = changed(folder.path(), "tension_n = 1.3", "tension_n = 0.3");
    for path in [half, file()] {
        let built = scenario::built(Some(&path)).unwrap();
        let sewn = sew(&built);
        assert_eq!(sewn.points.len(), 6);
        let solved = Wound::new(&built, &sewn.points).gap(sewn.tension);
        eprintln!(
            "{:.3} N: mean gap {:.3} mm, static solve {:.3} mm",
            sewn.tension,
            sewn.gap * 1e3,
            solved * 1e3
        );
        let difference = (sewn.gap - solved).abs();
        // A tenth of the gap; of one that is closed a tenth of what is allowed to be left of it.
        assert!(difference <= (0.1 * solved.abs()).max(3e-5), "{difference:e}");
    }
}

#[test]
fn stitches_and_their_spacing_act() {
    let folder = tempfile::tempdir().unwrap();
    let first = |path: &Path| {
        let built = scenario::built(Some(path)).unwrap();
        let mut memory = scenario::memory();
        let mut rig = PcRig::new(&mut memory, Level::best());
        rig.load(&built.scene, &built.cells).unwrap();
        rig.tick()
    };
    let base = first(&file());
    for (from, to) in [("stitches = 3", "stitches = 2"), ("spacing_mm = 6", "spacing_mm = 6.5")] {
        assert_ne!(first(&changed(folder.path(), from, to)).position, base.position, "{to}");
    }
}
