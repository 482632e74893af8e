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
//! Of several stitches every one but the last ends in Tension, once the hand lets the thread go slack: the next begins at Approach.
//!
//! A tool that cannot puncture goes from Indent to Done when it lets go, and back when it touches again; a scene
//! without a thread is done when the needle is out.

use crate::needle::{self, Passage};
use sutura_shared::scene::Stage;

/// Tension at which a thread counts as taut [N], and for how long it must be taut or slack to be taken for it [ticks]: slack thread tugs for
/// a few ticks.
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
    /// Stitches after this one.
    pub ahead: usize,
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
    /// Whether the thread is taut.
    pub taut: bool,
    /// Ticks of this stage that it has been as it is, without a break.
    pub lasting: u32,
}

impl Default for State {
    fn default() -> Self {
        Self {
            stage: Stage::Approach,
            ticks: 0,
            taut: false,
            lasting: 0,
        }
    }
}

/// The stage after this tick.
#[must_use]
pub fn next(state: State, signs: &Signs<'_>) -> State {
    let taut = signs.tension.is_some_and(|tension| tension >= TAUT);
    let lasting = if taut == state.taut {
        state.lasting.saturating_add(1)
    } else {
        1
    };
    let state = State { taut, lasting, ..state };
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
            taut,
            lasting: 0,
        }
    }
}

fn follow(
    State {
        stage,
        ticks,
        taut,
        lasting,
    }: State,
    signs: &Signs<'_>,
) -> Stage {
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
        (Stage::PullThrough, ..) if taut && lasting >= LASTING => Stage::Tension,
        (Stage::Tension, ..) if signs.ahead > 0 && !taut && lasting >= LASTING => Stage::Approach,
        (Stage::Tension, ..) if signs.ahead == 0 && signs.button => Stage::Tie,
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
                ahead: 0,
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
                    ahead: 0,
                    button: false,
                },
            );
        }
        assert_eq!(state.stage, Stage::Done);
    }

    /// A thread that is let go of begins the next stitch, and the knot is the last one's.
    #[test]
    fn a_slack_thread_ends_a_stitch_that_is_not_the_last() {
        let passed = Passage::Passed(Point::default());
        let needle = sites(passed, passed);
        let after = |ahead, tension, ticks, button| {
            let mut state = State {
                stage: Stage::Tension,
                ..State::default()
            };
            for _ in 0..ticks {
                let signs = Signs {
                    needle: &needle,
                    pierces: true,
                    tension: Some(tension),
                    ahead,
                    button,
                };
                state = next(state, &signs);
            }
            state.stage
        };
        assert_eq!(after(1, 0.0, LASTING - 1, false), Stage::Tension);
        assert_eq!(after(1, 0.0, LASTING, false), Stage::Approach);
        assert_eq!(after(0, 0.0, LASTING, false), Stage::Tension);
        assert_eq!(after(1, 0.5, LASTING, true), Stage::Tension);
        assert_eq!(after(0, 0.5, LASTING, true), Stage::Tie);
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
                    ahead: 0,
                    button: false,
                },
            );
            assert_eq!(state.stage, expected);
        }
    }
}
