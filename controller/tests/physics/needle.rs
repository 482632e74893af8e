//! The needle at its sites: in, back, through, and what its friction costs the hand.

use super::block::{Block, DEFAULT, PITCH, scene, stiffening};
use nalgebra::Vector3;
use std::f32::consts::PI;
use sutura_controller::coupling::Coupling;
use sutura_controller::event::Puncture;
use sutura_controller::math::{Mat3, Pose, Vec3};
use sutura_controller::needle::{self, Arc, Body, Grip, Params, Passage, State};
use sutura_controller::safety;
use sutura_controller::wound::{self, Faces};
use sutura_shared::scene::{Effect, Law, Scene, Site, Stitch, Tool, Wound};

const F0: [f32; 4] = [0.95, 0.21, 0.3, 0.665];
/// A half circle of 26 mm.
const LENGTH: f32 = 26e-3;
const RADIUS: f32 = LENGTH / PI;
/// Height of the arc's centre above the skin at rest [m].
const HEIGHT: f32 = 3e-3;
/// Friction per metre [N/m] and cutting force [N].
const FRICTION: [f32; 2] = [20.0, 0.2];

/// Skin, a needle that turns about a fixed centre, and what came of it.
struct Drive {
    block: Block,
    faces: Option<Faces>,
    params: Params,
    state: State,
    angle: f32,
    punctures: Vec<Puncture>,
}

/// The needle with its tip at `angle` along its way: at 0 it points straight down on the left, at π straight up on the right.
fn pose(angle: f32) -> Pose {
    let (sin, cos) = (sine(angle), sine(angle + 0.5 * PI));
    let (out, along) = (Vec3::new(-cos, 0.0, -sin), Vec3::new(sin, 0.0, -cos));
    // The tip stands two thirds of the arc ahead of the grasp point.
    let (s, c) = (sine(2.0 * PI / 3.0), -0.5);
    let (x, y) = (out * c - along * s, out * s + along * c);
    Pose {
        position: Vec3::z() * HEIGHT + x * RADIUS,
        rotation: Mat3::from_columns(&[x, y, x.cross(&y)]),
    }
}

fn sine(angle: f32) -> f32 {
    f64::from(angle).sin() as f32
}

impl Drive {
    fn new(effects: &[Effect]) -> Self {
        let scene = skin(effects);
        let block = Block::filled(&scene);
        Self::of(&scene, block, None)
    }

    /// The same with a wound between the sites down to layer `floor` of nodes.
    fn wounded(effects: &[Effect], floor: u16) -> Self {
        let mut scene = skin(effects);
        scene.wound = Some(Wound {
            faces: [7, 8],
            rows: [2, 6],
            floor,
            penalty_n_per_m: 2000.0,
        });
        let [nx, ny, _] = scene.lattice.cells.map(usize::from);
        let missing = |n: usize| n % nx == 7 && (2..6).contains(&(n / nx % ny)) && n / nx / ny >= usize::from(floor);
        let cells: Vec<u8> = (0..scene.lattice.count()).map(|n| u8::from(!missing(n))).collect();
        let block = Block::new(&scene, &cells);
        let faces = wound::faces(scene.wound.as_ref().unwrap(), &block.lattice).unwrap();
        Self::of(&scene, block, Some(faces))
    }

    fn of(scene: &Scene, block: Block, faces: Option<Faces>) -> Self {
        Self {
            block,
            faces,
            params: Params::new(scene),
            state: State::default(),
            angle: -0.1,
            punctures: Vec::new(),
        }
    }

    /// One tick with the needle turned to `angle`.
    fn tick(&mut self, angle: f32) -> Grip {
        self.angle = angle;
        self.hold(pose(angle))
    }

    /// One tick with the hand there.
    fn hold(&mut self, pose: Pose) -> Grip {
        let arc = Arc::new(self.params.tool, pose);
        let block = &mut self.block;
        let mut coupling = Coupling::default();
        let body = Body {
            lattice: &block.lattice,
            tissue: &block.tissue,
            faces: self.faces.as_ref(),
        };
        needle::detect(&self.params, &mut self.state, &arc, &body);
        let holds = needle::couple(&self.params, &mut self.state, &arc, &block.tissue, &mut coupling);
        let moved = block.tick(DEFAULT, &coupling, None);
        let grip = needle::settle(&self.params, &mut self.state, &arc, (&holds, &moved), &block.tissue);
        self.punctures.extend(grip.puncture);
        grip
    }

