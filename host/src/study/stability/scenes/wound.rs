//! What the wound's edges may suffer, from a tool and from the thread.

use sutura_controller::math::{Mat3, Pose, Vec3};

use super::patch::{BALL_M, sewn, stroked};
use super::run::Run;
use super::thread::drawn;
use crate::study::stability::bench::memory;
use crate::study::stability::case::{Attempt, Case, Unfinished};
use crate::study::stability::watch::Trace;

/// All of them.
pub(super) fn cases() -> Vec<Case> {
    vec![
        Case::new(
            "edges-crossed:thread",
            "the taut thread is drawn 25 mm further, which pulls the wound's edges through each other if nothing holds them",
            |attempt| drawn(attempt, &sewn(attempt)?, [25e-3, 0.1]),
        ),
        Case::new(
            "edges-crossed:tool",
            "a ball drags the left edge of the wound 12 mm over the right one and springs off",
            dragged,
        ),
    ]
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
