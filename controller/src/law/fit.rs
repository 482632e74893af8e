//! The springs' breakpoints, from the stress–strain curve that a block of them is to follow.
//!
//! One voxel stretched by λ along an axis, with free sides that come to μ, in uniaxial nominal stress
//! S = k_n φ_n(λ − 1) + 4 k_d φ_d(e) λ/(1 + e) + Λ (J − 1) μ², where its diagonals have the strain e = √((λ² + 2μ²)/3) − 1,
//! J = λμ² and the sides balance, k_n φ_n(μ − 1) + 4 k_d φ_d(e) μ/(1 + e) + Λ (J − 1) λμ = 0. Any block of such voxels follows the same curve.
//!
//! Linear springs do not give a linear S: they swing towards the pull, which makes it 10 % too steep at 30 % strain and 20 % at 60 %.
//! So the springs' slopes have to fall within a segment of the asked curve, and no law whose slopes only rise can meet it. They stay
//! positive, which keeps the energy convex; what majorises a spring is its steepest slope ([`super::Breaks::steepest`]).
//! Edges and diagonals take the same rises, where they are when the voxel is at the same strain. A spring's segment may run until S
//! strays from the asked curve by [`WITHIN`]; the next one is as flat as lets S stay within that on the other side.

use super::Stiffness;
use super::breaks::{BREAKS, Breaks};
use crate::math::sqrt;
use heapless::Vec;
use sutura_shared::scene::{SEGMENTS_MAX, Segment};

/// How far S may stray from the asked stress before a spring's segment ends, relative to it.
const WITHIN: f32 = 0.025;
/// How far S may stray over a whole segment before that is broken at all.
const LIMIT: f32 = 0.028;
/// What S has to stray by beyond [`WITHIN`] to end a segment: more than rounding.
const CLEAR: f32 = 1e-3;
/// Strain up to which the curve is met; beyond it no segment is broken.
const STRAIN_MAX: f32 = 0.6;
/// Strain of compression down to which the first slope is met.
const STRAIN_MIN: f32 = -0.3;
/// How far S may stray in compression before the edges break, and what is left of it at [`STRAIN_MIN`] if they do.
const COMPRESSED: [f32; 2] = [0.09, 0.07];
/// Least slope of a spring over its first slope.
const FLOOR: f32 = 0.1;
/// Slots that neither the asked curve's breakpoints nor the compressed edges need.
const SPARE: usize = BREAKS - 1 - (SEGMENTS_MAX - 1);
/// Strains that are looked at within a segment.
const SAMPLES: u8 = 16;

/// Breakpoints of edges and of diagonals for segments of nominal stress against strain; locks as `diagonal_lock`.
pub(super) fn fit(segments: &[Segment], stiffness: Stiffness, diagonal_lock: (f32, f32)) -> [Breaks; 2] {
    let mut voxel = Voxel::new(stiffness, diagonal_lock);
    let asked = Asked(segments);
    // Each changes the other a little: the sides of a stretched voxel are compressed.
    for _ in 0..2 {
        stretch(&mut voxel, asked);
        compress(&mut voxel, asked);
    }
    [voxel.edge, voxel.diagonal]
}

/// Sets the breakpoints of stretched springs, slots from 1.
fn stretch(voxel: &mut Voxel, asked: Asked<'_>) {
    for slot in 1..BREAKS {
        voxel.bend(slot, [0.0; 2], 0.0);
    }
    let (mut at, mut slot, mut spare) = (0.0, 0, SPARE);
    for stop in asked.stops() {
        while at < stop {
            let met = if at < STRAIN_MAX { stop.min(STRAIN_MAX) } else { stop };
            if slot > 0 {
                turn(voxel, asked, slot, [at, met]);
            }
            slot += 1;
            at = match voxel.reach(asked, [at, met]) {
                Some(short) if spare > 0 && at < STRAIN_MAX => {
                    spare -= 1;
                    short
                }
                _ => stop,
            };
        }
    }
}

