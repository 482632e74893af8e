//! The flags of `sutura moduli`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use sutura::study::moduli::{self, Curve, Request, SKIN};
use sutura_shared::scene::{Assembly, Segment};

use super::flags::{BadFlag, law, triple, within};

#[derive(Args)]
pub(crate) struct ModuliArgs {
    /// Voxels along x, y and z.
    #[arg(long, value_name = "NXxNYxNZ", default_value = "12x12x6", value_parser = triple::<'x'>)]
    block: [u32; 3],
    /// Voxel edge.
    #[arg(long, value_name = "A", default_value = "2", value_parser = within::<10, 100_000>)]
    pitch_mm: f64,
    /// Young's modulus, of a curve's first slope; 100, or what the segments say.
    #[arg(long, value_name = "E", value_parser = within::<1, 1_000_000_000>)]
    young_kpa: Option<f64>,
    /// Density in kg/m³.
    #[arg(long, value_name = "RHO", default_value = "1000", value_parser = within::<1_000, 100_000_000>)]
    density: f64,
    /// From Young's modulus to springs: isotropic, axial, paper or volume.
    #[arg(long, default_value = "isotropic")]
    law: String,
    /// Poisson's ratio; law volume.
    #[arg(long, value_name = "NU")]
    poisson: Option<f32>,
    /// What voxels that share an edge give it: per-voxel or every-edge.
    #[arg(long, default_value = "per-voxel")]
    assembly: Assembly,
    /// Measures a stress-strain curve from -30 % to 60 % too.
    #[arg(long)]
    curve: bool,
    /// The curve: strains and the slopes that begin there; without it skin, scaled to Young's modulus.
    #[arg(long, value_name = "STRAIN:KPA,...", value_parser = segments)]
    segments: Option<Segments>,
    /// Folder for moduli.csv and moduli.png of a curve [default: sutura-out].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// The result as one JSON object on the last line of stdout.
    #[arg(long)]
    json: bool,
}

/// Segments of a curve; a type of its own, for a list of flags would take one segment each.
#[derive(Clone, Debug)]
struct Segments(Vec<Segment>);

/// Young's modulus where nothing is said [kPa].
const YOUNG_KPA: f64 = 100.0;
const OUT: &str = "sutura-out";

/// Measures.
pub(crate) fn run(args: &ModuliArgs) -> ExitCode {
    let request = match request(args) {
        Ok(request) => request,
        Err(error) => return crate::fail(&error, args.json, 2),
    };
    match moduli::run(&request) {
        Ok(report) if args.json => crate::print_json(&report),
        Ok(report) => crate::say(format_args!("{report}\n")),
        Err(error) => return crate::fail(&error, args.json, error.exit_code()),
    }
    ExitCode::SUCCESS
}

fn request(args: &ModuliArgs) -> Result<Request, BadFlag> {
    let needs_curve = |flag: &str| BadFlag(format!("{flag} changes nothing without --curve"));
    match (args.curve, &args.segments, &args.out) {
        (false, Some(_), _) => return Err(needs_curve("--segments")),
        (false, None, Some(_)) => return Err(needs_curve("--out")),
        _ => {}
    }
    let first_pa = args
        .segments
        .as_ref()
        .and_then(|Segments(all)| all.first())
        .map(|first| f64::from(first.slope_pa));
    let young_pa = match (first_pa, args.young_kpa.map(|kpa| kpa * 1e3)) {
        (Some(first), Some(young)) if (first / young - 1.0).abs() > 1e-6 => {
            let kpa = first * 1e-3;
            return Err(BadFlag(format!(
                "--young-kpa: {kpa} is needed beside --segments that begin with it, or none"
            )));
        }
        (first, young) => first.or(young).unwrap_or(YOUNG_KPA * 1e3),
    };
    let skin = || {
        let scaled = SKIN.map(|(from_strain, slope)| Segment {
            from_strain,
            slope_pa: slope * young_pa as f32,
        });
        scaled.to_vec()
    };
    let curve = args.curve.then(|| Curve {
        segments: args.segments.as_ref().map_or_else(skin, |Segments(all)| all.clone()),
        out: args.out.clone().unwrap_or_else(|| OUT.into()),
    });
    Ok(Request {
        voxels: args.block,
        pitch_m: args.pitch_mm * 1e-3,
        young_pa,
        density_kg_m3: args.density,
        law: law(&args.law, args.poisson)?,
        assembly: args.assembly,
        curve,
    })
}

fn segments(text: &str) -> Result<Segments, String> {
    let one = |part: &str| {
        let (strain, slope) = part.split_once(':')?;
        Some(Segment {
            from_strain: strain.parse().ok()?,
            slope_pa: slope.parse::<f32>().ok()? * 1e3,
        })
    };
    let all: Option<Vec<_>> = text.split(',').map(one).collect();
    all.map(Segments)
        .ok_or_else(|| "strains and slopes are needed, such as 0:281,0.3:1700,0.6:3660".to_owned())
}
