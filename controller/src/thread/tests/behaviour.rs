//! Closed forms and the monolithic reference.

use super::reference::Monolith;
use super::*;
use crate::math::length;

const ORIGIN: Vec3 = Vec3::new(0.0, 0.0, 0.0);

fn wide(v: Vec3) -> [f64; 3] {
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

/// The same thread and tissue in double precision.
fn monolith(params: &Params, state: &State, tissue: &Tissue) -> Monolith {
    let n = params.nodes();
    let nodes = state.nodes.iter().take(n).map(|node| wide(node.point()));
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
        through: match state.run {
            Run::Sliding { link } => Some(link),
            _ => None,
        },
        x: nodes.chain([wide(tissue.at[1])]).collect(),
        v: vec![[0.0; 3]; n + 1],
    }
}

/// A straight thread, a little shorter than its length, is drawn away at 1 m/s from skin of 250 N/m: `through` is the link in an
/// eyelet at which the thread turns by 127°.
fn going_taut(through: Option<usize>) {
    let params = params(21, 0.005, &[]);
    let n = params.nodes();
    let eyelet = Vec3::new(0.004, 0.0, 0.0);
    let tail = Vec3::new(-0.053, 0.001, 0.0);
    let mut tissue = Tissue::new([tail, eyelet]);
    let mut state = State::laid(&params, tail + Vec3::x() * 0.099, tail, Vec3::z());
    if let Some(link) = through {
        for (i, node) in state.nodes.iter_mut().enumerate().take(n - 1) {
            let s = 0.005 * (i as f32 - link as f32 - 0.5);
            let way = if s < 0.0 {
                Vec3::new(-0.6, 0.0, -0.8)
            } else {
                (tail - eyelet) / length(tail - eyelet)
            };
            *node = Place::new(eyelet + way * (0.99 * s) + Vec3::y() * (0.02 * s));
        }
        state.run = Run::Sliding { link };
    }
    let start = state.nodes[0].point();
    let way = if through.is_some() {
        Vec3::new(0.6, 0.0, 0.8)
    } else {
        Vec3::x()
    };
    let mut reference = monolith(&params, &state, &tissue);
    let mut thread = Thread::new(state);
    let (mut peak, mut error) = (0.0_f32, 0.0_f32);
    for tick in 1..=if through.is_some() { 12 } else { 40 } {
        let swage = start + way * (1e-3 * tick as f32);
        let pull = tissue.tick(&params, &mut thread, swage, &Air);
        let (exact, left) = reference.tick(wide(swage));
        let exact = Vec3::new(exact[0] as f32, exact[1] as f32, exact[2] as f32);
        peak = peak.max(length(exact));
        error = error.max(length(pull.on_needle - exact));
        assert!(left < 1e-8);
    }
    assert!(peak > 0.25);
    assert!(error < 0.01 * peak, "{error} of {peak}");
}

#[test]
fn going_taut_at_1_m_per_s_agrees_with_the_monolithic_solve() {
    going_taut(None);
}

#[test]
fn going_taut_through_the_eyelet_agrees_with_the_monolithic_solve() {
    going_taut(Some(8));
}
