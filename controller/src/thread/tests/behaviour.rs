//! Closed forms and the monolithic reference.

use super::reference::Monolith;
use super::*;
use crate::math::length;

const ORIGIN: Vec3 = Vec3::new(0.0, 0.0, 0.0);

pub(super) fn wide(v: Vec3) -> [f64; 3] {
    [f64::from(v.x), f64::from(v.y), f64::from(v.z)]
}

/// y = c cosh(x/c) with D = 60 mm and L = 100 mm has c = 16.317 mm and sag 36.278 mm.
#[test]
fn a_hanging_thread_is_a_catenary() {
    let params = params(41, 0.1 / 40.0, &[Effect::Gravity]);
    let (from, to) = (Vec3::new(-0.03, 0.0, 0.0), Vec3::new(0.03, 0.0, 0.0));
    let mut state = State::laid(&params, from, to, -Vec3::z());
    let mut work = Work::default();
    let ends = Ends {
        swage: Some(from),
        tail: Some(to),
        eyelet: None,
        end_stiffness: 1e6,
    };
    for _ in 0..3000 {
        condense(&params, &state, &ends, &Air, &mut work);
        settle(&params, &mut state, &mut work, [ORIGIN; 2]);
    }
    let sag = -state.nodes[20].point().z;
    assert!((sag / 0.036_278 - 1.0).abs() < 5e-3, "sag {sag}");
}

/// The link in the eyelet and the points' places, in double precision.
fn near(params: &Params, state: &State, tissue: &Tissue) -> (Option<usize>, Vec<[f64; 3]>) {
    let through = match state.run {
        Run::Sliding { link } => Some(link),
        _ => None,
    };
    let nodes = state.nodes.iter().take(params.nodes() - 1).map(Place::point);
    (through, nodes.chain(tissue.at).map(wide).collect())
}

/// The same thread and tissue in double precision.
pub(super) fn monolith(params: &Params, state: &State, tissue: &Tissue) -> Monolith {
    let n = params.nodes();
    let (through, x) = near(params, state, tissue);
    Monolith {
        links: n - 1,
        rest: f64::from(params.rest),
        axial: f64::from(params.axial),
        density: f64::from(43e-6_f32),
        alpha: 20.0,
        coupling: f64::from(params.coupling),
        tissue_mass: f64::from(tissue.mass),
        tissue_stiffness: f64::from(tissue.stiffness),
        tissue_rest: tissue.rest.map(wide),
        through,
        x,
        v: vec![[0.0; 3]; n + 1],
    }
}

/// A straight thread, a little shorter than its length, tied to skin of 250 N/m; `through` is the link in an eyelet at which the
/// thread turns by 127°.
pub(super) fn straight(through: Option<usize>) -> (Params, Tissue, Thread) {
    let params = params(21, 0.005, &[]);
    let eyelet = Vec3::new(0.004, 0.0, 0.0);
    let tail = Vec3::new(-0.053, 0.001, 0.0);
    let mut state = State::laid(&params, tail + Vec3::x() * 0.099, tail, Vec3::z());
    if let Some(link) = through {
        let inwards = (tail - eyelet) / length(tail - eyelet);
        for (i, node) in state.nodes.iter_mut().enumerate().take(params.nodes() - 1) {
            let s = 0.005 * (i as f32 - link as f32 - 0.5);
            let along = if s < 0.0 { way(through) } else { inwards };
            *node = Place::new(eyelet + along * (0.99 * s.abs()) + Vec3::y() * (0.02 * s));
        }
        state.run = Run::Sliding { link };
    }
    (params, Tissue::new([tail, eyelet]), Thread::new(state))
}

/// Where the needle of [`straight`] goes.
pub(super) fn way(through: Option<usize>) -> Vec3 {
    if through.is_some() {
        Vec3::new(0.6, 0.0, 0.8)
    } else {
        Vec3::x()
    }
}

/// Drawn away at 1 m/s; through the eyelet five nodes pass.
fn going_taut(through: Option<usize>) {
    let (params, mut tissue, mut thread) = straight(through);
    let start = thread.state.nodes[0].point();
    let mut reference = monolith(&params, &thread.state, &tissue);
    let (mut peak, mut error) = (0.0_f32, 0.0_f32);
    for tick in 1..=40 {
        let swage = start + way(through) * (1e-3 * tick as f32);
        let pull = tissue.tick(&params, &mut thread, swage, &Air);
        let (exact, left) = reference.tick(wide(swage), near(&params, &thread.state, &tissue));
        assert!(left < 1e-8, "the reference has converged: {left}");
        let exact = Vec3::from_iterator(exact.iter().map(|f| *f as f32));
        peak = peak.max(length(exact));
        error = error.max(length(pull.on_needle - exact));
    }
    assert!(peak > 3.0 && error < 1e-3 * peak, "{error} of {peak}");
    assert_eq!(near(&params, &thread.state, &tissue).0, through.map(|link| link + 5));
}

