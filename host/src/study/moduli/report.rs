//! What is said of a block: one JSON object, or some lines for people.

use std::fmt::{self, Display, Formatter};

use serde::Serialize;
use sutura_shared::scene::Law;

use super::Request;
use super::curve::Fit;
use super::probe::Elasticity;

/// The keys of `--json`.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Voxels along x, y, z.
    pub voxels: [u32; 3],
    /// Name of the law.
    pub law: &'static str,
    /// Name of the assembly.
    pub assembly: &'static str,
    /// What the law promises.
    pub asked: Values,
    /// What the block is.
    pub measured: Measured,
    /// Speed of compression waves, √(C11/ρ) [m/s].
    pub wave_m_per_s: f64,
    /// Largest stable step of an explicit scheme [µs]; with a curve, on its steepest slope.
    pub explicit_dt_max_us: f64,
    /// Bending along x across the thickness z.
    pub bending: Bending,
    /// The stress–strain curve, where one was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub curve: Option<Fit>,
    /// Folder of its files.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub out: Option<String>,
}

/// Moduli of a material.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Values {
    /// E [kPa].
    pub young_kpa: f64,
    /// ν.
    pub poisson: f64,
    /// G [kPa].
    pub shear_kpa: f64,
}

/// Moduli of a block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// E between sliding end plates [kPa].
    pub young_kpa: Triple,
    /// ν, mean over the axes.
    pub poisson: f64,
    /// G, mean over the planes [kPa].
    pub shear_kpa: f64,
}

/// One number along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Triple {
    /// Along x.
    pub x: f64,
    /// Along y.
    pub y: f64,
    /// Along z.
    pub z: f64,
}

/// How much too stiff in bending the block is, relative to a beam of its own E.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bending {
    /// Voxels through the thickness h.
    pub layers: u32,
    /// Measured.
    pub error: f64,
    /// 2/h², what fibres lumped on the nodes' layers give.
    pub formula: f64,
}

impl Values {
    /// What a law promises for Young's modulus `young_kpa`.
    #[must_use]
    pub fn of(law: Law, young_kpa: f64) -> Self {
        let poisson = match law {
            Law::Isotropic => 0.25,
            // C12/(C11 + C12) of k_n = √(2/3), k_d = 1/4: C12 = C44 = 1/3 and C11 = k_n + C12.
            Law::Axial => 1.0 / (6_f64.sqrt() + 2.0),
            // Lian & Chen take tissue as incompressible.
            Law::Paper => 0.5,
            Law::Volume { poisson } => f64::from(poisson),
        };
        let shear = match law {
            Law::Axial => 1.0 / 3.0,
            _ => 0.5 / (1.0 + poisson),
        };
        Self {
            young_kpa,
            poisson,
            shear_kpa: shear * young_kpa,
        }
    }
}

impl Report {
    pub(super) fn new(request: &Request, is: &Elasticity, step_s: f64) -> Self {
        let [_, _, layers] = request.voxels;
        let [x, y, z] = [is.young.x, is.young.y, is.young.z].map(|young| young * 1e-3);
        Self {
            voxels: request.voxels,
            law: request.law.name(),
            assembly: request.assembly.name(),
            asked: Values::of(request.law, request.young_pa * 1e-3),
            measured: Measured {
                young_kpa: Triple { x, y, z },
                poisson: is.poisson,
                shear_kpa: is.shear * 1e-3,
            },
            wave_m_per_s: is.wave,
            explicit_dt_max_us: step_s * 1e6,
            bending: Bending {
                layers,
                error: is.bending - 1.0,
                formula: 2.0 / f64::from(layers).powi(2),
            },
            curve: None,
            out: None,
        }
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.voxels;
        writeln!(
            f,
            "{x} × {y} × {z} voxels, law {}, {} assembly",
            self.law, self.assembly
        )?;
        writeln!(f, "                  asked    measured")?;
        let (asked, measured) = (self.asked, self.measured);
        let young = measured.young_kpa;
        let rows = [
            ("E along x [kPa]", asked.young_kpa, young.x),
            ("E along y [kPa]", asked.young_kpa, young.y),
            ("E along z [kPa]", asked.young_kpa, young.z),
            ("Poisson's ratio", asked.poisson, measured.poisson),
            ("G         [kPa]", asked.shear_kpa, measured.shear_kpa),
        ];
        for (name, asked, measured) in rows {
            let off = 100.0 * (measured / asked - 1.0);
            writeln!(f, "{name}  {asked:9.4}  {measured:9.4}  {off:+.2} %")?;
        }
        writeln!(f, "compression waves run at {:.2} m/s", self.wave_m_per_s)?;
        writeln!(f, "an explicit step is stable up to {:.1} µs", self.explicit_dt_max_us)?;
        write!(
            f,
            "bending along x, {} voxels thick: {:+.1} % too stiff (2/h² = {:.1} %)",
            self.bending.layers,
            100.0 * self.bending.error,
            100.0 * self.bending.formula
        )?;
        if let Some(curve) = &self.curve {
            write!(f, "\n\nstrain [%]  asked [kPa]  measured [kPa]")?;
            for point in &curve.points {
                write!(
                    f,
                    "\n{:10.0}  {:11.3}  {:14.3}  {:+.1} %",
                    100.0 * point.strain,
                    point.asked_kpa,
                    point.measured_kpa,
                    100.0 * (point.measured_kpa / point.asked_kpa - 1.0)
                )?;
            }
            write!(
                f,
                "\nwithin {:.1} % in tension, {:.1} % in compression",
                100.0 * curve.tension_error,
                100.0 * curve.compression_error
            )?;
        }
        match &self.out {
            Some(out) => write!(f, "; curve in {out}"),
            None => Ok(()),
        }
    }
}