    /// Turns until the needle is out at d.
    fn sew(&mut self, mut see: impl FnMut(&Self, &Grip)) {
        while !matches!(self.state.at(Site::D), Passage::Passed(_)) {
            let grip = self.tick(self.angle + 1e-3);
            see(self, &grip);
            assert!(self.angle < 7.0, "the needle is not out");
        }
    }

    /// Turns at `rate` [rad/s] until `done`, by 4 rad at most; whether it was done.
    fn turn(&mut self, rate: f32, done: impl Fn(&State) -> bool) -> bool {
        let ticks = (4000.0 / rate.abs()) as u32;
        (0..ticks).any(|_| {
            self.tick(self.angle + rate * 1e-3);
            done(&self.state)
        })
    }
}

/// A block with a needle and its stitch.
fn skin(effects: &[Effect]) -> Scene {
    let skin = stiffening(&[(0.0, 281e3), (0.3, 1.7e6), (0.6, 3.66e6)]);
    let mut scene = scene([15, 8, 5], Law::Isotropic, &[skin], effects);
    scene.lattice.damping_per_s = 50.0;
    scene.tool = Tool::Needle {
        radius_m: RADIUS,
        length_m: LENGTH,
        grasp_m: LENGTH / 3.0,
    };
    scene.contact.kernel_m = 1.5 * PITCH;
    scene.stitch = Some(Stitch {
        a_m: [-RADIUS, 0.0],
        f0_n: F0,
        under_m: 2e-3,
        friction_n_per_m: FRICTION[0],
        cutting_n: FRICTION[1],
        tension_gain: 2.0,
    });
    scene
}

fn in_hole(state: &State) -> bool {
    matches!(state.at(Site::A), Passage::Hole(_))
}

#[test]
fn the_skin_gives_way_at_f0() {
    let mut drive = Drive::new(&[Effect::Puncture, Effect::Stiffening]);
    let mut before = 0.0;
    let puncture = loop {
        let grip = drive.tick(drive.angle + 1e-3);
        if let Some(puncture) = grip.puncture {
            break puncture;
        }
        assert!(drive.angle < 1.0, "no puncture");
        assert!(drive.punctures.is_empty() && !in_hole(&drive.state));
        before = grip.force.norm();
    };
    eprintln!("{puncture:?}, {before} N a tick before");
    assert!(in_hole(&drive.state));
    assert_eq!(puncture.site, Site::A);
    assert!((puncture.f0 - F0[0]).abs() < f32::EPSILON);
    // 8.3 mm/s through the coupling's K_c + B_c/dt raises the force by at most 16.6 mN a tick.
    let rise = 1e-3 * RADIUS * (drive.params.stiffness + drive.params.rate);
    assert!(
        puncture.force >= F0[0] && puncture.force < F0[0] + rise,
        "{} N",
        puncture.force
    );
    assert!(before < F0[0] + 0.1, "{before} N");
    assert!(puncture.depth > 0.0 && puncture.depth < 4e-3, "{} m", puncture.depth);
}

/// In the tick in which it meets the skin the tip has come most of its way through air: that must not throw the skin ahead of it.
#[test]
fn a_thrust_at_half_a_metre_a_second_goes_in() {
    let mut drive = Drive::new(&[Effect::Puncture, Effect::Stiffening]);
    let rate = 0.5 / RADIUS;
    drive.angle = -1.0;
    assert!(drive.turn(rate, in_hole));
    let [puncture] = drive.punctures[..] else {
        panic!("{:?}", drive.punctures)
    };
    // The coupling's spring is stretched by no more than the tip's way in a tick between one look at F0 and the next.
    let most = F0[0] + drive.params.stiffness * 0.5e-3;
    assert!((F0[0]..=most).contains(&puncture.force), "{} N", puncture.force);
    assert!(puncture.depth < 4e-3, "{} m", puncture.depth);
}

