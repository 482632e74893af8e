//! The knot's limit.

use super::behaviour::{ONE, straight, way};
use super::*;

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

/// A knot that holds less than the stitch pulls with slips until it holds; what is left is its limit, and the difference is above it by no more than
/// grows in a tick.
#[test]
fn a_knot_slips_down_to_what_it_holds() {
    let (params, mut tissue, mut thread, swage) = tied(0.2);
    let mut last = Pull::default();
    for tick in 0..600 {
        let back = way(ONE) * (2e-5 * tick as f32).min(0.01);
        last = tissue.tick(&params, &mut thread, swage - back, &Air);
        assert!(last.stitch - last.tension < 0.2 * 1.05, "tick {tick}: {last:?}");
    }
    assert!(
        last.tension < 1e-3 && (last.stitch / 0.2 - 1.0).abs() < 0.01,
        "{last:?}"
    );
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
