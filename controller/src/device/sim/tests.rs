use super::*;
use crate::math::length;
use crate::record::Faults;
use crate::safety::{self, Gate};
use sutura_shared::scene::{Motion, Profile, Until};

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
        tremor: None,
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
    damping: None,
    max: 100.0,
};

fn output(rendered: safety::LimitedForce) -> Output {
    Output {
        tick: 1,
        rendered,
        ..Output::idle()
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

fn line(to: [f32; 3], ticks: u32) -> Step {
    Step {
        motion: Motion::Line { to: pose(to) },
        ticks,
        until: Until::Elapsed,
        button: false,
    }
}

/// The limits a scene sets.
const EDGE: safety::Params = safety::Params {
    scale: 1.0,
    slew: 0.5,
    damping: Some(5.0),
    max: 8.5,
};

/// What a hold on a wall felt like.
struct Hold {
    /// Root mean square of the wall's force above 20 Hz [N].
    buzz: f64,
    /// Whether the edge held the force back or shortened it.
    limited: bool,
}

/// A hand with tremor (0.2 mm, 10 Hz) presses 20 mm into the wall, or a lone arm is pushed by 1 ± 0.3 N, for 3 s.
fn press(hand: &scene::Hand, wall: &Wall, edge: &safety::Params) -> Hold {
    let grip = hand::Params {
        mass: hand.mass_kg,
        damping: hand.damping_n_s_per_m,
        stiffness: hand.stiffness_n_per_m,
    };
    let tremor = |tick: u16| libm::sinf(core::f32::consts::TAU * 10.0 * DT * f32::from(tick));
    let target = |tick| wall.normal * (0.01 - 0.03 * (f32::from(tick) / 500.0).min(1.0) + 2e-4 * tremor(tick));
    let mut arm = dynamics::State {
        angle: kinematics::inverse(target(0)).unwrap(),
        rate: Vec3::zeros(),
    };
    let mut state = safety::State::default();
    let (mut held, mut last, mut limited) = (Vec3::zeros(), target(0), false);
    let mut forces = std::vec::Vec::new();
    for tick in 0..3000 {
        let tip = Posture::at(encoder::joints(arm.angle)).tip();
        let mut simulated = wall.force(tip, (tip - last) / DT);
        forces.push(f64::from(simulated.dot(&wall.normal)));
        if grip.mass <= 0.0 {
            simulated -= wall.normal * (1.0 + 0.3 * tremor(tick));
        }
        let inputs = safety::Inputs {
            simulated,
            tip,
            faults: Faults::default(),
            gate: Gate::Open,
        };
        let record = safety::limit(edge, &mut state, &inputs);
        limited |= record.slewed || record.saturated;
        let now = record.force.get();
        let from = target(tick);
        hold(
            &grip,
            &mut arm,
            if wall.late { held } else { now },
            from,
            target(tick + 1) - from,
        );
        (held, last) = (now, tip);
    }
    Hold {
        buzz: above_20_hz(&forces[2000..]),
        limited,
    }
}

/// Root mean square of the part above 20 Hz of one second of samples, by its Fourier sums (Parseval).
fn above_20_hz(samples: &[f64]) -> f64 {
    let power = |frequency: usize| {
        let (mut cos, mut sin) = (0.0, 0.0);
        for (i, x) in samples.iter().enumerate() {
            let angle = core::f64::consts::TAU * (frequency * i) as f64 / 1000.0;
            cos += x * angle.cos();
            sin += x * angle.sin();
        }
        2.0 * (cos * cos + sin * sin) / 1e6
    };
    (21..500).map(power).sum::<f64>().sqrt()
}

fn walls(stiffness: f32, damping: f32) -> impl Iterator<Item = Wall> {
    [Vec3::x(), Vec3::y(), Vec3::z()].into_iter().flat_map(move |normal| {
        [false, true].map(|late| Wall {
            stiffness,
            damping,
            normal,
            late,
        })
    })
}

#[test]
fn the_recommended_coupling_does_not_buzz_in_any_hand() {
    // Below 0.05 N above 20 Hz in a hold with tremor, with K_c = 800 N/m and B_c = 1 N·s/m, also with a tick's delay.
    for wall in walls(800.0, 1.0) {
        for hand in [weakest(), nominal(), nobody()] {
            let hold = press(&hand, &wall, &EDGE);
            assert!(hold.buzz < 0.05, "{} {} kg: {} N", wall.normal, hand.mass_kg, hold.buzz);
            // A lone arm falls onto the wall; a hand must not meet the limits.
            assert!(
                hand.mass_kg <= 0.0 || !hold.limited,
                "{} {} kg",
                wall.normal,
                hand.mass_kg
            );
        }
    }
}

#[test]
fn a_wall_beyond_the_passive_bound_buzzes_until_passivity_control_acts() {
    // Colgate & Schenkel 1997: passive needs b > K T/2; a lone arm has 0.015 N·s/m, so only friction holds 800 N/m, if at all.
    let worst = |edge| {
        walls(800.0, 0.0)
            .map(|wall| press(&nobody(), &Wall { late: true, ..wall }, edge).buzz)
            .fold(0.0, f64::max)
    };
    assert!(worst(&OPEN) > 0.5);
    assert!(worst(&EDGE) < 0.05);
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

/// A hand of 100 kN/m on some 0.1 kg has its resonance at 160 Hz: at 2 Hz the tip follows within (2/160)², and stiction hides 0.06 N over it, 0.6 µm.
#[test]
fn the_tip_trembles_along_the_patchs_axes() {
    let half = core::f32::consts::FRAC_1_SQRT_2;
    let mut device = device();
    // Patch x, y, z are the device's x, −z, y.
    device.patch_from_device.quaternion = [half, half, 0.0, 0.0];
    let mut hand = nominal();
    (hand.stiffness_n_per_m, hand.damping_n_s_per_m) = (1e5, 100.0);
    hand.tremor = Some(Tremor {
        amplitude_m: 1e-3,
        frequency_hz: 2.0,
        phases_rad: [0.0, 1.0, 2.0],
    });
    let mut arm = Simulated::new(&device, &hand).unwrap();
    for tick in 1..=1500_u32 {
        arm.actuate(&Output {
            tick,
            ..output(safety::LimitedForce::default())
        });
        let angle = core::f32::consts::TAU * 2.0 * (tick as f32 * 1e-3);
        let [x, y, z] = [0.0, 1.0, 2.0].map(|phase| 1e-3 * libm::sinf(angle + phase));
        let off = length(arm.tip() - Vec3::new(x, z, -y));
        assert!(tick < 200 || off < 10e-6, "{tick}: {off}");
    }
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
fn everywhere_the_refusal_recommends_is_in_reach() {
    let mut hand = nominal();
    for turn in [0, 1, 2, 3, 4, 5, 6, 7].map(|i| i as f32 * core::f32::consts::FRAC_PI_4) {
        for lift in [-1.0, -0.5, 0.0, 0.5, 1.0_f32] {
            let level = (1.0 - lift * lift).sqrt();
            hand.start = pose([level * turn.sin(), lift, level * turn.cos()].map(|x| 0.06 * x));
            assert!(Simulated::new(&device(), &hand).is_ok(), "{:?}", hand.start);
        }
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
    assert_eq!(before.len(), 4 + 6 + 14);
    assert_ne!(before, after);
}