/// Sets breakpoint `slot` at `from`: so that S meets the asked stress at `stop`, or at least goes there without falling below it by more
/// than [`WITHIN`].
fn turn(voxel: &mut Voxel, asked: Asked<'_>, slot: usize, [from, stop]: [f32; 2]) {
    let places = [from, voxel.at(from).diagonal];
    let with = |rise: f32| {
        let mut voxel = *voxel;
        voxel.bend(slot, places, rise);
        voxel
    };
    let range = [FLOOR - voxel.edge.last_slope(), 2.0 * asked.steepest()];
    let meets = least(range, |rise| with(rise).stray(asked, stop) > 0.0);
    let holds = |rise: f32| {
        let voxel = with(rise);
        let strays = samples(from, stop).map(|strain| voxel.stray(asked, strain));
        strays.take_while(|stray| *stray < WITHIN).all(|stray| stray > -WITHIN)
    };
    let arched = samples(from, stop).any(|strain| with(meets).stray(asked, strain) > WITHIN);
    let rise = if arched || !holds(meets) {
        least(range, holds)
    } else {
        meets
    };
    *voxel = with(rise);
}

/// Sets the one breakpoint of compressed edges, slot 0: nearly incompressible voxels stiffen as λ − 1/λ² does, and what they stiffen the
/// edges give up.
fn compress(voxel: &mut Voxel, asked: Asked<'_>) {
    let [within, left] = COMPRESSED;
    voxel.edge.set(0, 0.0, 0.0);
    let Some(far) = samples(0.0, STRAIN_MIN).position(|strain| voxel.stray(asked, strain).abs() > within) else {
        return;
    };
    let at = samples(0.0, STRAIN_MIN)
        .nth(far.saturating_sub(1))
        .unwrap_or(STRAIN_MIN);
    let over = voxel.stray(asked, STRAIN_MIN).clamp(-left, left);
    let rise = least([FLOOR - 1.0, 2.0], |rise| {
        let mut voxel = *voxel;
        voxel.edge.set(0, at, rise);
        voxel.stray(asked, STRAIN_MIN) > over
    });
    voxel.edge.set(0, at, rise);
}

/// The least number of a range, by halving, for which what holds for all greater ones holds.
fn least([mut low, mut high]: [f32; 2], holds: impl Fn(f32) -> bool) -> f32 {
    for _ in 0..24 {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

/// Strains from beyond `from` to `to`.
fn samples(from: f32, to: f32) -> impl Iterator<Item = f32> {
    (1..=SAMPLES).map(move |n| from + (to - from) * f32::from(n) / f32::from(SAMPLES))
}

/// A curve of nominal stress over its first slope.
#[derive(Clone, Copy)]
struct Asked<'a>(&'a [Segment]);

impl Asked<'_> {
    fn first(self) -> f32 {
        self.0.first().map_or(1.0, |segment| segment.slope_pa)
    }

    fn steepest(self) -> f32 {
        self.0.last().map_or(1.0, |segment| segment.slope_pa / self.first())
    }

    fn stress(self, strain: f32) -> f32 {
        let rises = self.0.windows(2).filter_map(|pair| match pair {
            [before, after] => Some((after.from_strain, after.slope_pa - before.slope_pa)),
            _ => None,
        });
        rises.fold(strain, |sum, (at, rise)| {
            sum + rise / self.first() * (strain - at).max(0.0)
        })
    }

    /// Strains that a spring's segment may not go past: the curve's own breakpoints, and the end of the last segment.
    fn stops(self) -> Vec<f32, SEGMENTS_MAX> {
        let own = self.0.iter().skip(1).map(|segment| segment.from_strain);
        let last = own.clone().next_back().unwrap_or(0.0);
        own.take(SEGMENTS_MAX - 1).chain([STRAIN_MAX.max(last + 0.2)]).collect()
    }
}

