//! One spring, in lanes: its length from displacements, and its load on its curve.
//!
//! l² = L² + q with q = δ·(δ + 2R), R the rest vector and δ the difference of the ends' displacements, and
//! l − L = q/(l + L): this keeps the digits that a difference of positions would lose.

use crate::lanes::Lanes;
use crate::lattice::{EDGES, Lattice, STEPS};
use crate::law::Material;
use crate::math::sqrt;

/// Square of the shortest length that has a direction [m²].
const SHORTEST: f32 = 1e-16;

/// A vector at both ends of springs, that at the lower node first.
pub(super) type Ends<F> = [[F; 3]; 2];

/// Springs of one direction as they are.
#[derive(Clone, Copy)]
pub(super) struct Spring<F> {
    /// From the lower node to the other [m].
    pub(super) along: [F; 3],
    /// l [m].
    pub(super) length: F,
    /// q = l² − L² [m²].
    pub(super) square: F,
    /// l (l + L) [m²].
    pub(super) product: F,
}

/// Whether direction `D` is a body diagonal.
#[inline(always)]
const fn diagonal<const D: usize>() -> bool {
    D >= EDGES
}

/// Rest length of direction `D` [m].
#[inline(always)]
pub(super) fn rest_length<const D: usize>(pitch: f32) -> f32 {
    if diagonal::<D>() { sqrt(3.0) * pitch } else { pitch }
}

/// Springs of direction `D` between nodes displaced by `near` and `far` [m].
#[inline(always)]
pub(super) fn measure<L: Lanes, const D: usize>(lanes: L, pitch: f32, near: [L::F; 3], far: [L::F; 3]) -> Spring<L::F> {
    let mut along = near;
    let mut terms = near;
    for c in 0..3 {
        let apart = far[c] - near[c];
        let rest = lanes.splat(pitch);
        match STEPS[D][c] {
            0 => (along[c], terms[c]) = (apart, apart * apart),
            1 => {
                along[c] = apart + rest;
                terms[c] = apart * (along[c] + rest);
            }
            _ => {
                along[c] = apart - rest;
                terms[c] = apart * (along[c] - rest);
            }
        }
    }
    let square = terms[0] + terms[1] + terms[2];
    let rest_square = if diagonal::<D>() {
        3.0 * pitch * pitch
    } else {
        pitch * pitch
    };
    let length_square = lanes.larger(square + lanes.splat(rest_square), lanes.splat(SHORTEST));
    let length = lanes.root(length_square);
    Spring {
        along,
        length,
        square,
        product: length_square + lanes.splat(rest_length::<D>(pitch)) * length,
    }
}

/// What springs bear at a strain.
#[derive(Clone, Copy)]
pub(super) struct Load<F> {
    /// Tension over the rest length [N/m].
    pub(super) tension: F,
    /// Slope of the tension against length [N/m].
    pub(super) slope: F,
    /// First slope [N/m].
    pub(super) stiffness: F,
}

/// The load at `strain` of the springs of direction `D` from nodes `at…`, summed over the curves that meet in a spring.
#[inline(always)]
pub(super) fn follow<L: Lanes, const D: usize, const N: usize>(
    lanes: L,
    (lattice, material): (&Lattice<N>, &Material),
    at: usize,
    strain: L::F,
) -> Load<L::F> {
    let [first, ..] = &lattice.stiffness;
    if !material.stiffening {
        let k = lanes.load(&first[D], at);
        return Load {
            tension: k * strain,
            slope: k,
            stiffness: k,
        };
    }
    let zero = lanes.splat(0.0);
    let mut load = Load {
        tension: zero,
        slope: zero,
        stiffness: zero,
    };
    let used = material.curves.iter().zip(&lattice.stiffness);
    for (curve, stiffness) in used.filter(|(curve, _)| curve.young > 0.0) {
        let k = lanes.load(&stiffness[D], at);
        let breaks = if diagonal::<D>() { &curve.diagonal } else { &curve.edge };
        let (mut tension, mut slope) = (strain, lanes.splat(1.0));
        for (start, rise) in breaks.used() {
            let over = strain - lanes.splat(start);
            let beyond = if start < 0.0 { lanes.splat(0.0) - over } else { over };
            let steeper = lanes.where_positive(beyond, lanes.splat(rise));
            tension = tension + steeper * over;
            slope = slope + steeper;
        }
        if diagonal::<D>() {
            let (start, gain) = breaks.lock;
            let under = lanes.splat(-start) - strain;
            let steeper = lanes.where_positive(under, lanes.splat(gain) * under);
            tension = tension - lanes.splat(0.5) * steeper * under;
            slope = slope + steeper;
        }
        load.tension = load.tension + k * tension;
        load.slope = load.slope + k * slope;
        load.stiffness = load.stiffness + k;
    }
    load
}

