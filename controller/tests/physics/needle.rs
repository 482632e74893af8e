//! The needle at its two sites: in, back, through, and what its friction costs the hand.

use super::block::{Block, DEFAULT, PITCH, scene, stiffening};
use nalgebra::Vector3;
use std::f32::consts::PI;
use sutura_controller::coupling::Coupling;
use sutura_controller::event::Puncture;
use sutura_controller::math::{Mat3, Pose, Vec3};
use sutura_controller::needle::{self, Arc, Grip, Params, Passage, State};
use sutura_shared::scene::{Effect, Law, Site, Stitch, Tool};

const F0: [f32; 2] = [0.95, 0.665];
/// A half circle of 26 mm.
const LENGTH: f32 = 26e-3;
const RADIUS: f32 = LENGTH / PI;
/// Height of the arc's centre above the skin at rest [m].
const HEIGHT: f32 = 1e-3;
/// Friction per metre [N/m] and cutting force [N].
const FRICTION: [f32; 2] = [20.0, 0.2];

/// Skin, a needle that turns about a fixed centre, and what came of it.
struct Drive {
    block: Block,
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
        let skin = stiffening(&[(0.0, 281e3), (0.3, 1.7e6), (0.6, 3.66e6)]);
        let mut scene = scene([15, 8, 5], Law::Isotropic, &[skin], effects);
        scene.lattice.damping_per_s = 50.0;
        scene.tool = Tool::Needle {
            radius_m: RADIUS,
            length_m: LENGTH,
        };
        scene.contact.kernel_m = 1.5 * PITCH;
        scene.stitch = Some(Stitch {
            left_m: [-RADIUS, 0.0],
            f0_n: F0,
            under_m: 2e-3,
            friction_n_per_m: FRICTION[0],
            cutting_n: FRICTION[1],
        });
        Self {
            block: Block::filled(&scene),
            params: Params::new(&scene),
            state: State::default(),
            angle: -0.1,
            punctures: Vec::new(),
        }
    }

    /// One tick with the needle turned to `angle`.
    fn tick(&mut self, angle: f32) -> Grip {
        self.angle = angle;
        let arc = Arc::new(self.params.tool, pose(angle));
        let block = &mut self.block;
        let mut coupling = Coupling::default();
        needle::detect(&self.params, &mut self.state, &arc, &block.lattice, &block.tissue);
        let holds = needle::couple(&self.params, &mut self.state, &arc, &block.tissue, &mut coupling);
        let moved = block.tick(DEFAULT, &coupling, None);
        let grip = needle::settle(&self.params, &mut self.state, &arc, (&holds, &moved), &block.tissue);
        self.punctures.extend(grip.puncture);
        grip
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

fn in_hole(state: &State) -> bool {
    matches!(state.left, Passage::Hole(_))
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
    assert_eq!(puncture.site, Site::Left);
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
    assert!(drive.turn(-1.0, |state| state.left == Passage::Ahead));
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
    assert!(drive.turn(1.0, |state| matches!(state.right, Passage::Touch(_))));
    assert!(drive.turn(0.3, |state| matches!(state.right, Passage::Hole(_))));
    assert!(drive.turn(1.0, |state| matches!(state.left, Passage::Passed(_))));
    assert!(matches!(drive.state.right, Passage::Hole(_)));
    assert!(drive.turn(1.0, |state| matches!(state.right, Passage::Passed(_))));
    let sites: Vec<_> = drive.punctures.iter().map(|p| p.site).collect();
    assert_eq!(sites, [Site::Left, Site::Right]);
    for (puncture, f0) in drive.punctures.iter().zip(F0) {
        eprintln!("{puncture:?}");
        assert!(puncture.force >= f0 && puncture.force < 1.03 * f0, "{puncture:?}");
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

/// To and fro through the same angle, the hand only ever pays: twice the swing times the two directions' friction, which is
/// f L going back and f L + cutting going forth, less the play of the adhesion.
#[test]
fn friction_costs_the_hand_work() {
    let rubbing = [Effect::Puncture, Effect::ShaftFriction, Effect::Stiffening];
    let cycles = 3;
    let paid = work_of_swinging(&rubbing, 0.2, cycles) / f64::from(cycles);
    let free = work_of_swinging(&rubbing[..1], 0.2, cycles) / f64::from(cycles);
    let length = 0.6 * f64::from(RADIUS);
    let [per_length, cutting] = FRICTION.map(f64::from);
    let whole = 2.0 * 0.2 * f64::from(RADIUS) * (2.0 * per_length * length + cutting);
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
