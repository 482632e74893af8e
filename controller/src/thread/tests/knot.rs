//! The knot's limit.

use super::behaviour::{ONE, straight, way};
use super::*;
use crate::math::length;

fn tied(hold: f32) -> (Params, Tissue, Thread, Vec3) {
    let (_, mut tissue, mut thread) = straight(ONE);
    let knotted = scene::Thread {
        knot_hold_n: hold,
        ..nylon(21, 0.005)
    };
    let params = build(&knotted, 500.0, Effects::default().with(Effect::Knot)).unwrap();
    let swage = thread.state.nodes[0].point() + way(ONE) * 0.01;
    for _ in 0..300 {
        tissue.tick(&params, &mut thread, swage, &Air);
    }
    thread.state.tie(&params);
    (params, tissue, thread, swage)
}

/// A knot that holds less than the stitch pulls with slips until it holds, whether the hand lets go slowly or at 1 m/s; what is left is its
/// limit. In a tick it holds, so while it slips the difference is above it by what grows in one: no more slips than the hand's way, which
/// parts the tensions by EA/l of the thread on either side.
#[test]
fn a_knot_slips_down_to_what_it_holds() {
    for way_of_a_tick in [2e-6, 2e-5, 1e-4, 1e-3] {
        let (params, mut tissue, mut thread, swage) = tied(0.2);
        let sides = [length(swage - tissue.at[1]), length(tissue.at[0] - tissue.at[1])];
        let stiffness: f32 = sides.iter().map(|l| params.axial / l).sum();
        let mut last = Pull::default();
        let mut most = 0.0_f32;
        for tick in 0..6000 {
            let back = way(ONE) * (way_of_a_tick * tick as f32).min(0.01);
            last = tissue.tick(&params, &mut thread, swage - back, &Air);
            most = most.max(last.stitch - last.tension);
        }
        let growth = stiffness * way_of_a_tick;
        eprintln!("{way_of_a_tick} m a tick: at most {most} N, {growth} N in a tick; in the end {last:?}");
        assert!(most < 0.2 + growth, "{most}");
        assert!(
            last.tension < 1e-3 && (last.stitch / 0.2 - 1.0).abs() < 0.01,
            "{last:?}"
        );
    }
}

/// Without the effect nothing is tied, and letting go lets the thread run back.
#[test]
fn without_a_knot_the_thread_runs_back() {
    let (_, mut tissue, mut thread, swage) = tied(20.0);
    let params = params(21, 0.005, &[]);
    thread.state.course.knot = None;
    thread.state.tie(&params);
    assert_eq!(thread.state.course.knot, None);
    let mut last = Pull::default();
    for _ in 0..500 {
        last = tissue.tick(&params, &mut thread, swage - way(ONE) * 0.02, &Air);
    }
    assert!(last.stitch < 1e-3, "{last:?}");
}
