//! Several punctures at once: on the arc, and no more than the coupling in the hand.

use super::{DEEP, Drive, FLAT, HEIGHT, PI, RADIUS, moved, pose};
use sutura_controller::math::Vec3;
use sutura_controller::needle::Passage;
use sutura_shared::scene::{Effect, Site};

/// The constraint points' distance from the needle's circle over its whole way, from the circle's definition: |ρ − R| in the plane and the
/// height above it. Largest, with one or two punctures and with more; how far the needle turned.
fn strays(mut drive: Drive) -> ([f32; 2], f32) {
    let mut farthest = [0.0_f32; 2];
    drive.sew(|drive, _| {
        let centre = Vec3::z() * HEIGHT + drive.state.offset;
        let holes = drive.state.sites.iter().filter(|site| matches!(site, Passage::Hole(_)));
        let places: Vec<_> = holes
            .map(|hole| hole.point().unwrap().place(&drive.block.tissue))
            .collect();
        for place in &places {
            let arm = place - centre;
            let flat = (arm.x * arm.x + arm.z * arm.z).sqrt() - RADIUS;
            let most = &mut farthest[usize::from(places.len() > 2)];
            *most = most.max((flat * flat + arm.y * arm.y).sqrt());
        }
    });
    (farthest, drive.angle)
}

/// One or two punctures leave the needle free to lie on all of them. More than that have to give way to the turn that the hand gives it.
#[test]
fn constraint_points_stay_on_the_arc_over_half_a_turn() {
    let effects = [Effect::Puncture, Effect::ShaftFriction, Effect::Stiffening];
    let ([few, _], turned) = strays(Drive::wounded(&effects, FLAT));
    eprintln!("a and d: {few:.2e} m from the arc at most");
    assert!(turned > PI && few <= 10e-6, "{few} m");
    let ([few, many], turned) = strays(Drive::wounded(&effects, DEEP));
    eprintln!("a to d: {few:.2e} m with up to two held, {many:.2e} m with more");
    assert!(turned > PI && few <= 10e-6 && many <= 100e-6, "{few} m, {many} m");
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
