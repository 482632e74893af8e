//! The stress–strain curve of a block beside the asked one.

use serde::Serialize;
use sutura_shared::check::{Invalid, Validate};
use sutura_shared::scene::{Body, SEGMENTS_MAX, Segment};

use super::super::block::{self, Block, Spec};
use super::super::double::NoEquilibrium;
use super::Error;
use super::probe::Probe;

/// Skin after Daly's curve, in the segments of Lian & Chen Fig. 3: strain at which each begins, and its slope over the first.
pub const SKIN: [(f32, f32); 3] = [(0.0, 1.0), (0.3, 1700.0 / 281.0), (0.6, 3660.0 / 281.0)];

/// Hundredths of strain that are measured, in compression and in tension, from rest on.
const COMPRESSED: [i8; 12] = [-2, -5, -7, -10, -12, -15, -17, -20, -22, -25, -27, -30];
const STRETCHED: [i8; 24] = [
    2, 5, 7, 10, 12, 15, 17, 20, 22, 25, 27, 30, 32, 35, 37, 40, 42, 45, 47, 50, 52, 55, 57, 60,
];

/// One strain of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Nominal strain.
    pub strain: f64,
    /// Nominal stress of the asked curve, its first slope in compression [kPa].
    pub asked_kpa: f64,
    /// The block's [kPa].
    pub measured_kpa: f64,
}

/// A measured curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fit {
    /// From −30 % to 60 % strain.
    pub points: Vec<Point>,
    /// Largest relative difference from the asked stress in tension.
    pub tension_error: f64,
    /// The same in compression.
    pub compression_error: f64,
}

/// A block of one tissue whose springs follow `segments`.
pub(super) fn block(spec: &Spec, segments: &[Segment]) -> Result<Block, Error> {
    let mut scene = block::scene(spec);
    if segments.len() > SEGMENTS_MAX {
        return Err(Error::Invalid(Invalid {
            field: "tissue.curve",
            expected: "at most 5 segments",
        }));
    }
    for tissue in &mut scene.tissues {
        if let Body::Soft { curve, .. } = &mut tissue.body {
            *curve = segments.iter().copied().collect();
        }
    }
    scene.validate().map_err(Error::Invalid)?;
    let cells = vec![1; scene.lattice.count()];
    Ok(Block::of(&scene, &cells)?)
}

/// Stretches and compresses the block along z.
pub(super) fn measure(probe: &Probe, segments: &[Segment]) -> Result<Fit, NoEquilibrium> {
    let branch = |hundredths: &[i8]| -> Result<Vec<Point>, NoEquilibrium> {
        let strains = hundredths.iter().map(|n| f64::from(*n) * 0.01);
        let stresses = probe.stresses(strains.clone())?;
        let points = strains.zip(stresses).map(|(strain, stress)| Point {
            strain,
            asked_kpa: asked_pa(segments, strain) * 1e-3,
            measured_kpa: stress * 1e-3,
        });
        Ok(points.collect())
    };
    let (compressed, stretched) = (branch(&COMPRESSED)?, branch(&STRETCHED)?);
    let worst = |points: &[Point]| {
        let off = points
            .iter()
            .map(|point| (point.measured_kpa / point.asked_kpa - 1.0).abs());
        off.fold(0.0, f64::max)
    };
    Ok(Fit {
        tension_error: worst(&stretched),
        compression_error: worst(&compressed),
        points: compressed.into_iter().rev().chain(stretched).collect(),
    })
}

/// Stress of a curve at a strain, on the first slope below zero [Pa].
fn asked_pa(segments: &[Segment], strain: f64) -> f64 {
    let ends = segments.iter().skip(1).map(|segment| f64::from(segment.from_strain));
    let pieces = segments.iter().zip(ends.chain([f64::INFINITY]));
    let pieces = pieces.enumerate().map(|(n, (segment, end))| {
        let over = strain.min(end) - f64::from(segment.from_strain);
        f64::from(segment.slope_pa) * if n == 0 { over } else { over.max(0.0) }
    });
    pieces.sum()
}
