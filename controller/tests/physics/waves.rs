//! Waves and vibrations, stepped by the tissue's solver, against the speeds of an isotropic solid.
//!
//! Backward Euler turns a mode of frequency ω into q⁺⁺ = (2q⁺ − q)/(1 + s), s = ω²h²: it swings at atan(ωh)/h and loses a factor of
//! 1/√(1 + s) a tick. The law is exact, so ω is read from the ticks without an error of the time step, and that the ticks follow it is
//! tested beside.

use super::block::{Block, DENSITY, PITCH, apart, linear, scene};
use super::reference::DT;
use std::f64::consts::PI;
use sutura_controller::coupling::Coupling;
use sutura_controller::lattice::at;
use sutura_controller::solver::BePcg;
use sutura_shared::scene::Law;

/// Enough for the linear solve to add nothing of its own.
const MANY: BePcg = BePcg {
    iterations: 120,
    newton: 1,
};
/// Amplitude at first [m]; strains stay below 1e-3.
const AMPLITUDE: f64 = 5e-6;

/// A block from rest in the shape `displacement`, and in `ticks` ticks how much of that shape the nodes of `watched` still
/// have, weighted by mass: the shape's share at first and after each tick.
fn swing(block: &mut Block, displacement: impl Fn([f64; 3]) -> [f64; 3], watched: &[usize], ticks: usize) -> Vec<f64> {
    block.impose(displacement);
    let shape = block.tissue.displacement;
    let share = |block: &Block| -> [f64; 2] {
        watched.iter().fold([0.0; 2], |[with, own], n| {
            let [shape, now] = [&shape, &block.tissue.displacement].map(|field| at(field, *n).map(f64::from));
            let mass = f64::from(block.lattice.mass[*n]);
            [with + mass * shape.dot(&now), own + mass * shape.norm_squared()]
        })
    };
    let mut shares = Vec::from([1.0]);
    for _ in 0..ticks {
        block.tick(MANY, &Coupling::default(), None);
        let [with, own] = share(block);
        shares.push(with / own);
    }
    shares
}

/// Least squares of s in q⁺⁺ − 2q⁺ + q = −s q⁺⁺.
fn squared_frequency(shares: &[f64]) -> f64 {
    let sums = shares.windows(3).fold([0.0; 2], |[bent, own], q| {
        [bent - (q[2] - 2.0 * q[1] + q[0]) * q[2], own + q[2] * q[2]]
    });
    sums[0] / sums[1] / (DT * DT)
}

/// Speed of a standing wave between the two free faces across z, half a wave apart (18 pitches), with motion along `component` [m/s].
///
/// The block is 15 pitches wide; a plane wave needs it endless, and the middle does not know that it is not until pressure waves, at
/// the speed `soonest`, arrive from the sides: half that time is watched, as an implicit step runs a little ahead of the wave.
fn speed(component: usize, young: f64, soonest: f64) -> f64 {
    let mut block = Block::filled(&scene([15, 15, 9], Law::Isotropic, &[linear(young as f32)], &[]));
    block.release();
    let pitch = f64::from(PITCH);
    let wave = PI / (9.0 * pitch);
    let middle = |n: u32| n == 7 || n == 8;
    let nodes = block.nodes().filter(|(_, [i, j, _])| middle(*i) && middle(*j));
    let watched: Vec<usize> = nodes.map(|(n, _)| n).collect();
    let ticks = (0.5 * 7.0 * pitch / soonest / DT).floor() as usize;
    let standing = |[_, _, z]: [f64; 3]| {
        let mut u = [0.0; 3];
        u[component] = AMPLITUDE * (wave * z).cos();
        u
    };
    let mut shares = swing(&mut block, standing, &watched, ticks);
    // At rest before the first tick.
    shares.insert(0, 1.0);
    squared_frequency(&shares).sqrt() / wave
}

