//! What the wound's edges may suffer, from a tool and from the thread.

use sutura_controller::math::{Mat3, Pose, Vec3};

use super::circle::Circle;
use super::patch::{BALL_M, sewn, stroked};
use super::run::Run;
use crate::study::stability::bench::memory;
use crate::study::stability::case::{Attempt, Case, Unfinished};
use crate::study::stability::watch::Trace;

/// Turns of the needle from before the left puncture to behind the right one, its swage out [rad].
const STITCH: [f32; 2] = [-0.5, 5.2];
/// Speed of its tip on the way [m/s].
const DRIVEN: f32 = 0.05;
/// Where the thread is drawn to, from the right puncture.
const AWAY: Vec3 = Vec3::new(-0.6, 0.0, 0.8);
/// What is slack again, from where the thread was taut [m].
const SLACK: f32 = 0.04;

/// All of them.
pub(super) fn cases() -> Vec<Case> {
    let case = |name: &str, what: &str, run: fn(&Attempt<'_>) -> Result<Trace, Unfinished>| Case {
        name: name.to_owned(),
        what: what.to_owned(),
        equilibrium: None,
        run: Box::new(run),
    };
    vec![
        case(
            "thread-taut",
            "the thread goes taut at 1 m/s, is drawn 10 mm further and let go after half a second",
            |attempt| drawn(attempt, 10e-3, 1.0),
        ),
        case(
            "edges-crossed:thread",
            "the taut thread is drawn 25 mm further, which pulls the wound's edges through each other if nothing holds them",
            |attempt| drawn(attempt, 25e-3, 0.1),
        ),
        case(
            "edges-crossed:tool",
            "a ball drags the left edge of the wound 12 mm over the right one and springs off",
            dragged,
        ),
    ]
}

/// Sews through both punctures, and draws the thread `beyond` taut [m] at `speed` [m/s].
fn drawn(attempt: &Attempt<'_>, beyond: f32, speed: f32) -> Result<Trace, Unfinished> {
    let scene = sewn(attempt)?;
    let circle = Circle::of(&scene.0);
    let half = scene.0.stitch.map_or(0.0, |stitch| -stitch.a_m[0]);
    let length = scene
        .0
        .thread
        .map_or(0.0, |thread| thread.link_m * f32::from(thread.nodes - 1));
    let mut memory = memory();
    let mut run = Run::new(*attempt, &mut memory, &scene, circle.at(STITCH[0]))?;
    run.turn(&circle, STITCH, DRIVEN)?;
    let at = |way: f32| Vec3::x() * half + AWAY * (length - 2.0 * half + way);
    run.go(at(-SLACK), 1.0)?;
    run.go(at(beyond), speed)?;
    run.wait(500)?;
    run.go(at(-SLACK), 2.0)?;
    run.rest()
}

fn dragged(attempt: &Attempt<'_>) -> Result<Trace, Unfinished> {
    let scene = stroked(attempt)?;
    let at = |x: f32, z: f32| Vec3::new(x, 0.0, z + BALL_M);
    let above = Pose {
        position: at(-3.5e-3, 1e-3),
        rotation: Mat3::identity(),
    };
    let mut memory = memory();
    let mut run = Run::new(*attempt, &mut memory, &scene, above)?;
    run.go(at(-3.5e-3, -2e-3), 0.1)?;
    run.go(at(8.5e-3, -2e-3), 0.2)?;
    run.wait(500)?;
    run.jump(Vec3::z() * 30e-3);
    // In one tick the ball is off the skin, which has yet to follow.
    run.wait(2)?;
    run.rest()
}
