use super::*;
use crate::math::length;
use crate::record::Faults;
use crate::safety::{self, Gate};
use sutura_shared::scene::{Motion, Profile, Stage, Until};

fn pose(position_m: [f32; 3]) -> scene::Pose {
    scene::Pose {
        position_m,
        quaternion: [1.0, 0.0, 0.0, 0.0],
    }
}

fn device() -> scene::Device {
    scene::Device {
        profile: Profile::Premium15,
        patch_from_device: pose([0.0; 3]),
    }
}

fn weakest() -> scene::Hand {
    scene::Hand {
        mass_kg: 0.1,
        damping_n_s_per_m: 2.0,
        stiffness_n_per_m: 100.0,
        start: pose([0.0; 3]),
        steps: Vec::new(),
    }
}

fn nominal() -> scene::Hand {
    scene::Hand {
        mass_kg: 0.2,
        damping_n_s_per_m: 5.0,
        stiffness_n_per_m: 400.0,
        ..weakest()
    }
}

fn nobody() -> scene::Hand {
    scene::Hand {
        mass_kg: 0.0,
        damping_n_s_per_m: 0.0,
        stiffness_n_per_m: 0.0,
        ..weakest()
    }
}

/// An edge that lets every force of the arm through at once.
const OPEN: safety::Params = safety::Params {
    scale: 1.0,
    slew: 100.0,
    damping: 0.0,
    max: 100.0,
};

fn output(rendered: safety::LimitedForce) -> Output {
    Output {
        tick: 1,
        stage: Stage::Approach,
        faults: Faults::default(),
        simulated: Vec3::zeros(),
        rendered,
        torque: Vec3::zeros(),
        position: Vec3::zeros(),
        thread: 0.0,
        gap: 0.0,
        gap_mean: 0.0,
        saturated: false,
        puncture: None,
    }
}

/// A wall across the neutral pose.
struct Wall {
    stiffness: f32,
    damping: f32,
    normal: Vec3,
    /// Whether the force reaches the motors a tick late.
    late: bool,
}

impl Wall {
    fn force(&self, tip: Vec3, speed: Vec3) -> Vec3 {
        let depth = -tip.dot(&self.normal);
        if depth > 0.0 {
            self.normal * (self.stiffness * depth - self.damping * speed.dot(&self.normal))
        } else {
            Vec3::zeros()
        }
    }
}

/// `hand` presses 20 mm into the wall, or a lone arm is pushed by 1 N, for 4 s: the tip's way in the last second [m].
fn swing(mut hand: scene::Hand, wall: &Wall) -> f32 {
    let push = if hand.mass_kg > 0.0 {
        Vec3::zeros()
    } else {
        -wall.normal
    };
    hand.start = pose((wall.normal * 0.01).into());
    hand.steps = Vec::from_slice(&[line((wall.normal * -0.02).into(), 500)]).unwrap();
    let mut arm = Simulated::new(&device(), &hand).unwrap();
    let mut edge = safety::State::default();
    let mut held = safety::LimitedForce::default();
    let mut last = arm.sense().pose.position;
    let (mut low, mut high) = (f32::MAX, f32::MIN);
    for tick in 0..4000 {
        let tip = arm.sense().pose.position;
        let simulated = wall.force(tip, (tip - last) / DT) + push;
        last = tip;
        let inputs = safety::Inputs {
            simulated,
            tip,
            faults: Faults::default(),
            gate: Gate::Open,
        };
        let force = safety::limit(&OPEN, &mut edge, &inputs).force;
        arm.actuate(&output(if wall.late { held } else { force }));
        held = force;
        if tick >= 3000 {
            let height = arm.tip().dot(&wall.normal);
            (low, high) = (low.min(height), high.max(height));
        }
    }
    high - low
}

fn line(to: [f32; 3], ticks: u32) -> Step {
    Step {
        motion: Motion::Line { to: pose(to) },
        ticks,
        until: Until::Elapsed,
        button: false,
    }
}

/// Two counts of an encoder at the tip.
const COUNTS: f32 = 60e-6;

#[test]
fn the_recommended_coupling_rests_on_a_wall_in_every_hand() {
    for hand in [weakest(), nominal(), nobody()] {
        for (normal, late) in [Vec3::x(), Vec3::y(), Vec3::z()]
            .iter()
            .flat_map(|n| [(*n, false), (*n, true)])
        {
            let wall = Wall {
                stiffness: 800.0,
                damping: 1.0,
                normal,
                late,
            };
            let swing = swing(hand.clone(), &wall);
            assert!(swing < COUNTS, "{normal} {late} {} kg: {swing} m", hand.mass_kg);
        }
    }
}

#[test]
fn a_wall_beyond_any_passive_bound_does_shake() {
    // Colgate & Schenkel 1997: K < 2 b / T = 4 kN/m for b = 2 N·s/m, sampled without further delay.
    let wall = Wall {
        stiffness: 20_000.0,
        damping: 0.0,
        normal: Vec3::y(),
        late: true,
    };
    assert!(swing(weakest(), &wall) > 10.0 * COUNTS);
}