#[test]
fn a_needle_drawn_back_is_out_and_the_skin_is_free() {
    let mut drive = Drive::new(&[Effect::Puncture, Effect::ShaftFriction, Effect::Stiffening]);
    assert!(drive.turn(1.0, in_hole));
    for _ in 0..200 {
        drive.tick(drive.angle + 1e-3);
        assert!(in_hole(&drive.state));
    }
    assert!(drive.turn(-1.0, |state| matches!(state.at(Site::A), Passage::Track(_))));
    let mut grip = Grip::default();
    for _ in 0..500 {
        grip = drive.tick(drive.angle - 1e-3);
    }
    assert_eq!(grip.force, Vector3::zeros());
    assert!(drive.block.largest() < 5e-5, "{} m", drive.block.largest());
}

#[test]
fn the_needle_passes_both_sites_in_order() {
    let mut drive = Drive::new(&[Effect::Puncture, Effect::Stiffening]);
    assert!(drive.turn(1.0, in_hole));
    assert!(drive.turn(1.0, |state| matches!(state.at(Site::D), Passage::Touch(_))));
    assert!(drive.turn(0.3, |state| matches!(state.at(Site::D), Passage::Hole(_))));
    assert!(drive.turn(1.0, |state| matches!(state.at(Site::A), Passage::Passed(_))));
    assert!(matches!(drive.state.at(Site::D), Passage::Hole(_)));
    assert!(drive.turn(1.0, |state| matches!(state.at(Site::D), Passage::Passed(_))));
    punctured(&drive, &[Site::A, Site::D]);
}

/// These sites were punctured in order, at their F0.
fn punctured(drive: &Drive, sites: &[Site]) {
    for puncture in &drive.punctures {
        eprintln!("{puncture:?}");
    }
    let found: Vec<_> = drive.punctures.iter().map(|p| p.site).collect();
    assert_eq!(found, sites);
    for puncture in &drive.punctures {
        let f0 = F0[puncture.site as usize];
        assert!(puncture.force >= f0 && puncture.force < 1.03 * f0, "{puncture:?}");
    }
}

/// Layer of the floor of a wound of 8 mm, deeper than the arc's 5.3 mm, and of one of 4 mm.
const DEEP: u16 = 1;
const FLAT: u16 = 3;

#[test]
fn a_wound_deeper_than_the_arc_is_passed_at_four_sites() {
    let mut drive = Drive::wounded(&[Effect::Puncture, Effect::Stiffening], DEEP);
    drive.sew(|_, _| ());
    punctured(&drive, &Site::ALL);
    assert!(drive.state.sites.iter().all(|site| matches!(site, Passage::Passed(_))));
}

#[test]
fn a_wound_above_the_arc_is_passed_under() {
    let mut drive = Drive::wounded(&[Effect::Puncture, Effect::Stiffening], FLAT);
    drive.sew(|_, _| ());
    punctured(&drive, &[Site::A, Site::D]);
    assert_eq!(*drive.state.at(Site::B), Passage::Ahead);
}

/// The constraint points' distance from the needle's circle, from its definition: |ρ − R| in the plane and the height above it.
#[test]
fn constraint_points_stay_on_the_arc_over_half_a_turn() {
    let mut drive = Drive::wounded(&[Effect::Puncture, Effect::ShaftFriction, Effect::Stiffening], DEEP);
    let (mut farthest, mut held) = (0.0_f32, [0_u32; 5]);
    drive.sew(|drive, _| {
        let centre = Vec3::z() * HEIGHT + drive.state.offset;
        let holes = drive.state.sites.iter().filter(|site| matches!(site, Passage::Hole(_)));
        let places: Vec<_> = holes
            .map(|hole| hole.point().unwrap().place(&drive.block.tissue))
            .collect();
        held[places.len()] += 1;
        for place in places {
            let arm = place - centre;
            let flat = (arm.x * arm.x + arm.z * arm.z).sqrt() - RADIUS;
            farthest = farthest.max((flat * flat + arm.y * arm.y).sqrt());
        }
    });
    eprintln!("farthest from the arc: {farthest:.2e} m; ticks with 0 to 4 holes: {held:?}");
    assert!(held[1..].iter().all(|ticks| *ticks > 0) && drive.angle > PI);
    assert!(farthest <= 10e-6, "{farthest} m");
}