/// Largest mean slope of those springs over any change of strain up to `reach`: what majorises their energy there [N/m].
#[inline(always)]
pub(super) fn steepest<L: Lanes, const D: usize, const N: usize>(
    lanes: L,
    (lattice, material): (&Lattice<N>, &Material),
    at: usize,
    (strain, reach): (L::F, f32),
) -> L::F {
    let [first, ..] = &lattice.stiffness;
    if !material.stiffening {
        return lanes.load(&first[D], at);
    }
    let zero = lanes.splat(0.0);
    let mut sum = zero;
    let used = material.curves.iter().zip(&lattice.stiffness);
    for (curve, stiffness) in used.filter(|(curve, _)| curve.young > 0.0) {
        let breaks = if diagonal::<D>() { &curve.diagonal } else { &curve.edge };
        let mut slope = lanes.splat(1.0);
        for (start, rise) in breaks.used() {
            // A rise counts as soon as it is within reach, a fall once it is out of it.
            let early = if rise > 0.0 { reach } else { -reach };
            let over = if start < 0.0 {
                lanes.splat(start + early) - strain
            } else {
                strain - lanes.splat(start - early)
            };
            slope = slope + lanes.where_positive(over, lanes.splat(rise));
        }
        if diagonal::<D>() {
            let (start, gain) = breaks.lock;
            let under = lanes.splat(-start) - strain;
            // The slope rises linearly, so its mean in ∫∫ dε² is that at a third of the way.
            let within = lanes.larger(under, zero) + lanes.splat(reach / 3.0);
            let steeper = lanes.where_positive(under + lanes.splat(reach), lanes.splat(gain) * within);
            slope = slope + steeper;
        }
        sum = sum + lanes.load(&stiffness[D], at) * slope;
    }
    sum
}

/// Energy of those springs at `strain`, over the square of their rest length [N/m].
#[inline(always)]
pub(super) fn stored<L: Lanes, const D: usize, const N: usize>(
    lanes: L,
    (lattice, material): (&Lattice<N>, &Material),
    at: usize,
    strain: L::F,
) -> L::F {
    let half = lanes.splat(0.5);
    let [first, ..] = &lattice.stiffness;
    if !material.stiffening {
        return half * lanes.load(&first[D], at) * strain * strain;
    }
    let mut sum = lanes.splat(0.0);
    let used = material.curves.iter().zip(&lattice.stiffness);
    for (curve, stiffness) in used.filter(|(curve, _)| curve.young > 0.0) {
        let breaks = if diagonal::<D>() { &curve.diagonal } else { &curve.edge };
        let mut energy = half * strain * strain;
        for (start, rise) in breaks.used() {
            let over = strain - lanes.splat(start);
            let beyond = if start < 0.0 { lanes.splat(0.0) - over } else { over };
            energy = energy + lanes.where_positive(beyond, lanes.splat(0.5 * rise) * over * over);
        }
        if diagonal::<D>() {
            let (start, gain) = breaks.lock;
            let under = lanes.larger(lanes.splat(-start) - strain, lanes.splat(0.0));
            energy = energy + lanes.splat(gain / 6.0) * under * under * under;
        }
        sum = sum + lanes.load(&stiffness[D], at) * energy;
    }
    sum
}

/// What the springs of direction `D` from nodes `at…` pull their lower nodes with, the ends displaced by `ends` [N].
#[inline(always)]
pub(super) fn pull<L: Lanes, const D: usize, const N: usize>(
    lanes: L,
    (lattice, material): (&Lattice<N>, &Material),
    at: usize,
    [near, far]: Ends<L::F>,
) -> [L::F; 3] {
    let spring = measure::<L, D>(lanes, lattice.pitch, near, far);
    let over_length = if material.stiffening {
        let rest = lanes.splat(rest_length::<D>(lattice.pitch));
        let inverse_product = lanes.splat(1.0) / spring.product;
        let strain = spring.square * inverse_product * spring.length / rest;
        let load = follow::<L, D, N>(lanes, (lattice, material), at, strain);
        load.tension * rest * (inverse_product * (spring.length + rest))
    } else {
        let [first, ..] = &lattice.stiffness;
        lanes.load(&first[D], at) * spring.square / spring.product
    };
    let [x, y, z] = spring.along;
    [x * over_length, y * over_length, z * over_length]
}

/// What dashpots along the springs of direction `D` from nodes `at…` pull their lower nodes with, at the ends' velocities `rates` [N].
#[inline(always)]
pub(super) fn drag<L: Lanes, const D: usize, const N: usize>(
    lanes: L,
    (lattice, material): (&Lattice<N>, &Material),
    at: usize,
    (ends, rates): (Ends<L::F>, Ends<L::F>),
) -> [L::F; 3] {
    let [near, far] = ends;
    let spring = measure::<L, D>(lanes, lattice.pitch, near, far);
    let mut stiffness = lanes.splat(0.0);
    for first in &lattice.stiffness {
        stiffness = stiffness + lanes.load(&first[D], at);
    }
    let [x, y, z] = spring.along;
    let [a, b] = rates;
    let rate = x * (b[0] - a[0]) + y * (b[1] - a[1]) + z * (b[2] - a[2]);
    let over_square = lanes.splat(material.spring_damping) * stiffness * rate / (spring.length * spring.length);
    [x * over_square, y * over_square, z * over_square]
}
