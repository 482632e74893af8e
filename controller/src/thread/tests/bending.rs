//! Effect `thread-bending`: closed forms of beams, and the monolithic reference.

use super::behaviour::{NONE, goes_taut, straight_with};
use super::*;
use crate::coupling::POINTS;
use crate::math::{direction, length};

/// Weight of nylon 3-0 per length [N/m], and its EI [N·m²].
const WEIGHT: f64 = 43e-6 * 9.806_65;
const BENDING: f64 = 2.3e-7;

/// A thread of so many links, `length` long, that leaves the swage at the origin along `heading` and was laid towards `to`; what there is of it
/// after `ticks`.
fn cantilever(links: u16, length: f32, [heading, to]: [Vec3; 2], ticks: usize) -> (Params, Thread) {
    let params = params(
        links + 1,
        length / f32::from(links),
        &[Effect::Gravity, Effect::ThreadBending],
    );
    let mut thread = Thread::new(State::laid(&params, Vec3::zeros(), to * length, Vec3::y()));
    let ends = Ends {
        swage: Some(Vec3::zeros()),
        heading,
        end_stiffness: 1e6,
        ..Ends::default()
    };
    (0..ticks).for_each(|_| tick(&params, &mut thread, &ends));
    (params, thread)
}

/// A tick in the air, with points that do not move.
fn tick(params: &Params, thread: &mut Thread, ends: &Ends) {
    condense(params, &thread.state, ends, &Air, &mut thread.work);
    settle(params, &mut thread.state, &mut thread.work, &[Vec3::zeros(); POINTS]);
}

/// From N₀ to node `index` [m].
fn apart(thread: &Thread, index: u16) -> Vec3 {
    thread.state.nodes[0].to(&thread.state.nodes[usize::from(index)])
}

/// δ = μ g L⁴/8EI = 37 µm at 20 mm. Nodes have the moments of the beam exactly, and the trapezoidal rule over moment times lever is too much by
/// 1/N² of it.
#[test]
fn a_monofilament_sags_as_a_beam() {
    let sag = WEIGHT * 0.02_f64.powi(4) / (8.0 * BENDING);
    assert!((sag / 37e-6 - 1.0).abs() < 0.01);
    for links in [5, 10] {
        let (params, mut thread) = cantilever(links, 0.02, [Vec3::x(); 2], 0);
        let ends = Ends {
            swage: Some(Vec3::zeros()),
            heading: Vec3::x(),
            end_stiffness: 1e6,
            ..Ends::default()
        };
        let mut rest = None;
        let mut before = 0.0;
        for n in 0..1000 {
            tick(&params, &mut thread, &ends);
            let now = f64::from(apart(&thread, links).z);
            rest = rest.filter(|_| (now - before).abs() < 1e-5 * sag).or(Some(n));
            before = now;
        }
        let discrete = sag * (1.0 + 1.0 / f64::from(links).powi(2));
        eprintln!(
            "{links} links: {:.3} µm of {:.3}, at rest after {rest:?} ticks",
            -1e6 * before,
            1e6 * sag
        );
        assert!((-before / sag - 1.0).abs() < 0.05, "{before} of {sag}");
        assert!((-before / discrete - 1.0).abs() < 2e-3, "{before} of {discrete}");
    }
}