/// The virtual coupling is all that stands between hand and needle: whatever holds the needle, a way d of the hand gives no more than K d, and
/// B d/t for one that takes the time t, above what there was. A turn moves no point of the needle by more than its angle times the diameter.
#[test]
fn punctures_share_the_hands_force() {
    let mut drive = Drive::wounded(&[Effect::Puncture, Effect::Stiffening], DEEP);
    for site in Site::ALL {
        assert!(drive.turn(0.5, |state| matches!(state.at(site), Passage::Hole(_))));
        for _ in 0..100 {
            drive.tick(drive.angle + 2e-4);
        }
        let holes = drive.state.sites.iter().filter(|site| matches!(site, Passage::Hole(_)));
        assert_eq!(holes.count(), site as usize + 1);
        let mut most = 0.0_f32;
        for axis in [Vec3::x(), Vec3::y(), Vec3::z(), -Vec3::x(), -Vec3::y(), -Vec3::z()] {
            for (way, turn) in [(0.5e-3, 0.0), (0.0, PI / 90.0)] {
                for ticks in [1, 50] {
                    let shift = |part: f32| moved(pose(drive.angle), axis * (way * part), axis * (turn * part));
                    let poses: Vec<_> = (0..=ticks).map(|tick| shift(tick as f32 / ticks as f32)).collect();
                    let before = drive.hold(poses[0]).force.norm();
                    let d = way.max(turn * 2.0 * RADIUS);
                    let bound = before + d * (drive.params.stiffness + drive.params.rate / ticks as f32);
                    let stay = core::iter::repeat_n(&poses[ticks], 100);
                    for pose in poses.iter().chain(stay).collect::<Vec<_>>() {
                        let force = drive.hold(*pose).force.norm();
                        assert!(
                            force <= bound,
                            "{site:?} {axis:?} {way} {turn} {ticks}: {force} N, {bound} N"
                        );
                        most = most.max((force - before) / (bound - before));
                    }
                    for _ in 0..200 {
                        drive.hold(poses[0]);
                    }
                }
            }
        }
        eprintln!("{} punctures: at most {most:.3} of what is foretold", site as usize + 1);
    }
}

/// A pose shifted, and turned about its own origin by a rotation vector.
fn moved(pose: Pose, way: Vec3, turn: Vec3) -> Pose {
    let angle = turn.norm();
    let axis = if angle > 0.0 { turn / angle } else { Vec3::x() };
    Pose {
        position: pose.position + way,
        rotation: sutura_controller::math::rotation(axis, angle) * pose.rotation,
    }
}

/// Force along the needle that resists its advance [N]: the torque about the arc's own centre over R, where what acts across has no lever.
fn along(drive: &Drive, grip: &Grip) -> f32 {
    let lever = pose(drive.angle).position - Vec3::z() * HEIGHT;
    (grip.torque + lever.cross(&grip.force)).y / RADIUS
}

/// Shaft in the tissue and force along it while the needle turns on by `angle` at `rate`; samples from the second half, where all slips.
fn rubbed(drive: &mut Drive, rate: f32, angle: f32) -> Vec<(f32, f32)> {
    let ticks = (1e3 * angle / rate.abs()) as u32;
    let mut samples = Vec::new();
    for tick in 0..ticks {
        let grip = drive.tick(drive.angle + rate * 1e-3);
        if tick >= ticks / 2 {
            let inside = drive.state.at(Site::A).from_tip().unwrap();
            samples.push((inside, along(drive, &grip)));
        }
    }
    samples
}

/// Slope of the least squares line.
fn slope(samples: &[(f32, f32)]) -> f32 {
    let n = samples.len() as f64;
    let mean = |of: fn(&(f32, f32)) -> f32| samples.iter().map(|s| f64::from(of(s))).sum::<f64>() / n;
    let (x, y) = (mean(|s| s.0), mean(|s| s.1));
    let sum = |f: &dyn Fn(f64, f64) -> f64| {
        samples
            .iter()
            .map(|s| f(f64::from(s.0) - x, f64::from(s.1) - y))
            .sum::<f64>()
    };
    (sum(&|a, b| a * b) / sum(&|a, _| a * a)) as f32
}

