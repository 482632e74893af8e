//! Where a stitch is, read off what tool and thread do.
//!
//! ```text
//!                 touch           puncture         tip lifts          needle out
//!   Approach ────────────▶ Indent ────────▶ Drive ─────────▶ Exit ─────────────▶ PullThrough
//!      ▲                     │                ▲ │              │                      │ thread taut
//!      └─────── let go ──────┴── drawn back ──┘ └── slipped ◀──┘                      ▼
//!   Done ◀─────────────────────────── Tie ◀─────────────── button ───────────────  Tension
//! ```
//!
//! A tool that cannot puncture goes from Indent to Done when it lets go, and back when it touches again; a scene
//! without a thread is done when the needle is out.

use crate::needle::{self, Passage};
use sutura_shared::scene::Stage;

/// Tension at which a thread counts as taut [N], and for how long [ticks]: slack thread tugs for a few ticks.
const TAUT: f32 = 0.05;
const LASTING: u32 = 20;
/// The time a knot takes [ticks].
const KNOT: u32 = 300;

/// What the stage is read off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signs<'a> {
    /// The tool's sites.
    pub needle: &'a needle::State,
    /// Whether the tool can puncture.
    pub pierces: bool,
    /// The thread's tension [N]; `None` without a thread.
    pub tension: Option<f32>,
    /// The stylus button.
    pub button: bool,
}

/// A stage and the ticks spent in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct State {
    /// The stage.
    pub stage: Stage,
    /// Ticks since it began.
    pub ticks: u32,
    /// Ticks that the thread has been taut without a break.
    pub taut: u32,
}

impl Default for State {
    fn default() -> Self {
        Self {
            stage: Stage::Approach,
            ticks: 0,
            taut: 0,
        }
    }
}

/// The stage after this tick.
#[must_use]
pub fn next(state: State, signs: &Signs<'_>) -> State {
    let pulls = signs.tension.is_some_and(|tension| tension >= TAUT);
    let taut = if pulls { state.taut.saturating_add(1) } else { 0 };
    let state = State { taut, ..state };
    let stage = follow(state, signs);
    if stage == state.stage {
        State {
            ticks: state.ticks.saturating_add(1),
            ..state
        }
    } else {
        State {
            stage,
            ticks: 0,
            taut: 0,
        }
    }
}

fn follow(State { stage, ticks, taut }: State, signs: &Signs<'_>) -> Stage {
    let [a, _, _, d] = &signs.needle.sites;
    match (stage, a, d) {
        (Stage::Approach, Passage::Touch(_), _) => Stage::Indent,
        (Stage::Done, Passage::Touch(_), _) if !signs.pierces => Stage::Indent,
        (Stage::Indent, Passage::Hole(_), _) => Stage::Drive,
        (Stage::Indent, Passage::Ahead, _) if !signs.pierces => Stage::Done,
        (Stage::Indent | Stage::Drive, a, d) if a.is_out() && d.is_out() => Stage::Approach,
        (Stage::Drive, _, Passage::Touch(_) | Passage::Hole(_)) => Stage::Exit,
        (Stage::Exit, _, d) if d.is_out() => Stage::Drive,
        (Stage::Exit, _, Passage::Passed(_)) if signs.tension.is_none() => Stage::Done,
        (Stage::Exit, _, Passage::Passed(_)) => Stage::PullThrough,
        (Stage::PullThrough, ..) if taut >= LASTING => Stage::Tension,
        (Stage::Tension, ..) if signs.button => Stage::Tie,
        (Stage::Tie, ..) if ticks >= KNOT => Stage::Done,
        _ => stage,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::needle::{Hole, Point, Touch};

    fn touch() -> Passage {
        Passage::Touch(Touch {
            point: Point::default(),
            from: Vec3::zeros(),
            f0: None,
        })
    }

    fn hole() -> Passage {
        Passage::Hole(Hole {
            point: Point::default(),
            from_tip: 0.0,
            adhesion: 0.0,
            cut: 0.0,
        })
    }

    fn sites(a: Passage, d: Passage) -> needle::State {
        needle::State {
            sites: [a, Passage::Ahead, Passage::Ahead, d],
            ..needle::State::default()
        }
    }

    #[test]
    fn a_stitch_goes_through_all_stages_in_order() {
        let passed = Passage::Passed(Point::default());
        let course = [
            (touch(), Passage::Ahead, 0.0, false, Stage::Indent),
            (hole(), Passage::Ahead, 0.0, false, Stage::Drive),
            (hole(), touch(), 0.0, false, Stage::Exit),
            (passed, hole(), 0.0, false, Stage::Exit),
            (passed, passed, 0.0, false, Stage::PullThrough),
            (passed, passed, 0.5, false, Stage::Tension),
            (passed, passed, 0.5, true, Stage::Tie),
        ];
        let mut state = State::default();
        for (a, d, tension, button, expected) in course {
            let needle = sites(a, d);
            let signs = Signs {
                needle: &needle,
                pierces: true,
                tension: Some(tension),
                button,
            };
            for _ in 0..=LASTING {
                state = next(state, &signs);
            }
            assert_eq!(state.stage, expected);
        }
        let needle = sites(passed, passed);
        for _ in 0..=KNOT {
            state = next(
                state,
                &Signs {
                    needle: &needle,
                    pierces: true,
                    tension: Some(0.0),
                    button: false,
                },
            );
        }
        assert_eq!(state.stage, Stage::Done);
    }

    #[test]
    fn a_ball_that_lets_go_is_done_until_it_touches_again() {
        let mut state = State::default();
        for (a, expected) in [
            (touch(), Stage::Indent),
            (Passage::Ahead, Stage::Done),
            (touch(), Stage::Indent),
        ] {
            let needle = sites(a, Passage::Ahead);
            state = next(
                state,
                &Signs {
                    needle: &needle,
                    pierces: false,
                    tension: None,
                    button: false,
                },
            );
            assert_eq!(state.stage, expected);
        }
    }
}