#[test]
fn going_taut_at_1_m_per_s_agrees_with_the_monolithic_solve() {
    going_taut(None);
}

#[test]
fn going_taut_through_the_eyelet_agrees_with_the_monolithic_solve() {
    going_taut(Some(8));
}

/// Tension of every link.
fn tensions(params: &Params, state: &State) -> Vec<f32> {
    let passing = match state.run {
        Run::Sliding { link } => link,
        _ => usize::MAX,
    };
    let eyelet = Place::new(state.eyelet.unwrap_or_default());
    let links = state.nodes.windows(2).take(params.nodes() - 1).enumerate();
    links
        .map(|(i, ends)| {
            let straight = length(ends[0].to(&ends[1]));
            let bent = length(ends[0].to(&eyelet)) + length(eyelet.to(&ends[1]));
            params.stiffness() * (if i == passing { bent } else { straight } - params.rest)
        })
        .collect()
}

/// Without friction a thread has one tension, on both sides of the eyelet, while five nodes pass and come back; and on the way
/// back it is what it was on the way out.
#[test]
fn the_tension_is_the_same_on_both_sides_of_the_eyelet_and_both_ways() {
    let (params, mut tissue, mut thread) = straight(Some(8));
    let start = thread.state.nodes[0].point();
    let mut outwards = [0.0_f32; 201];
    for tick in 1..=380_usize {
        let step = 200 - 200_usize.abs_diff(tick);
        let swage = start + way(Some(8)) * (2e-4 * step as f32);
        let pull = tissue.tick(&params, &mut thread, swage, &Air);
        if step <= 20 {
            continue;
        }
        for tension in tensions(&params, &thread.state) {
            assert!(
                (tension / pull.tension - 1.0).abs() < 0.01,
                "tick {tick}: {tension} of {}",
                pull.tension
            );
        }
        if tick <= 200 {
            outwards[step] = pull.tension;
        }
        assert!(
            (pull.tension / outwards[step] - 1.0).abs() < 0.01,
            "{} of {}",
            pull.tension,
            outwards[step]
        );
        if step == 200 {
            assert_eq!(thread.state.run, Run::Sliding { link: 13 });
        }
    }
    assert_eq!(thread.state.run, Run::Sliding { link: 8 });
}

/// A floor at z = 0.
struct Floor;

impl Ground for Floor {
    fn at(&self, p: Vec3) -> Option<Touch> {
        Some(Touch {
            gap: p.z,
            normal: Vec3::z(),
        })
    }
}

/// 200 mm of slack thread is drawn through the eyelet, 10 mm too far, and given back. A node stuck in the eyelet for one tick would
/// pull with K_c v dt; a tenth of that is allowed while there is slack. What is left of the length when it is taut is the
/// straight line from needle to eyelet to tail: F = EA (l/L − 1).
fn pulled_through(speed: f32) {
    let params = params(41, 0.005, &[Effect::Gravity, Effect::ThreadContact]);
    let (tail, eyelet) = (Vec3::new(-0.005, 0.0, 0.0), Vec3::new(0.005, 0.0, 0.0));
    let mut tissue = Tissue::new([tail, eyelet]);
    let mut state = State::laid(&params, eyelet, tail, Vec3::new(0.0, 0.8, 0.6));
    state.lead_through();
    let mut thread = Thread::new(state);
    let ticks = (0.2 / speed * 1000.0) as i32;
    for tick in 1..2 * ticks {
        let out = speed * 1e-3 * (ticks - (tick - ticks).abs()) as f32;
        let swage = eyelet + Vec3::new(0.28, 0.0, 0.96) * out;
        let pull = tissue.tick(&params, &mut thread, swage, &Floor);
        let force = length(pull.on_needle);
        if out < 0.188 {
            assert!(force < 0.1 * params.coupling * speed * 1e-3, "{force} N at {out} m");
        }
        if tick == ticks {
            let line = length(thread.state.nodes[0].point() - tissue.at[1]) + length(tissue.at[1] - tissue.at[0]);
            let expected = params.axial * (line / params.length() - 1.0);
            assert!((force / expected - 1.0).abs() < 0.01, "{force} of {expected}");
            assert!(matches!(thread.state.run, Run::Sliding { link: 38 | 39 }));
        }
    }
    assert!(thread.state.nodes.iter().all(|node| crate::math::finite(node.point())));
}

#[test]
fn a_thread_is_drawn_through_and_given_back_without_a_jerk() {
    pulled_through(0.2);
}

#[test]
fn a_thread_is_drawn_through_at_1_m_per_s() {
    pulled_through(1.0);
}

