//! The needle at its sites: in, back, through, and what its friction costs the hand.

mod arc;
mod friction;
mod peaks;

use super::block::{Block, DEFAULT, PITCH, scene, stiffening};
use nalgebra::Vector3;
use std::f32::consts::PI;
use sutura_controller::coupling::Coupling;
use sutura_controller::event::Puncture;
use sutura_controller::math::{Mat3, Pose, Vec3};
use sutura_controller::needle::{self, Arc, Body, Grip, Params, Passage, State};
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

/// A pose shifted, and turned about its own origin by a rotation vector.
fn moved(pose: Pose, way: Vec3, turn: Vec3) -> Pose {
    let angle = turn.norm();
    let axis = if angle > 0.0 { turn / angle } else { Vec3::x() };
    Pose {
        position: pose.position + way,
        rotation: sutura_controller::math::rotation(axis, angle) * pose.rotation,
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

    /// One layer of skin over muscle, with a wound between the sites down to layer `floor` of nodes.
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
        let tissue = |n: usize| if n / nx / ny == 4 { 1 } else { 2 };
        let cell = |n: usize| if missing(n) { 0 } else { tissue(n) };
        let cells: Vec<u8> = (0..scene.lattice.count()).map(cell).collect();
        let block = Block::new(&scene, &cells);
        let faces = wound::faces(scene.wound.as_ref().unwrap(), None, &block.lattice).unwrap();
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
            let grip = self.tick(self.angle + 5e-4);
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
    let muscle = stiffening(&[(0.0, 26e3), (0.1, 43e3), (0.2, 70e3), (0.3, 117e3), (0.4, 192e3)]);
    let mut scene = scene([15, 8, 5], Law::Isotropic, &[skin, muscle], effects);
    scene.lattice.damping_per_s = 50.0;
    scene.tool = Tool::Needle {
        radius_m: RADIUS,
        length_m: LENGTH,
        grasp_m: LENGTH / 3.0,
    };
    scene.contact.kernel_m = 1.5 * PITCH;
    scene.stitch = Some(Stitch {
        count: 1,
        spacing_m: 0.0,
        a_m: [-RADIUS, 0.0],
        f0_n: F0,
        under_m: 2e-3,
        friction_n_per_m: FRICTION[0],
        cutting_n: FRICTION[1],
        tension_gain: 2.0,
    });
    scene
}

/// Force along the needle that resists its advance [N]: the torque about the arc's own centre over R, where what acts across has no lever.
fn along(drive: &Drive, grip: &Grip) -> f32 {
    let lever = pose(drive.angle).position - Vec3::z() * HEIGHT;
    (grip.torque + lever.cross(&grip.force)).y / RADIUS
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
