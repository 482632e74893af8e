//! Closed forms and the monolithic reference.

use super::reference::Monolith;
use super::*;
use crate::coupling::POINTS;
use crate::math::length;

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
        end_stiffness: 1e6,
        ..Ends::default()
    };
    for _ in 0..3000 {
        condense(&params, &state, &ends, &Air, &mut work);
        settle(&params, &mut state, &mut work, &[Vec3::zeros(); POINTS]);
    }
    let sag = -state.nodes[20].point().z;
    assert!((sag / 0.036_278 - 1.0).abs() < 5e-3, "sag {sag}");
}

/// The links in the eyelets and the points' places, in double precision.
fn near(params: &Params, state: &State, tissue: &Tissue) -> (Vec<usize>, Vec<[f64; 3]>) {
    let nodes = state.nodes.iter().take(params.nodes() - 1).map(Place::point);
    (links(state), nodes.chain(tissue.at.iter().copied()).map(wide).collect())
}

/// The links in the eyelets.
fn links(state: &State) -> Vec<usize> {
    state.course.through().iter().map(|eyelet| eyelet.link).collect()
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
        bending: params.bending.map(|_| (f64::from(2.3e-7_f32), wide(tissue.heading))),
        tissue_mass: f64::from(tissue.mass),
        tissue_stiffness: f64::from(tissue.stiffness),
        tissue_rest: tissue.rest.iter().copied().map(wide).collect(),
        through,
        v: vec![[0.0; 3]; x.len()],
        x,
    }
}

/// Two eyelets a link and more apart, and two within a link, the one nearer to the tail first; the thread turns by 127° in all at
/// the first of [`ONE`], and at those of the others twice.
pub(super) const NONE: &[Vec3] = &[];
pub(super) const ONE: &[Vec3] = &[Vec3::new(0.004, 0.0, 0.0)];
pub(super) const TWO: &[Vec3] = &[Vec3::new(-0.008, 0.0, -0.004), Vec3::new(0.004, 0.0, 0.0)];
pub(super) const TWO_IN_A_LINK: &[Vec3] = &[Vec3::new(0.0025, 0.0, -0.002), Vec3::new(0.004, 0.0, 0.0)];

/// A thread laid straight from eyelet to eyelet, a little shorter than its length and off its line, tied to skin of 250 N/m.
pub(super) fn straight(eyelets: &[Vec3]) -> (Params, Tissue, Thread) {
    straight_with(Effect::Knot, eyelets)
}

/// The same with an effect of its own; it leaves the needle along its line.
pub(super) fn straight_with(effect: Effect, eyelets: &[Vec3]) -> (Params, Tissue, Thread) {
    let params = params(21, 0.005, &[effect]);
    let tail = Vec3::new(-0.053, 0.001, 0.0);
    let stops: Vec<Vec3> = [tail].iter().chain(eyelets).copied().collect();
    let tissue = Tissue {
        heading: -way(eyelets),
        ..Tissue::new(&stops)
    };
    if eyelets.is_empty() {
        let state = State::laid(&params, tail + Vec3::x() * 0.099, tail, Vec3::z());
        return (params, tissue, Thread::new(state));
    }
    let mut state = super::laid(&params, &stops, way(eyelets));
    for (i, node) in state.nodes.iter_mut().enumerate().take(params.nodes() - 1) {
        *node = Place::new(node.point() + Vec3::y() * (1e-4 * (i as f32 - 8.5)));
    }
    (params, tissue, Thread::new(state))
}

/// Where the needle of [`straight`] goes.
pub(super) fn way(eyelets: &[Vec3]) -> Vec3 {
    if eyelets.is_empty() {
        Vec3::x()
    } else {
        Vec3::new(0.6, 0.0, 0.8)
    }
}

/// Drawn away at 1 m/s from tissue of this stiffness [N/m]; through the eyelets at least two nodes pass.
fn going_taut(eyelets: &[Vec3], stiffness: f32) {
    let (first, last) = goes_taut(straight(eyelets), eyelets, stiffness);
    let passed = first.iter().zip(&last).map(|(from, to)| to - from);
    assert!(passed.clone().all(|nodes| nodes >= 2), "{first:?} to {last:?}");
}

/// The links in the eyelets before and after.
pub(super) fn goes_taut(
    (params, mut tissue, mut thread): (Params, Tissue, Thread),
    eyelets: &[Vec3],
    stiffness: f32,
) -> (Vec<usize>, Vec<usize>) {
    tissue.stiffness = stiffness;
    let (start, first) = (thread.state.nodes[0].point(), links(&thread.state));
    let mut reference = monolith(&params, &thread.state, &tissue);
    let (mut peak, mut error) = (0.0_f32, 0.0_f32);
    for tick in 1..=40 {
        let swage = start + way(eyelets) * (1e-3 * tick as f32);
        let pull = tissue.tick(&params, &mut thread, swage, &Air);
        let (exact, left) = reference.tick(wide(swage), near(&params, &thread.state, &tissue));
        assert!(left < 1e-8, "the reference has converged: {left}");
        let exact = Vec3::from_iterator(exact.iter().map(|f| *f as f32));
        peak = peak.max(length(exact));
        error = error.max(length(pull.on_needle - exact));
    }
    eprintln!(
        "{} eyelets: {error:.1e} N apart, of {peak:.2} N; links {first:?} to {:?}",
        eyelets.len(),
        links(&thread.state)
    );
    assert!(peak > 3.0 && error < 1e-3 * peak, "{error} of {peak}");
    assert_eq!(links(&thread.state), reference.through);
    (first, reference.through)
}