/// 100 mm of slack thread is drawn through the eyelet at 70 mm/s; its tail is held `bite` [m] away, at 90° + `turn_deg` to the
/// way of the needle. Largest tension while at least 2 mm more thread is left than the way from needle to eyelet to tail.
fn slack_tension(turn_deg: f32, bite: f32) -> f32 {
    let params = params(21, 0.005, &[Effect::Gravity, Effect::ThreadContact]);
    let (sin, cos) = libm::sincosf(turn_deg.to_radians());
    let eyelet = Vec3::new(0.005, 0.0, 0.0);
    let tail = eyelet - Vec3::x() * bite;
    let mut tissue = Tissue::new([tail, eyelet]);
    let mut state = State::laid(&params, eyelet, tail, Vec3::y());
    state.lead_through();
    let mut thread = Thread::new(state);
    let mut most = 0.0_f32;
    for tick in 1..2000 {
        let swage = eyelet + Vec3::new(sin, 0.0, cos) * (70e-6 * tick as f32);
        let pull = tissue.tick(&params, &mut thread, swage, &Floor);
        if length(swage - tissue.at[1]) + length(tissue.at[1] - tissue.at[0]) > params.length() - 2e-3 {
            return most;
        }
        most = most.max(pull.tension).max(pull.stitch).max(length(pull.on_needle));
    }
    most
}

/// A slack thread bears its weight (42 µN) and the snap of single links, ρ c v = 4 mN at c = √(EA/ρ) = 1330 m/s.
#[test]
fn a_slack_thread_does_not_pull_at_whatever_angle_its_tail_lies() {
    for turn_deg in (-90..=90).step_by(10) {
        for bite in [3e-3, 5e-3, 8e-3, 12e-3] {
            let most = slack_tension(turn_deg as f32, bite);
            assert!(
                most < 5e-3,
                "{most} N with the tail at {}°, {bite} m away",
                90 + turn_deg
            );
        }
    }
}

/// Tied under tension, the stitch keeps it when the needle lets go and is cut off.
#[test]
fn a_tied_thread_keeps_the_tension_between_the_punctures() {
    let (params, mut tissue, mut thread) = straight(Some(8));
    let start = thread.state.nodes[0].point();
    let mut swage = start + way(Some(8)) * 0.01;
    for _ in 0..300 {
        tissue.tick(&params, &mut thread, swage, &Air);
    }
    let before = tissue.tick(&params, &mut thread, swage, &Air);
    thread.state.tie(&params);
    let tied = tissue.tick(&params, &mut thread, swage, &Air);
    assert!((tied.stitch / before.tension - 1.0).abs() < 1e-3 && (tied.tension / before.tension - 1.0).abs() < 1e-3);
    swage = start - way(Some(8)) * 0.005;
    for _ in 0..500 {
        tissue.tick(&params, &mut thread, swage, &Air);
    }
    let slack = tissue.tick(&params, &mut thread, swage, &Air);
    assert!(
        slack.tension < 1e-4 && slack.stitch > 0.2,
        "{} and {}",
        slack.tension,
        slack.stitch
    );
    // Statics of the two points: the skin's springs give in to the stitch alone.
    let gap = length(tissue.at[1] - tissue.at[0]);
    let loose = length(tissue.rest[1] - tissue.rest[0]);
    let expected = 0.5 * tissue.stiffness * (loose - gap);
    assert!(
        (slack.stitch / expected - 1.0).abs() < 0.01,
        "{} of {expected}",
        slack.stitch
    );
    assert!((slack.between - before.between).abs() < 1e-3);
}

/// Everything in one place, and a needle that jumps by 20 mm and back.
#[test]
fn nasty_inputs_leave_a_finite_thread_that_recovers() {
    let (params, mut tissue, mut thread) = straight(Some(8));
    let swage = thread.state.nodes[0].point() + way(Some(8)) * 0.005;
    let settled = |tissue: &mut Tissue, thread: &mut Thread| {
        (0..600)
            .map(|_| tissue.tick(&params, thread, swage, &Air))
            .last()
            .unwrap_or_default()
    };
    let before = settled(&mut tissue, &mut thread).tension;
    for jump in [Vec3::x(), -Vec3::z(), Vec3::y()] {
        for _ in 0..3 {
            let pull = tissue.tick(&params, &mut thread, swage + jump * 0.02, &Air);
            assert!(pull.tension.is_finite());
        }
        let after = settled(&mut tissue, &mut thread).tension;
        assert!((after / before - 1.0).abs() < 0.01, "{after} of {before}");
    }
    let here = Place::new(tissue.at[1]);
    thread.state.nodes = [here; NODES_MAX];
    let after = settled(&mut tissue, &mut thread).tension;
    assert!(after.is_finite() && after > 0.0, "{after} of {before}");
}