/// Forth f L + cutting, back −f L, forth again in the track that is cut f L, and beyond its end the cutting again.
#[test]
fn friction_grows_with_the_shaft_and_turns_about() {
    let mut drive = Drive::new(&[Effect::Puncture, Effect::ShaftFriction, Effect::Stiffening]);
    let [per_length, cutting] = FRICTION;
    assert!(drive.turn(1.0, in_hole));
    drive.turn(1.0, |state| state.at(Site::A).from_tip() > Some(3e-3));
    let forth = rubbed(&mut drive, 0.25, 1.0);
    let back = rubbed(&mut drive, -0.25, 0.6);
    let again = rubbed(&mut drive, 0.25, 0.5);
    let on = rubbed(&mut drive, 0.25, 0.4);
    let named = [
        ("forth", forth, 1.0, cutting),
        ("back", back, -1.0, 0.0),
        ("again", again, 1.0, 0.0),
        ("on", on, 1.0, cutting),
    ];
    for (name, samples, sign, extra) in named {
        let slope = sign * slope(&samples);
        let worst = samples
            .iter()
            .map(|(l, f)| f - sign * (per_length * l + extra))
            .fold(0.0_f32, |a, b| a.max(b.abs()));
        eprintln!("{name}: {slope:.3} N/m of {per_length}; off by {worst:.2e} N at most");
        assert!((slope / per_length - 1.0).abs() < 0.02, "{name}: {slope} N/m");
        assert!(worst < 0.02 * (per_length * 5e-3 + extra), "{name}: {worst} N");
    }
}

/// A needle that comes back the way it went passes the skin without F0.
#[test]
fn a_track_is_entered_without_a_puncture() {
    let mut drive = Drive::new(&[Effect::Puncture, Effect::ShaftFriction, Effect::Stiffening]);
    assert!(drive.turn(1.0, in_hole));
    drive.turn(1.0, |state| state.at(Site::A).from_tip() > Some(5e-3));
    assert!(drive.turn(-1.0, |state| matches!(state.at(Site::A), Passage::Track(_))));
    drive.tick(drive.angle - 0.1);
    let mut most = 0.0_f32;
    while drive.state.at(Site::A).from_tip().is_none_or(|inside| inside < 4e-3) {
        let grip = drive.tick(drive.angle + 1e-3);
        most = most.max(grip.force.norm());
        assert!(drive.angle < 1.5);
    }
    eprintln!("again through the track: {most:.3} N at most");
    assert_eq!(drive.punctures.len(), 1);
    assert!(most < 0.3 * F0[0], "{most} N");
}

/// Frick et al. 2001: force against way has a peak where the needle enters and a lower one where it comes out, and little between.
#[test]
fn force_over_the_way_has_two_peaks() {
    let mut drive = Drive::new(&[Effect::Puncture, Effect::Stiffening]);
    let (mut curve, mut breaks) = (Vec::new(), Vec::new());
    drive.sew(|drive, grip| {
        curve.push(along(drive, grip));
        breaks.extend(grip.puncture.map(|_| curve.len() - 1));
    });
    let [first, second] = breaks[..] else {
        panic!("{breaks:?}")
    };
    let most = |part: &[f32]| part.iter().copied().fold(0.0, f32::max);
    let (into, out) = (most(&curve[..=first]), most(&curve[first + 300..=second]));
    let least = curve[first..second].iter().copied().fold(f32::INFINITY, f32::min);
    let after = most(&curve[second + 20..]);
    eprintln!("peaks {into:.3} and {out:.3} N, {least:.3} N between, {after:.3} N after");
    assert!((into / F0[0] - 1.0).abs() < 0.05 && (out / F0[3] - 1.0).abs() < 0.05);
    assert!(least.abs() < 0.1 * out && after < 0.1 * out);
}

/// The drop at F0 through the output edge: by no more than the slew a tick, and what the observer has absorbed does not shrink.
#[test]
fn the_drop_gives_no_energy() {
    let mut drive = Drive::new(&[Effect::Puncture, Effect::ShaftFriction, Effect::Stiffening]);
    let edge = safety::Params {
        scale: 1.0,
        slew: 0.2,
        damping: Some(0.0),
        max: 8.5,
    };
    let mut state = safety::State::default();
    let (mut sent, mut since) = (0.0_f32, None);
    let mut least = f32::INFINITY;
    // Straight along the needle, for the observer knows no work of turning.
    let entry = (HEIGHT / RADIUS).asin() - 0.02;
    let way = Vec3::new(entry.sin(), 0.0, -entry.cos());
    for tick in 0..600 {
        let at = moved(pose(entry), way * (8e-6 * tick.min(400) as f32), Vec3::zeros());
        let grip = drive.hold(at);
        let inputs = safety::Inputs {
            simulated: grip.force,
            tip: at.position,
            faults: Default::default(),
            gate: safety::Gate::Open,
        };
        let record = safety::limit(&edge, &mut state, &inputs);
        let force = record.force.get().norm();
        assert!((force - sent).abs() <= 0.2 + 1e-6);
        sent = force;
        if let Some(energy) = since {
            least = least.min(state.energy - energy);
        } else if grip.puncture.is_some() {
            since = Some(state.energy);
        }
    }
    eprintln!("energy since the puncture: {least:.2e} J at least");
    assert!(since.is_some() && least >= -1e-9, "{least} J");
}

