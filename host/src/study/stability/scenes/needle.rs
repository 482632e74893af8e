//! What a needle may do.

use std::f32::consts::TAU;

use sutura_controller::math::Vec3;

use super::circle::Circle;
use super::patch::sewn;
use super::run::Run;
use crate::study::stability::bench::memory;
use crate::study::stability::case::{Attempt, Case, Unfinished};
use crate::study::stability::watch::Trace;

/// Tip before the skin, and where it is deep in the tissue, as turns from the left puncture [rad].
const OUT: f32 = -0.8;
const DEEP: f32 = 0.9;
/// Tip in the wound, behind a and b.
const ACROSS: f32 = 0.5;
/// Speed of the tip where nothing is to be hard [m/s].
const GENTLE: f32 = 0.02;

/// All of them.
pub(super) fn cases() -> Vec<Case> {
    let ways = [
        ("across", Vec3::x()),
        ("back", -Vec3::x()),
        ("along", Vec3::y()),
        ("up", Vec3::z()),
        ("down", -Vec3::z()),
    ];
    let teleported = ways.map(|(name, way)| Case {
        name: format!("hand-teleported:{name}"),
        what: format!(
            "with the needle in the skin the hand jumps 20 mm {name} for 50 ms and back, and then draws it out"
        ),
        equilibrium: None,
        run: Box::new(move |attempt| teleport(attempt, way * 20e-3)),
    });
    let puncture = Case {
        name: "puncture".to_owned(),
        what: "the needle is thrust through the skin at 0.5 m/s, stays for a second and is torn out as fast".to_owned(),
        equilibrium: None,
        run: Box::new(puncture),
    };
    let others = [
        case(
            "needle-reversed",
            "the needle turns to and fro in the tissue at 10 Hz, by 0.1 mm, where it sticks, and then by 1 mm, and is drawn out",
            reversed,
        ),
        case(
            "punctures-near",
            "the needle goes through skin and wound face one voxel apart; the hand jumps 1 mm to each side for 50 ms and back",
            near,
        ),
        case(
            "needle-tangential",
            "the needle goes through the skin along the skin, at most 0.5 mm deep, out and back",
            tangential,
        ),
    ];
    teleported.into_iter().chain([puncture]).chain(others).collect()
}

fn case(name: &str, what: &str, run: fn(&Attempt<'_>) -> Result<Trace, Unfinished>) -> Case {
    Case {
        name: name.to_owned(),
        what: what.to_owned(),
        equilibrium: None,
        run: Box::new(run),
    }
}

/// Turns about `from` by a swing of this way of the tip [m], for a second.
fn swing(run: &mut Run<'_>, circle: &Circle, from: f32, way: f32) -> Result<(), Unfinished> {
    (1..=1000_u32).try_for_each(|tick| {
        let part = (TAU * (tick % 100) as f32 / 100.0).sin();
        run.tick(circle.at(from + circle.turn(way * part))).map(drop)
    })
}

fn reversed(attempt: &Attempt<'_>) -> Result<Trace, Unfinished> {
    let scene = sewn(attempt)?;
    let circle = Circle::of(&scene.0);
    let mut memory = memory();
    let mut run = Run::new(*attempt, &mut memory, &scene, circle.at(OUT))?;
    run.turn(&circle, [OUT, DEEP], GENTLE)?;
    swing(&mut run, &circle, DEEP, 0.1e-3)?;
    swing(&mut run, &circle, DEEP, 1e-3)?;
    run.turn(&circle, [DEEP, OUT], GENTLE)?;
    run.rest()
}

fn near(attempt: &Attempt<'_>) -> Result<Trace, Unfinished> {
    let mut scene = sewn(attempt)?;
    let apart = scene.0.lattice.pitch_m;
    let face = scene.0.wound.map_or(0.0, |wound| {
        let [origin, ..] = scene.0.lattice.origin_m;
        origin + f32::from(wound.faces[0]) * apart
    });
    if let Some(stitch) = &mut scene.0.stitch {
        stitch.a_m[0] = face - apart;
    }
    let circle = Circle::of(&scene.0);
    let mut memory = memory();
    let mut run = Run::new(*attempt, &mut memory, &scene, circle.at(OUT))?;
    run.turn(&circle, [OUT, ACROSS], GENTLE)?;
    for way in [Vec3::x(), Vec3::y(), Vec3::z()] {
        for far in [way * 1e-3, way * -1e-3] {
            run.jump(far);
            run.wait(50)?;
            run.jump(-far);
            run.wait(50)?;
        }
    }
    run.turn(&circle, [ACROSS, OUT], GENTLE)?;
    run.rest()
}

fn tangential(attempt: &Attempt<'_>) -> Result<Trace, Unfinished> {
    let scene = sewn(attempt)?;
    // R − √(R² − 2.8²) is 0.5 mm with R = 8.3 mm.
    let circle = Circle::through(&scene.0, [-9.8e-3, -4.2e-3]);
    let mut memory = memory();
    let mut run = Run::new(*attempt, &mut memory, &scene, circle.at(OUT))?;
    run.turn(&circle, [OUT, 2.0 * DEEP], GENTLE)?;
    run.wait(100)?;
    run.turn(&circle, [2.0 * DEEP, OUT], GENTLE)?;
    run.rest()
}

fn teleport(attempt: &Attempt<'_>, far: Vec3) -> Result<Trace, Unfinished> {
    let scene = sewn(attempt)?;
    let circle = Circle::of(&scene.0);
    let mut memory = memory();
    let mut run = Run::new(*attempt, &mut memory, &scene, circle.at(OUT))?;
    run.turn(&circle, [OUT, DEEP], GENTLE)?;
    run.wait(100)?;
    run.jump(far);
    run.wait(50)?;
    run.jump(-far);
    run.wait(20)?;
    run.turn(&circle, [DEEP, OUT], GENTLE)?;
    run.rest()
}

fn puncture(attempt: &Attempt<'_>) -> Result<Trace, Unfinished> {
    let scene = sewn(attempt)?;
    let circle = Circle::of(&scene.0);
    let mut memory = memory();
    let mut run = Run::new(*attempt, &mut memory, &scene, circle.at(OUT))?;
    run.turn(&circle, [OUT, DEEP], 0.5)?;
    run.wait(1000)?;
    run.turn(&circle, [DEEP, OUT], 0.5)?;
    run.rest()
}
