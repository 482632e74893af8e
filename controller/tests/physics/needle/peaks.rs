//! F0: its two peaks, the drop after it, and its growth with the skin's tension.

use super::{Drive, F0, HEIGHT, RADIUS, along, moved, pose};
use sutura_controller::math::Vec3;
use sutura_controller::needle::{self, Arc, Body, Passage};
use sutura_controller::safety;
use sutura_shared::scene::Effect;

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
    let (into, out) = (most(&curve[..=first]), most(&curve[first + 600..=second]));
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
