//! The work of `sutura moduli`: what a block of the controller's own lattice measures, beside what it was asked for.
//!
//! At small strain the stiffness at rest is solved in double precision ([`super::double`]): E from stretching the block between end plates
//! on which its nodes slide, ν from what its sides do then, G and C11 from boundaries that are moved affinely, and the stiffness in bending
//! from end plates that turn. All but ν from the energy: ½ E ε² V and its kin. A curve is solved at large strain, from strain to strain.

mod curve;
mod files;
mod probe;
mod report;

pub use curve::{Fit, Point, SKIN};
pub use report::{Bending, Measured, Report, Triple, Values};

use std::path::PathBuf;

use sutura_shared::check::Invalid;
use sutura_shared::scene::{Assembly, Law, Segment};

use self::probe::Probe;
use super::block::{self, Block, Spec};
use super::double::NoEquilibrium;
use crate::run;

/// What to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// Voxels along x, y, z.
    pub voxels: [u32; 3],
    /// Voxel edge a [m].
    pub pitch_m: f64,
    /// Young's modulus E [Pa].
    pub young_pa: f64,
    /// Density ρ [kg/m³].
    pub density_kg_m3: f64,
    /// From E to springs.
    pub law: Law,
    /// What voxels that share an edge give it.
    pub assembly: Assembly,
    /// A stress–strain curve, where one is to be measured.
    pub curve: Option<Curve>,
}

/// A stress–strain curve and where its measurement goes.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Segments of nominal stress against strain; the first has the request's E.
    pub segments: Vec<Segment>,
    /// Folder for moduli.csv and moduli.png.
    pub out: PathBuf,
}

/// Measures.
///
/// # Errors
/// See [`Error`].
pub fn run(request: &Request) -> Result<Report, Error> {
    let mut spec = Spec {
        nodes: request.voxels.map(|n| n.saturating_add(1)),
        pitch_m: request.pitch_m,
        young_pa: request.young_pa,
        density_kg_m3: request.density_kg_m3,
        law: request.law,
        assembly: request.assembly,
        stiffening: false,
        damping_per_s: 0.0,
    };
    let probe = Probe::new(&Block::new(&spec)?);
    spec.stiffening = request.curve.is_some();
    let stiffening = match &request.curve {
        Some(Curve { segments, .. }) => Some((Probe::new(&curve::block(&spec, segments)?), segments)),
        None => None,
    };
    let followed = stiffening.as_ref().map_or(&probe, |(probe, _)| probe);
    let mut report = Report::new(request, &probe.measure()?, followed.stable_step_s());
    if let (Some((probe, segments)), Some(Curve { out, .. })) = (&stiffening, &request.curve) {
        let fit = curve::measure(probe, segments)?;
        let [x, y, z] = request.voxels;
        let title = format!("{x} × {y} × {z} voxels, law {}", request.law.name());
        files::write(out, &title, &fit)?;
        report.curve = Some(fit);
        report.out = Some(out.display().to_string());
    }
    Ok(report)
}

/// Why nothing can be measured; one line each.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The block.
    #[error(transparent)]
    Block(#[from] block::Error),
    /// The controller would refuse the curve.
    #[error("{}: what is needed is {}", _0.field, _0.expected)]
    Invalid(Invalid),
    /// The block does not come to rest.
    #[error(transparent)]
    Solve(#[from] NoEquilibrium),
    /// A file.
    #[error(transparent)]
    Files(#[from] run::files::Error),
}

impl Error {
    /// Of a program that ends with this error.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Solve(_) => 1,
            Self::Block(_) | Self::Invalid(_) | Self::Files(_) => 2,
        }
    }
}

#[cfg(test)]
mod tests;
