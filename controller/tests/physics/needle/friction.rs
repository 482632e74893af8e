//! What the shaft's friction and the cutting tip cost the hand, and what they do not.

use super::{Drive, F0, FRICTION, HEIGHT, PI, RADIUS, along, in_hole, pose, sine};
use sutura_controller::math::Vec3;
use sutura_controller::needle::Passage;
use sutura_shared::scene::{Effect, Site};

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
