//! Hands of three skills on the built-in scene: the better one has the better score, and an expert's run is without a fault.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used)]

use std::sync::OnceLock;

use sutura::run::report::Report;
use sutura::scene::skill::{Person, SKILLS};
use sutura_tests::scenario;

/// Seeds that are always sewn, and all of them.
const FEW: u32 = 2;
const ALL: u32 = 10;

fn sewn(skill: usize, seed: u32) -> Report {
    let skill = &SKILLS[skill];
    scenario::sewn(None, Some(Person { skill, seed })).unwrap()
}

/// One run of each skill for each seed, all made once.
fn runs() -> &'static [[Report; 3]] {
    static RUNS: OnceLock<Vec<[Report; 3]>> = OnceLock::new();
    RUNS.get_or_init(|| {
        let seeds = if sutura_tests::full("operators with every seed") {
            ALL
        } else {
            FEW
        };
        (0..seeds)
            .map(|seed| [0, 1, 2].map(|skill| sewn(skill, seed)))
            .collect()
    })
}

/// With every seed at least nine of ten keep the order; of a few all do.
#[test]
fn the_better_hand_has_the_better_score() {
    let totals: Vec<_> = runs()
        .iter()
        .map(|hands| hands.each_ref().map(|report| report.score.as_ref().unwrap().total))
        .collect();
    for (better, worse) in [(0, 1), (1, 2)] {
        let kept = totals.iter().filter(|total| total[better] > total[worse]).count();
        assert!(kept >= totals.len() - totals.len() / 10, "{totals:?}");
    }
}

#[test]
fn an_expert_makes_no_fault_and_closes_the_wound() {
    for [expert, ..] in runs() {
        assert_eq!(expert.faults, Vec::<&str>::new());
        let gap = &expert.wound_gap_mm.at_stitch[0];
        assert!((-0.1..=0.25 * gap.before).contains(&gap.after), "{gap:?}");
    }
}

#[test]
fn a_seed_is_a_hand() {
    let [first, second] = [0, 1].map(|seed| &runs()[seed][0]);
    assert_ne!(first.state_hash, second.state_hash);
    assert_eq!(sewn(0, 1).state_hash, second.state_hash);
}
