//! What an arm with encoders in a hand may do: tremble, lose ticks, and press on what is as hard as the coupling.

use sutura_controller::device::sim::{BEARS, hand};
use sutura_controller::math::{Mat3, Pose, Vec3};
use sutura_shared::scene::Scene;

use super::arm::{Fate, Held, Latency};
use super::patch::{BALL_M, bony, stroked};
use super::run::Run;
use crate::study::stability::bench::memory;
use crate::study::stability::case::{Attempt, Case, Unfinished};
use crate::study::stability::watch::Trace;

/// Hands from weak to firm (0.1–0.5 kg, 2–10 N·s/m, 100–800 N/m).
const HANDS: [(&str, hand::Params); 2] = [
    (
        "weak",
        hand::Params {
            mass: 0.1,
            damping: 2.0,
            stiffness: 100.0,
        },
    ),
    (
        "firm",
        hand::Params {
            mass: 0.5,
            damping: 10.0,
            stiffness: 800.0,
        },
    ),
];
/// Where tremor goes: along the skin and into it.
const SHAKE: Vec3 = Vec3::new(0.6, 0.0, 0.8);

/// All of them.
pub(super) fn cases() -> Vec<Case> {
    let each = |name: &str, what: &str, run: fn(&Attempt<'_>, hand::Params) -> Result<Trace, Unfinished>| {
        HANDS.map(|(hand, params)| Case {
            name: format!("{name}:{hand}"),
            what: format!("{what} ({hand} hand)"),
            equilibrium: None,
            run: Box::new(move |attempt| run(attempt, params)),
        })
    };
    let losing = each(
        "ticks-lost",
        "a ball pressed 4 mm into the skin and stroked; of a hundred samples one is stale, or the next tick is 1 to 5 ms late",
        lost,
    );
    let trembling = each(
        "tremor-in-hand",
        "a ball held 4 mm in the skin by a hand that trembles by 0.2 mm at 10 Hz for 3 s, forces a tick late",
        |attempt, hand| tremor(attempt, hand, 3),
    );
    let pressing = each(
        "bone-held",
        "a ball pressed on skin over bone through 2,667 N/m, which is what friction and encoders bear; forces a tick late",
        bone,
    );
    let (_, weak) = HANDS[0];
    let long = Case {
        name: "tremor:in-hand-60-s".to_owned(),
        what: "the same for 60 s (weak hand)".to_owned(),
        equilibrium: None,
        run: Box::new(move |attempt| tremor(attempt, weak, 60)),
    };
    losing
        .into_iter()
        .chain(trembling)
        .chain([long])
        .chain(pressing)
        .collect()
}

/// The ball's pose with its lowest point there [m].
fn ball(x: f32, z: f32) -> Pose {
    Pose {
        position: Vec3::new(x, 0.0, z + BALL_M),
        rotation: Mat3::identity(),
    }
}

/// A scene in a hand that is 5 mm above the skin; and what is done with it.
fn held(
    attempt: &Attempt<'_>,
    scene: &(Scene, Vec<u8>),
    (hand, latency): (hand::Params, Latency),
    act: impl FnOnce(&mut Held<'_>) -> Result<(), Unfinished>,
) -> Result<Trace, Unfinished> {
    let mut memory = memory();
    let above = ball(-7e-3, 5e-3);
    let run = Run::new(*attempt, &mut memory, scene, above)?;
    let mut held = Held::new(run, hand, latency, above)?;
    act(&mut held)?;
    let Held { run, felt, .. } = held;
    Ok(Trace {
        felt: Some(felt.seen()),
        ..run.trace()
    })
}

const fn tick() -> Fate {
    Fate::Tick
}

fn lost(attempt: &Attempt<'_>, hand: hand::Params) -> Result<Trace, Unfinished> {
    let (above, down, aside) = (ball(-7e-3, 5e-3), ball(-7e-3, -4e-3), ball(-4e-3, -4e-3));
    let mut passed = 0_u32;
    let mut fate = || {
        passed += 1;
        let (hundred, of) = (passed / 100, passed % 100);
        match hundred % 2 {
            0 if of == 50 => Fate::Stale,
            1 if (50..=50 + hundred / 2 % 5).contains(&of) => Fate::Lost,
            _ => Fate::Tick,
        }
    };
    held(attempt, &stroked(attempt)?, (hand, Latency::None), |held| {
        held.go([above, down], 500, Vec3::zeros(), &mut fate)?;
        held.go([down, down], 1000, Vec3::zeros(), &mut fate)?;
        held.go([down, aside], 300, Vec3::zeros(), &mut fate)?;
        held.go([aside, aside], 300, Vec3::zeros(), &mut fate)?;
        held.go([aside, above], 200, Vec3::zeros(), &mut fate)?;
        held.go([above, above], 200, Vec3::zeros(), &mut fate)?;
        held.run.let_go();
        held.go([above, above], 1100, Vec3::zeros(), &mut fate)
    })
}

fn tremor(attempt: &Attempt<'_>, hand: hand::Params, seconds: u32) -> Result<Trace, Unfinished> {
    let (above, down) = (ball(-7e-3, 5e-3), ball(-7e-3, -4e-3));
    held(attempt, &stroked(attempt)?, (hand, Latency::Tick), |held| {
        held.go([above, down], 500, Vec3::zeros(), tick)?;
        for _ in 0..seconds {
            held.go([down, down], 1000, SHAKE, tick)?;
            held.felt.held();
        }
        held.go([down, above], 200, Vec3::zeros(), tick)?;
        held.go([above, above], 200, Vec3::zeros(), tick)?;
        held.run.let_go();
        held.go([above, above], 1100, Vec3::zeros(), tick)
    })
}

fn bone(attempt: &Attempt<'_>, hand: hand::Params) -> Result<Trace, Unfinished> {
    let (above, down) = (ball(-7e-3, 5e-3), ball(-7e-3, -10e-3));
    held(attempt, &bony(attempt, BEARS)?, (hand, Latency::Tick), |held| {
        held.go([above, down], 500, Vec3::zeros(), tick)?;
        held.go([down, down], 1500, Vec3::zeros(), tick)?;
        held.felt.held();
        held.go([down, down], 1000, SHAKE, tick)?;
        held.felt.held();
        held.go([down, above], 200, Vec3::zeros(), tick)?;
        held.go([above, above], 200, Vec3::zeros(), tick)?;
        held.run.let_go();
        held.go([above, above], 1100, Vec3::zeros(), tick)
    })
}