#[test]
fn going_taut_at_1_m_per_s_agrees_with_the_monolithic_solve() {
    going_taut(NONE, 250.0);
}

#[test]
fn going_taut_through_the_eyelet_agrees_with_the_monolithic_solve() {
    going_taut(ONE, 250.0);
}

#[test]
fn going_taut_through_two_eyelets_agrees_with_the_monolithic_solve() {
    assert_ne!(links(&straight(TWO).2.state)[0], links(&straight(TWO).2.state)[1]);
    going_taut(TWO, 250.0);
}

#[test]
fn going_taut_through_two_eyelets_in_one_link_agrees_with_the_monolithic_solve() {
    assert_eq!(
        links(&straight(TWO_IN_A_LINK).2.state)[0],
        links(&straight(TWO_IN_A_LINK).2.state)[1]
    );
    going_taut(TWO_IN_A_LINK, 2500.0);
}

/// In soft tissue the thread draws two eyelets together until they meet and lets go of them again: they are where they were, and so is
/// the thread.
#[test]
fn eyelets_that_meet_come_apart_again() {
    let (params, mut tissue, mut thread) = straight(TWO_IN_A_LINK);
    let start = thread.state.nodes[0].point();
    let mut nearest = f32::INFINITY;
    for tick in 1..=600_i32 {
        let swage = start + way(TWO_IN_A_LINK) * (4e-4 * (100 - (tick - 100).abs()).max(0) as f32);
        let pull = tissue.tick(&params, &mut thread, swage, &Air);
        assert!(pull.tension.is_finite());
        nearest = nearest.min(length(tissue.at[1] - tissue.at[2]));
    }
    let apart = |at: &[Vec3]| length(at[1] - at[2]);
    assert!(nearest < 1e-4, "{nearest} m");
    assert!((apart(&tissue.at) / apart(&tissue.rest) - 1.0).abs() < 0.05);
}

/// Tension of every link.
fn tensions(params: &Params, state: &State) -> Vec<f32> {
    let through = state.course.through();
    let tension = |i: usize| {
        let inner = through
            .iter()
            .rev()
            .filter(|eyelet| eyelet.link == i)
            .map(|eyelet| eyelet.place);
        let points: Vec<Place> = [state.nodes[i]]
            .into_iter()
            .chain(inner)
            .chain([state.nodes[i + 1]])
            .collect();
        let bent: f32 = points.windows(2).map(|ends| length(ends[0].to(&ends[1]))).sum();
        params.stiffness() * (bent - params.rest)
    };
    (0..params.nodes() - 1).map(tension).collect()
}

/// Without friction a thread has one tension, on both sides of the eyelet, while five nodes pass and come back; and on the way
/// back it is what it was on the way out.
#[test]
fn the_tension_is_the_same_on_both_sides_of_the_eyelet_and_both_ways() {
    let (params, mut tissue, mut thread) = straight(ONE);
    let start = thread.state.nodes[0].point();
    let mut outwards = [0.0_f32; 201];
    for tick in 1..=380_usize {
        let step = 200 - 200_usize.abs_diff(tick);
        let swage = start + way(ONE) * (2e-4 * step as f32);
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
            assert_eq!(links(&thread.state), [13]);
        }
    }
    assert_eq!(links(&thread.state), [8]);
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
    let mut tissue = Tissue::new(&[tail, eyelet]);
    let mut state = State::laid(&params, eyelet, tail, Vec3::new(0.0, 0.8, 0.6));
    state.lead_through(eyelet);
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
            assert!(matches!(links(&thread.state)[..], [38 | 39]));
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
    let mut tissue = Tissue::new(&[tail, eyelet]);
    let mut state = State::laid(&params, eyelet, tail, Vec3::y());
    state.lead_through(eyelet);
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
    let (params, mut tissue, mut thread) = straight(ONE);
    let start = thread.state.nodes[0].point();
    let mut swage = start + way(ONE) * 0.01;
    for _ in 0..300 {
        tissue.tick(&params, &mut thread, swage, &Air);
    }
    let before = tissue.tick(&params, &mut thread, swage, &Air);
    thread.state.tie(&params);
    let tied = tissue.tick(&params, &mut thread, swage, &Air);
    assert!((tied.stitch / before.tension - 1.0).abs() < 1e-3 && (tied.tension / before.tension - 1.0).abs() < 1e-3);
    swage = start - way(ONE) * 0.005;
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
    let (params, mut tissue, mut thread) = straight(ONE);
    let swage = thread.state.nodes[0].point() + way(ONE) * 0.005;
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
