//! What a needle may do.

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
    teleported.into_iter().chain([puncture]).collect()
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