/// Skin that is stretched by 10 % all over has the strain 0.1 where the needle meets it, so F0 is 1.2 times as large with a gain of 2.
#[test]
fn stretched_skin_is_harder_to_puncture() {
    for (effects, f0) in [
        (&[Effect::Puncture, Effect::SkinTension][..], 1.2 * F0[0]),
        (&[Effect::Puncture][..], F0[0]),
    ] {
        let mut drive = Drive::new(effects);
        drive.block.impose(|[x, y, _]| [0.1 * x, 0.1 * y, 0.0]);
        while drive.state.sites[0] == Passage::Ahead {
            let angle = drive.angle + 1e-3;
            drive.angle = angle;
            let arc = Arc::new(drive.params.tool, pose(angle));
            let body = Body {
                lattice: &drive.block.lattice,
                tissue: &drive.block.tissue,
                faces: None,
            };
            needle::detect(&drive.params, &mut drive.state, &arc, &body);
        }
        let Passage::Touch(touch) = drive.state.sites[0] else {
            panic!("{:?}", drive.state.sites[0])
        };
        assert!((touch.f0.unwrap() / f0 - 1.0).abs() < 1e-5, "{:?}", touch.f0);
    }
}

/// Work of the hand [J] over turns to and fro by `swing` [rad] in the hole, the last `cycles` of them.
fn work_of_swinging(effects: &[Effect], swing: f32, cycles: u32) -> f64 {
    let mut drive = Drive::new(effects);
    assert!(drive.turn(1.0, in_hole));
    for _ in 0..600 {
        drive.tick(drive.angle + 1e-3);
    }
    let middle = drive.angle;
    let period = 1000;
    let mut work = 0.0;
    let mut last: Option<(f64, f64)> = None;
    for tick in 0..=period * (cycles + 2) {
        let turned = sine(2.0 * PI * (tick % period) as f32 / period as f32);
        let grip = drive.tick(middle + swing * turned);
        // The needle turns about −y through the arc's centre.
        let lever = pose(drive.angle).position - Vec3::z() * HEIGHT;
        let now = (
            f64::from(drive.angle),
            f64::from((grip.torque + lever.cross(&grip.force)).y),
        );
        if let Some((angle, torque)) = last.filter(|_| tick > 2 * period) {
            work += 0.5 * (torque + now.1) * (now.0 - angle);
        }
        last = Some(now);
    }
    work
}

/// To and fro through the same angle, the hand only ever pays: twice the swing times the two directions' friction, which is f L either way
/// in a track that is cut, less the play of the adhesion.
#[test]
fn friction_costs_the_hand_work() {
    let rubbing = [Effect::Puncture, Effect::ShaftFriction, Effect::Stiffening];
    let cycles = 3;
    let paid = work_of_swinging(&rubbing, 0.2, cycles) / f64::from(cycles);
    let free = work_of_swinging(&rubbing[..1], 0.2, cycles) / f64::from(cycles);
    let length = 0.6 * f64::from(RADIUS);
    let [per_length, _] = FRICTION.map(f64::from);
    let whole = 2.0 * 0.2 * f64::from(RADIUS) * 2.0 * per_length * length;
    eprintln!("work a cycle: {paid:.3e} J of at most {whole:.3e} J; without friction {free:.3e} J");
    assert!(free > -1e-3 * whole, "{free} J");
    assert!(paid > 0.5 * whole && paid < 1.1 * whole + free, "{paid} J of {whole} J");
}

/// A swing shorter than the adhesion's reach stays elastic: it neither pays nor gains.
#[test]
fn a_swing_within_adhesion_gains_nothing() {
    let rubbing = [Effect::Puncture, Effect::ShaftFriction, Effect::Stiffening];
    let work = work_of_swinging(&rubbing, 1e-3, 5);
    eprintln!("work of a small swing: {work:.3e} J");
    assert!(work > -1e-9, "{work} J");
}