/// One voxel in uniaxial stress.
#[derive(Clone, Copy)]
struct Voxel {
    stiffness: Stiffness,
    /// Young's modulus along an axis over the nominal one.
    modulus: f32,
    edge: Breaks,
    diagonal: Breaks,
}

/// A voxel at some strain.
struct Stretched {
    /// Nominal stress over the nominal Young's modulus.
    stress: f32,
    /// Strain of its diagonals.
    diagonal: f32,
}

impl Voxel {
    fn new(stiffness: Stiffness, diagonal_lock: (f32, f32)) -> Self {
        let c12 = 4.0 / 3.0 * stiffness.diagonal + stiffness.volume;
        let c11 = stiffness.edge + c12;
        Self {
            stiffness,
            modulus: (c11 - c12) * (c11 + 2.0 * c12) / (c11 + c12),
            edge: Breaks::default(),
            diagonal: Breaks {
                lock: diagonal_lock,
                ..Breaks::default()
            },
        }
    }

    /// Sets a breakpoint of edges and of diagonals.
    fn bend(&mut self, slot: usize, [edge, diagonal]: [f32; 2], rise: f32) {
        self.edge.set(slot, edge, rise);
        self.diagonal.set(slot, diagonal, rise);
    }

    fn at(&self, strain: f32) -> Stretched {
        let Stiffness {
            edge, diagonal, volume, ..
        } = self.stiffness;
        let along = 1.0 + strain;
        let diagonals = |across: f32| {
            let strain = sqrt((along * along + 2.0 * across * across) / 3.0) - 1.0;
            let pull = 4.0 * diagonal * self.diagonal.tension(strain) / (1.0 + strain);
            (strain, pull)
        };
        let grown = |across: f32| volume * (along * across * across - 1.0) * across;
        let across = least([0.2, 2.0], |across| {
            let sides = edge * self.edge.tension(across - 1.0);
            sides + diagonals(across).1 * across + grown(across) * along > 0.0
        });
        let (strained, pull) = diagonals(across);
        Stretched {
            stress: edge * self.edge.tension(strain) + pull * along + grown(across) * across,
            diagonal: strained,
        }
    }

    /// Relative difference of S from the asked stress.
    fn stray(&self, asked: Asked<'_>, strain: f32) -> f32 {
        self.at(strain).stress / (self.modulus * asked.stress(strain)) - 1.0
    }