/// Angle below the horizontal and place of the tip of the heavy elastica EI θ″ = −μ g (L − s) cos θ, θ(0) = 0, θ′(L) = 0 (Bernoulli, Euler), by
/// shooting in double precision: x and depth.
fn heavy_elastica(length: f64) -> [f64; 2] {
    let steps = 2000;
    let h = length / f64::from(steps);
    let slope = |s: f64, [theta, bend, ..]: [f64; 4]| {
        let load = -WEIGHT * (length - s) * theta.cos() / BENDING;
        [bend, load, theta.cos(), theta.sin()]
    };
    let shoot = |bend: f64| {
        let mut y = [0.0, bend, 0.0, 0.0];
        for n in 0..steps {
            let s = h * f64::from(n);
            let step = |k: [f64; 4], by: f64| [0, 1, 2, 3].map(|i| y[i] + by * k[i]);
            let k1 = slope(s, y);
            let k2 = slope(s + 0.5 * h, step(k1, 0.5 * h));
            let k3 = slope(s + 0.5 * h, step(k2, 0.5 * h));
            let k4 = slope(s + h, step(k3, h));
            y = [0, 1, 2, 3].map(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        }
        y
    };
    let (mut low, mut high) = (0.0, WEIGHT * length * length / (2.0 * BENDING));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let [_, left, ..] = shoot(middle);
        if left > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    let [_, _, x, depth] = shoot(low);
    [x, depth]
}

/// 100 mm of nylon 3-0 droop by a fifth of their length, 200 mm by two thirds.
#[test]
fn a_long_monofilament_droops_as_the_heavy_elastica() {
    for length in [0.1, 0.2] {
        let (_, thread) = cantilever(40, length, [Vec3::x(); 2], 3000);
        let tip = apart(&thread, 40).map(f64::from);
        let [x, depth] = heavy_elastica(f64::from(length));
        eprintln!("{length} m: {:.5} {:.5} of {x:.5} {depth:.5}", tip.x, -tip.z);
        let off = f64::hypot(tip.x - x, -tip.z - depth);
        assert!(off < 5e-3 * depth, "{off} of {depth}");
    }
}

/// An upright column falls over under its own weight from L³ = 7.837 EI/μg on, 162 mm of nylon 3-0 (Greenhill 1881).
#[test]
fn an_upright_monofilament_stands_up_to_greenhills_length() {
    let most = (7.837 * BENDING / WEIGHT).cbrt() as f32;
    let tilted = direction(Vec3::new(0.1, 0.0, 1.0), 1e-9);
    for (share, stands) in [(0.9, true), (1.1, false)] {
        let (params, thread) = cantilever(36, share * most, [Vec3::z(), tilted], 5000);
        let tip = apart(&thread, 36);
        eprintln!("{share} of {most} m: {tip:?}");
        assert_eq!(tip.x.abs() < 0.01 * most, stands, "{tip:?}");
        for pair in thread.state.nodes[..params.nodes()].windows(2) {
            assert!((length(pair[0].to(&pair[1])) / params.rest - 1.0).abs() < 1e-4);
        }
    }
}

/// A thread bent to a circle and let go: the air gets neither momentum nor, from rest, angular momentum of it.
#[test]
fn bending_has_no_net_force_and_no_net_torque() {
    let nylon = scene::Thread {
        damping_per_s: 0.0,
        ..nylon(21, 0.005)
    };
    let params = build(&nylon, 500.0, Effects::default().with(Effect::ThreadBending)).unwrap();
    let (from, to) = (Vec3::new(0.1, 0.02, -0.03), Vec3::new(0.13, 0.05, 0.01));
    let mut thread = Thread::new(State::laid(
        &params,
        from,
        to,
        direction(Vec3::new(1.0, -1.0, 0.0), 1e-9),
    ));
    // Not as symmetric as a circle.
    for node in thread.state.nodes.iter_mut().skip(12).take(9) {
        node.fine += Vec3::z() * 1e-3;
    }
    let ends = Ends {
        end_stiffness: 300.0,
        ..Ends::default()
    };
    for n in 0..50 {
        tick(&params, &mut thread, &ends);
        let all = || thread.state.live(&params).enumerate();
        let momentum: Vec3 = all().map(|(i, (_, v))| v * params.share(i)).sum();
        let size: f32 = all().map(|(i, (_, v))| length(v) * params.share(i)).sum();
        assert!(length(momentum) < 1e-4 * size, "tick {n}: {momentum:?} of {size}");
        if n == 0 {
            let place = |p: Vec3| p - from;
            let spin: Vec3 = all().map(|(i, (p, v))| place(p).cross(&v) * params.share(i)).sum();
            assert!(length(spin) < 1e-3 * size * 0.05, "{spin:?} of {size}");
        }
    }
}

/// Without weight a straight thread is at rest, and stays it where it is a decimetre off and not along an axis.
#[test]
fn a_straight_thread_does_not_bend() {
    let params = params(21, 0.005, &[Effect::ThreadBending]);
    let (from, heading) = (Vec3::new(0.11, -0.07, 0.13), Vec3::new(2.0, 3.0, 6.0) / 7.0);
    let mut thread = Thread::new(State::laid(&params, from, from + heading * 0.1, Vec3::x()));
    let ends = Ends {
        swage: Some(from),
        heading,
        end_stiffness: 300.0,
        ..Ends::default()
    };
    let before = thread.state.nodes[20];
    (0..1000).for_each(|_| tick(&params, &mut thread, &ends));
    // Each node is laid from the one before to half a unit in the last place of 0.13 m along every axis: 20 · √3 · 7.5 nm.
    let moved = length(before.to(&thread.state.nodes[20]));
    assert!(moved < 2.6e-7, "{moved} m");
}

/// A thread of 2000 nN·m², hung by its tail, swings as a rod: half a period is (T₀/2)·(2/π)K(sin θ/2), with θ the amplitude of that half and
/// T₀ = 2π √(Σ m r²/(g Σ m r)). The mean of 1 and cos θ/2 by Gauss gives K.
#[test]
fn a_stiff_thread_swings_as_a_pendulum() {
    let stiff = scene::Thread {
        damping_per_s: 0.0,
        bending_n_m2: 2e-6,
        ..nylon(21, 0.0025)
    };
    let effects = [Effect::Gravity, Effect::ThreadBending]
        .iter()
        .fold(Effects::default(), |all, e| all.with(*e));
    let params = build(&stiff, 500.0, effects).unwrap();
    let moment = |power: i32| {
        (0..20)
            .map(|i| f64::from(params.share(i)) * (0.0025 * (20 - i) as f64).powi(power))
            .sum::<f64>()
    };
    let small = 2.0 * core::f64::consts::PI * (moment(2) / (9.806_65 * moment(1))).sqrt();
    for degrees in [30.0_f32, 60.0, 90.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let free = Vec3::new(sin, 0.0, -cos) * 0.05;
        let mut thread = Thread::new(State::laid(&params, free, Vec3::zeros(), Vec3::y()));
        let ends = Ends {
            tail: Some(Vec3::zeros()),
            end_stiffness: 1e6,
            ..Ends::default()
        };
        let (mut crossings, mut amplitude, mut before) = (Vec::new(), 0.0_f64, f64::from(degrees).to_radians());
        for n in 1..2000 {
            tick(&params, &mut thread, &ends);
            let p = thread.state.nodes[0].point().map(f64::from);
            let angle = p.x.atan2(-p.z);
            if angle * before < 0.0 {
                crossings.push(f64::from(n) - angle / (angle - before));
            }
            before = angle;
            match crossings.len() {
                0 => {}
                1 => amplitude = amplitude.max(angle.abs()),
                _ => break,
            }
        }
        let half = 1e-3 * (crossings[1] - crossings[0]);
        let (mut a, mut b) = (1.0, (0.5 * amplitude).cos());
        for _ in 0..10 {
            (a, b) = (0.5 * (a + b), (a * b).sqrt());
        }
        let expected = 0.5 * small / a;
        eprintln!("{:.1}°: {half:.6} s of {expected:.6}", amplitude.to_degrees());
        assert!((half / expected - 1.0).abs() < 2e-3, "{half} of {expected}");
    }
}

/// Drawn away at 1 m/s, clamped in the needle askew.
#[test]
fn a_thread_that_bends_agrees_with_the_monolithic_solve() {
    let (params, tissue, thread) = straight_with(Effect::ThreadBending, NONE);
    let tissue = Tissue {
        heading: Vec3::new(-0.8, 0.0, 0.6),
        ..tissue
    };
    goes_taut((params, tissue, thread), NONE, 250.0);
}