#[test]
fn the_hand_carries_the_arm_along_the_script() {
    let mut hand = nominal();
    hand.steps = Vec::from_slice(&[line([0.05, 0.03, -0.04], 800), line([0.0; 3], 800)]).unwrap();
    hand.steps[1].button = true;
    let mut arm = Simulated::new(&device(), &hand).unwrap();
    for tick in 0..800 {
        assert!(!arm.sense().button && !arm.script_done(), "{tick}");
        arm.actuate(&output(safety::LimitedForce::default()));
    }
    for _ in 0..400 {
        arm.actuate(&output(safety::LimitedForce::default()));
        assert!(arm.sense().button);
    }
    for _ in 0..1000 {
        arm.actuate(&output(safety::LimitedForce::default()));
    }
    assert!(arm.script_done());
    // The arm's weight, 16.3 mN·m over l1, stretches the hand by 0.2 mm; stiction of 0.01 N·m hides as much.
    let tip = arm.tip();
    assert!(length(tip) < 0.5e-3, "{tip}");
    assert!(length(arm.sense().pose.position - tip) < 40e-6);
}

#[test]
fn the_script_is_in_the_patch_frame() {
    let half = core::f32::consts::FRAC_1_SQRT_2;
    let mut device = device();
    // Patch x, y, z are the device's x, −z, y.
    device.patch_from_device = scene::Pose {
        position_m: [0.01, 0.02, 0.03],
        quaternion: [half, half, 0.0, 0.0],
    };
    let mut hand = nominal();
    hand.start = pose([0.02, 0.02, 0.05]);
    let mut arm = Simulated::new(&device, &hand).unwrap();
    assert!(length(arm.tip() - Vec3::new(0.01, 0.02, 0.0)) < 1e-6);
    let patch_from_stylus = Pose::from(device.patch_from_device).then(&arm.sense().pose);
    assert!((patch_from_stylus.rotation - crate::math::Mat3::identity()).abs().max() < 5e-3);
}

#[test]
fn the_hand_feels_the_rendered_force() {
    // At rest the spring carries it: x = F/k, within the stiction of 0.01 N·m over 0.17 m.
    let mut hand = nominal();
    hand.stiffness_n_per_m = 200.0;
    let mut arm = Simulated::new(&device(), &hand).unwrap();
    for force in [Vec3::x(), -Vec3::x()] {
        let mut edge = safety::State::default();
        for _ in 0..2000 {
            let tip = arm.sense().pose.position;
            let inputs = safety::Inputs {
                simulated: force,
                tip,
                faults: Faults::default(),
                gate: Gate::Open,
            };
            arm.actuate(&output(safety::limit(&OPEN, &mut edge, &inputs).force));
        }
        assert!(
            (arm.tip().dot(&force) - 1.0 / 200.0).abs() < 0.06 / 200.0,
            "{}",
            arm.tip()
        );
    }
}

#[test]
fn pushing_past_the_workspace_stays_bounded() {
    let mut hand = nominal();
    hand.stiffness_n_per_m = 800.0;
    hand.steps = Vec::from_slice(&[line([0.3, 0.5, 0.4], 300), line([-0.3, -0.3, -0.5], 300)]).unwrap();
    let mut arm = Simulated::new(&device(), &hand).unwrap();
    for _ in 0..3000 {
        arm.actuate(&output(safety::LimitedForce::default()));
        let pose = arm.sense().pose;
        assert!(finite(pose.position) && length(pose.position) < 0.7);
        // The hand's own way of 1.4 m in 0.3 s peaks at 8.6 m/s, 50 rad/s on the shorter link.
        assert!(length(arm.state().arm.rate) < 100.0, "{:?}", arm.state().arm);
    }
    assert!(length(arm.state().arm.rate) < 5e-3, "at rest against its stops");
}

#[test]
fn a_start_out_of_reach_is_refused_in_one_line() {
    let mut hand = nominal();
    for far in [[0.0, 0.0, 0.3], [f32::NAN, 0.0, 0.0], [0.0, 0.0, -0.4]] {
        hand.start = pose(far);
        let error = Simulated::new(&device(), &hand).unwrap_err();
        assert!(!std::format!("{error}").contains('\n'));
    }
}

#[test]
fn the_words_of_the_state_tell_every_number() {
    let mut hand = nominal();
    hand.steps = Vec::from_slice(&[line([0.01, 0.01, 0.01], 10)]).unwrap();
    let mut arm = Simulated::new(&device(), &hand).unwrap();
    let before: std::vec::Vec<u32> = arm.state().words().collect();
    let twin = arm.clone();
    arm.actuate(&output(safety::LimitedForce::default()));
    let after: std::vec::Vec<u32> = arm.state().words().collect();
    assert_eq!(before, twin.state().words().collect::<std::vec::Vec<_>>());
    assert_eq!(before.len(), 3 + 6 + 14);
    assert_ne!(before, after);
}
