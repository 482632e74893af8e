//! The flags of `sutura poke`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use sutura::scene::setting::Setting;
use sutura::study::block::Spec;
use sutura::study::method::Method;
use sutura::study::path::{Course, Path};
use sutura::study::poke::{self, Report, Request};
use sutura_controller::lanes::Level;
use sutura_shared::scene::Assembly;

use super::flags::{BadFlag, law, simd, triple, within};

// Each is a flag of the command line.
#[allow(clippy::struct_excessive_bools)]
#[derive(Args)]
pub(crate) struct PokeArgs {
    /// Nodes along x, y and z.
    #[arg(long, value_name = "NXxNYxNZ", default_value = "16x16x8", value_parser = triple::<'x'>)]
    nodes: [u32; 3],
    /// Voxel edge.
    #[arg(long, value_name = "A", default_value = "2", value_parser = within::<1, 100_000>)]
    pitch_mm: f64,
    /// Young's modulus of the first slope.
    #[arg(long, value_name = "E", default_value = "100", value_parser = within::<1, 1_000_000_000>)]
    young_kpa: f64,
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
    /// Mass of a node: ρa³, or what its voxels give it.
    #[arg(long, value_enum, default_value = "uniform")]
    mass: Mass,
    /// Slopes 1 : 4 : 10 with breaks at strains of 3 and 6 %.
    #[arg(long)]
    stiffening: bool,
    /// Way of the moved node.
    #[arg(long, value_enum, default_value = "lift")]
    path: Way,
    /// How far the node is lifted; path lift.
    #[arg(long, value_name = "MM", value_parser = within::<-100_000, 100_000>, allow_negative_numbers = true)]
    lift_mm: Option<f64>,
    /// The moved node, counted from 0; without it the middle of the top.
    #[arg(long, value_name = "I,J,K", value_parser = triple::<','>)]
    node: Option<[u32; 3]>,
    /// explicit[:substeps], be-pcg[:iterations[:newton]], be-chebyshev[:iterations], vbd[:sweeps[:omega]], or to compare xpbd[:substeps],
    /// pd[:iterations]. auto:<µs> takes the most accurate within that time on this machine.
    #[arg(long, default_value = "be-pcg")]
    solver: Setting<Method>,
    /// Time in which the path grows to its full size.
    #[arg(long, value_name = "T", default_value = "100", value_parser = within::<0, 60_000_000>)]
    ramp_ms: f64,
    /// How long.
    #[arg(long, value_name = "T", default_value = "400", value_parser = clap::value_parser!(u32).range(1..=i64::from(poke::TICKS_MAX)))]
    run_ms: u32,
    /// File for the places of all nodes at the end.
    #[arg(long, value_name = "OUT.csv")]
    positions: Option<PathBuf>,
    /// File for the reaction of the moved node at every tick.
    #[arg(long, value_name = "OUT.csv")]
    forces: Option<PathBuf>,
    /// Compares with the converged solution in double precision.
    #[arg(long)]
    reference: bool,
    /// Instructions to run on, instead of the best this processor has: off, sse2, avx2 or avx512. Results are the same.
    #[arg(long, value_name = "LEVEL", value_parser = simd)]
    simd: Option<Level>,
    /// The result as one JSON object on the last line of stdout.
    #[arg(long)]
    json: bool,
}

/// Mass of a node.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Mass {
    Uniform,
    PerVoxel,
}

/// Name of a path.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Way {
    Lift,
    Drag,
    Tap,
}

/// How far a node is lifted where nothing is said [mm].
const LIFT_MM: f64 = 5.0;

/// Pokes.
pub(crate) fn run(args: &PokeArgs) -> ExitCode {
    let request = match request(args) {
        Ok(request) => request,
        Err(error) => return crate::fail(&error, args.json, 2),
    };
    match poke(args, request) {
        Ok(report) if args.json => crate::print_json(&report),
        Ok(report) => crate::say(format_args!("{report}\n")),
        Err(error) => return crate::fail(&error, args.json, error.exit_code()),
    }
    ExitCode::SUCCESS
}

fn poke(args: &PokeArgs, mut request: Request) -> Result<Report, poke::Error> {
    let interrupted = crate::interrupt();
    let auto = match args.solver {
        Setting::Fixed(_) => None,
        Setting::Auto { budget_us } => {
            let table = poke::choose(&request, budget_us, &interrupted)?;
            request.method = Method::Controller(table.solver);
            Some(table.auto)
        }
    };
    let bar = if args.reference {
        ProgressBar::new(u64::from(args.run_ms))
    } else {
        ProgressBar::hidden()
    };
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} ticks of the converged solution, {eta} left")
    {
        bar.set_style(style);
    }
    let report = poke::run(&request, &interrupted, |tick, _| bar.set_position(u64::from(tick)));
    bar.finish_and_clear();
    Ok(Report { auto, ..report? })
}

fn request(args: &PokeArgs) -> Result<Request, BadFlag> {
    let path = match (args.path, args.lift_mm) {
        (Way::Lift, lift) => Path::Lift {
            lift_m: lift.unwrap_or(LIFT_MM) * 1e-3,
        },
        (_, Some(_)) => return Err(BadFlag("--lift-mm changes nothing without --path lift".into())),
        (Way::Drag, None) => Path::Drag,
        (Way::Tap, None) => Path::Tap,
    };
    Ok(Request {
        block: Spec {
            nodes: args.nodes,
            pitch_m: args.pitch_mm * 1e-3,
            young_pa: args.young_kpa * 1e3,
            density_kg_m3: args.density,
            law: law(&args.law, args.poisson)?,
            assembly: args.assembly,
            stiffening: args.stiffening,
            damping_per_s: poke::DAMPING_PER_S,
        },
        mass_per_voxel: args.mass == Mass::PerVoxel,
        node: args.node,
        level: args.simd.unwrap_or_else(Level::best),
        course: Course {
            path,
            ramp_s: args.ramp_ms * 1e-3,
        },
        ticks: args.run_ms,
        method: match args.solver {
            Setting::Fixed(method) => method,
            Setting::Auto { .. } => Method::default(),
        },
        reference: args.reference,
        positions: args.positions.clone(),
        forces: args.forces.clone(),
    })
}