/// c = √(1.2 E/ρ) of pressure and √(0.4 E/ρ) of shear waves of the isotropic law: 10.95 and 6.32 m/s at 100 kPa. Of a plane wave along z the
/// lattice is a chain, slower by sin(ka/2)/(ka/2). Measured at 100 Pa, where ωh is below 0.1.
#[test]
fn waves_travel_at_the_speeds_of_the_solid() {
    let young = 100.0;
    let density = f64::from(DENSITY);
    let half = PI / 18.0;
    let fastest = (1.2 * young / density).sqrt();
    for (kind, component, modulus) in [("pressure", 2, 1.2), ("shear", 0, 0.4)] {
        let expected = (modulus * young / density).sqrt();
        let measured = speed(component, young, fastest);
        let chain = expected * half.sin() / half;
        eprintln!("{kind}: {measured:.5} m/s for {expected:.5}, chain {chain:.5}");
        assert!(apart(measured, expected) < 0.02, "{kind}: {measured} for {expected}");
        assert!(apart(measured, chain) < 2e-3, "{kind}: {measured} for {chain}");
    }
}

/// A bar of 2 × 2 × 60 voxels held at one end swings at f = √(E/ρ)/(4L) as backward Euler shows it: q⁺⁺ = 2|z| cos θ q⁺ − |z|² q with θ = atan(ωh)
/// and |z| = 1/√(1 + ω²h²).
#[test]
fn a_bar_vibrates_and_fades_as_backward_euler_says() {
    let young = 100e3;
    let mut block = Block::filled(&scene([2, 2, 60], Law::Isotropic, &[linear(young as f32)], &[]));
    block.release();
    let pitch = f64::from(PITCH);
    let length = 60.0 * pitch;
    let nodes: Vec<(usize, [u32; 3])> = block.nodes().collect();
    nodes
        .iter()
        .filter(|(_, [.., k])| *k == 0)
        .for_each(|(n, _)| block.lattice.free[*n] = 0.0);
    let watched: Vec<usize> = nodes.iter().map(|(n, _)| *n).collect();
    let wave = PI / (2.0 * length);
    // Sides narrow by ν of the stretch.
    let mode = |[x, y, z]: [f64; 3]| {
        let narrow = -0.25 * wave * (wave * z).cos();
        [narrow * (x - pitch), narrow * (y - pitch), (wave * z).sin()].map(|u| AMPLITUDE * u)
    };
    let shares = swing(&mut block, mode, &watched, 200);
    // Least squares of p and r in q⁺⁺ = p q⁺ − r q, once the higher modes have died out.
    let sums = shares[20..].windows(3).fold([0.0; 5], |s, q| {
        let products = [q[1] * q[1], q[1] * q[0], q[0] * q[0], q[2] * q[1], q[2] * q[0]];
        std::array::from_fn(|n| s[n] + products[n])
    });
    let determinant = sums[0] * sums[2] - sums[1] * sums[1];
    let p = (sums[3] * sums[2] - sums[4] * sums[1]) / determinant;
    let r = (sums[3] * sums[1] - sums[4] * sums[0]) / determinant;
    let (fading, frequency) = (r.sqrt(), (p / (2.0 * r.sqrt())).acos() / (2.0 * PI * DT));
    let continuous = (young / f64::from(DENSITY)).sqrt() / (4.0 * length);
    let turn = 2.0 * PI * continuous * DT;
    let (expected_fading, expected) = (1.0 / (1.0 + turn * turn).sqrt(), turn.atan() / (2.0 * PI * DT));
    eprintln!(
        "{frequency:.4} Hz for {expected:.4} (continuous {continuous:.4}); factor {fading:.6} a tick for {expected_fading:.6}"
    );
    assert!(apart(frequency, expected) < 0.02, "{frequency} for {expected}");
    assert!(
        apart(1.0 - fading, 1.0 - expected_fading) < 0.02,
        "{fading} for {expected_fading}"
    );
}