    /// The strain from which the rest of the way to `stop` strays too far; `None` if it does not.
    fn reach(&self, asked: Asked<'_>, [from, stop]: [f32; 2]) -> Option<f32> {
        let beyond = |limit: f32| samples(from, stop).position(|strain| self.stray(asked, strain).abs() > limit);
        beyond(LIMIT)?;
        let far = beyond(WITHIN + CLEAR)?.max(1);
        samples(from, stop).nth(far - 1)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::law::stiffness;
    use std::eprintln;
    use sutura_shared::scene::Law;

    const LAWS: [Law; 6] = [
        Law::Isotropic,
        Law::Axial,
        Law::Paper,
        Law::Volume { poisson: 0.3 },
        Law::Volume { poisson: 0.45 },
        Law::Volume { poisson: 0.49 },
    ];

    type Pairs = [(f32, f32)];

    /// A line, skin and muscle of the built-in scene, a curve that is steep early, and one that is steep very late.
    const CURVES: [(&str, &Pairs); 5] = [
        ("line", &[(0.0, 100e3)]),
        ("skin", &[(0.0, 281e3), (0.3, 1.7e6), (0.6, 3.66e6)]),
        (
            "muscle",
            &[(0.0, 26e3), (0.1, 43e3), (0.2, 70e3), (0.3, 117e3), (0.4, 192e3)],
        ),
        ("early", &[(0.0, 100e3), (0.03, 400e3), (0.06, 1e6)]),
        ("late", &[(0.0, 100e3), (0.4, 150e3), (1.2, 900e3)]),
    ];

    fn segments(pairs: &Pairs) -> Vec<Segment, SEGMENTS_MAX> {
        let pairs = pairs.iter();
        pairs
            .map(|&(from_strain, slope_pa)| Segment { from_strain, slope_pa })
            .collect()
    }

    fn fitted(segments: &[Segment], law: Law) -> Voxel {
        let mut voxel = Voxel::new(stiffness(law), (0.045, 1000.0));
        [voxel.edge, voxel.diagonal] = fit(segments, stiffness(law), voxel.diagonal.lock);
        voxel
    }

    fn worst(voxel: &Voxel, asked: Asked<'_>, to: f32) -> f32 {
        let strains = (1..=300_u16).map(|n| to * f32::from(n) / 300.0);
        strains
            .map(|strain| voxel.stray(asked, strain).abs())
            .fold(0.0, f32::max)
    }

    /// What a nearly incompressible voxel cannot do: its sides are stretched by the square root of what its height loses, against springs that
    /// follow the asked curve there, and a spring in compression has no more to give up than its own force.
    fn allowed_in_compression(name: &str, law: Law) -> f32 {
        match (name, law) {
            ("muscle", Law::Volume { poisson: 0.45 }) => 0.18,
            ("early", Law::Volume { poisson: 0.45.. }) | (_, Law::Volume { poisson: 0.49 }) => f32::INFINITY,
            _ => 0.1,
        }
    }

    #[test]
    fn a_voxel_follows_the_asked_curve() {
        for (name, pairs) in CURVES {
            let segments = segments(pairs);
            for law in LAWS {
                let voxel = fitted(&segments, law);
                let [stretched, compressed] = [STRAIN_MAX, STRAIN_MIN].map(|to| worst(&voxel, Asked(&segments), to));
                let breaks = voxel.edge.rise.iter().filter(|rise| rise.abs() > 0.0).count();
                eprintln!(
                    "{name}, {law:?}: {:.1} % in tension, {:.1} % in compression, {breaks} breakpoints",
                    100.0 * stretched,
                    100.0 * compressed
                );
                assert!(stretched < 0.03, "{name}, {law:?}: {stretched}");
                let allowed = allowed_in_compression(name, law);
                assert!(compressed < allowed, "{name}, {law:?}: {compressed}");
            }
        }
    }

    /// The energy is convex, and the steepest slope is the steepest of all segments.
    #[test]
    fn slopes_stay_positive() {
        for (_, pairs) in CURVES {
            for law in LAWS {
                let voxel = fitted(&segments(pairs), law);
                let lock = (0.0, 0.0);
                for breaks in [voxel.edge, voxel.diagonal].map(|breaks| Breaks { lock, ..breaks }) {
                    let slope = |strain: f32| (breaks.tension(strain + 1e-3) - breaks.tension(strain)) / 1e-3;
                    let range = |from: i16, to: i16| (from..to).map(|n| 1e-3 * f32::from(n));
                    assert!(range(-500, 1500).all(|strain| slope(strain) > 0.9 * FLOOR));
                    let steepest = range(-500, 1500).map(slope).fold(1.0, f32::max);
                    assert!(
                        (steepest / breaks.steepest() - 1.0).abs() < 5e-3,
                        "{steepest}, {}",
                        breaks.steepest()
                    );
                }
            }
        }
    }

    /// Small strain of the isotropic lattice: ν = 1/4, diagonals take (1 − 2ν)/3 = 1/6 of the axial strain. At 60 % it is about a quarter.
    #[test]
    fn diagonals_take_their_share_of_the_strain() {
        let voxel = Voxel::new(stiffness(Law::Isotropic), (0.0, 0.0));
        for (strain, share, within) in [(0.01, 1.0 / 6.0, 2e-3), (0.6, 0.25, 0.02)] {
            let measured = voxel.at(strain).diagonal / strain;
            assert!((measured - share).abs() < within, "{strain}: {measured}");
        }
    }
}
