//! The `sutura` program: arguments in, results on stdout, everything else on stderr.

mod cli;

use std::io::{ErrorKind, IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::{ArgGroup, Args, Parser, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};
use sutura::geometry::units::Units;
use sutura::run::vtk::Frames;
use sutura::voxelize::{self, Resolution};
use sutura::{run, scene};
use sutura_controller::lanes::Level;
use tracing_subscriber::EnvFilter;

/// Ticks from VTK frame to VTK frame where nothing else is asked for: ten frames a second.
const FRAME_EVERY: u32 = 100;

/// A haptic suture simulator: a curved needle and its thread close a wound in soft tissue.
#[derive(Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    run: RunArgs,
}

#[derive(Subcommand)]
enum Command {
    /// Runs a scene; this is what happens where no command is given.
    Run(RunArgs),
    /// Fills STL meshes with cubic cells and counts them.
    Voxelize(VoxelizeArgs),
    /// Measures the moduli of a block of tissue against what was asked for.
    Moduli(cli::moduli::ModuliArgs),
    /// Moves one node of a block of tissue and measures its reaction, its error and the time of a tick.
    Poke(cli::poke::PokeArgs),
    /// Measures what a choice of solver and law gives, in tables and pictures.
    Study {
        #[command(subcommand)]
        study: cli::study::Study,
    },
    /// Scores a recorded run.
    Score(cli::score::ScoreArgs),
    /// Shows the built-in scene.
    Scene(SceneArgs),
    /// Ticks an uploaded scene, for whoever counts its instructions.
    #[command(hide = true)]
    Ticks(cli::ticks::TicksArgs),
}

// Each is a flag of the command line.
#[allow(clippy::struct_excessive_bools)]
#[derive(Args)]
struct RunArgs {
    /// Scene file; without one the built-in scene: one stitch in a forearm.
    scene: Option<PathBuf>,
    /// Another mesh for a tissue of the scene; may be given several times.
    #[arg(long, value_name = "TISSUE=PATH", value_parser = mesh)]
    mesh: Vec<(String, PathBuf)>,
    /// Without a window.
    #[arg(long)]
    headless: bool,
    /// One second takes one second; otherwise it runs as fast as the machine allows.
    #[arg(long)]
    realtime: bool,
    /// Stops after this many seconds of simulated time.
    #[arg(long, value_name = "S", value_parser = seconds)]
    seconds: Option<f64>,
    /// Folder for the score, the tables it is made from, force.png and scene.toml, the scene as it ran.
    #[arg(long, value_name = "DIR", default_value = "sutura-out")]
    out: PathBuf,
    /// Folder for VTK files of patch, needle, thread and punctures, and run.pvd, the time series of them all, for ParaView.
    #[arg(long, value_name = "DIR")]
    vtu: Option<PathBuf>,
    /// VTK frames for each second of simulated time; a divisor of 1000. Without it 10.
    #[arg(long = "fps", value_name = "N", requires = "vtu", value_parser = cli::flags::every)]
    every: Option<u32>,
    /// Instructions to run on, instead of the best this processor has: off, sse2, avx2 or avx512. Results are the same.
    #[arg(long, value_name = "LEVEL", value_parser = cli::flags::simd)]
    simd: Option<Level>,
    /// The result as one JSON object on the last line of stdout.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
#[command(group(ArgGroup::new("resolution").required(true).args(["pitch_mm", "cells"])))]
struct VoxelizeArgs {
    /// STL files, of which the union is taken.
    #[arg(required = true, value_name = "MESH.stl")]
    meshes: Vec<PathBuf>,
    /// Edge of a cell.
    #[arg(long, value_name = "P")]
    pitch_mm: Option<f64>,
    /// Cells along the largest extent.
    #[arg(long, value_name = "N")]
    cells: Option<u32>,
    /// Unit of the files.
    #[arg(long, value_enum, default_value = "mm")]
    units: Units,
    /// The result as one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
struct SceneArgs {
    /// Prints it as commented TOML, the starting point for a scene of your own.
    #[arg(long, required = true)]
    print_default: bool,
}

fn main() -> ExitCode {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("warn"));
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .without_time()
        .with_target(false)
        .init();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() => return misused(&error),
        // Help and version.
        Err(text) => text.exit(),
    };
    match cli.command {
        None => run_scene(cli.run),
        Some(Command::Run(args)) => run_scene(args),
        Some(Command::Voxelize(args)) => count_voxels(&args),
        Some(Command::Moduli(args)) => cli::moduli::run(&args),
        Some(Command::Poke(args)) => cli::poke::run(&args),
        Some(Command::Study { study }) => cli::study::run(&study),
        Some(Command::Score(args)) => cli::score::run(&args),
        Some(Command::Ticks(args)) => cli::ticks::run(&args),
        Some(Command::Scene(_)) => {
            say(format_args!("{}", scene::BUILT_IN));
            ExitCode::SUCCESS
        }
    }
}

fn run_scene(args: RunArgs) -> ExitCode {
    tracing::debug!(headless = args.headless, realtime = args.realtime);
    let json = args.json;
    let request = run::Request {
        scene: args.scene,
        meshes: args.mesh,
        seconds: args.seconds,
        realtime: args.realtime,
        level: args.simd.unwrap_or_else(Level::best),
        out: args.out,
        frames: args.vtu.map(|folder| Frames {
            folder,
            every: args.every.unwrap_or(FRAME_EVERY),
        }),
    };
    let interrupted = interrupt();
    let bar = if std::io::stderr().is_terminal() {
        ProgressBar::new_spinner()
    } else {
        ProgressBar::hidden()
    };
    if let Ok(style) = ProgressStyle::with_template("{spinner} {prefix:>8} simulated, {elapsed} elapsed  {msg}") {
        bar.set_style(style);
    }
    let result = run::run(&request, &interrupted, |tick| {
        if tick.tick % 50 == 0 {
            bar.set_prefix(format!("{:.1} s", f64::from(tick.tick) * 1e-3));
            bar.set_message(tick.stage.name());
            bar.tick();
        }
    });
    bar.finish_and_clear();
    match result {
        Ok(report) => {
            let code = if report.faults.is_empty() {
                ExitCode::SUCCESS
            } else {
                ExitCode::from(1)
            };
            if json {
                print_json(&report);
            } else {
                say(format_args!("{report}\n"));
            }
            code
        }
        Err(error) => fail(&error, json, error.exit_code()),
    }
}

/// A flag that Ctrl+C sets.
fn interrupt() -> Arc<AtomicBool> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    if let Err(error) = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)) {
        tracing::warn!("Ctrl+C will end the program without cleaning up: {error}");
    }
    interrupted
}

fn count_voxels(args: &VoxelizeArgs) -> ExitCode {
    let resolution = match (args.pitch_mm, args.cells) {
        (Some(pitch), _) => Resolution::PitchMm(pitch),
        (None, cells) => Resolution::Cells(cells.unwrap_or_default()),
    };
    let request = voxelize::Request {
        meshes: args.meshes.clone(),
        resolution,
        units: args.units,
    };
    match voxelize::run(&request) {
        Ok(report) if args.json => print_json(&report),
        Ok(report) => {
            for warning in &report.warnings {
                tracing::warn!("{warning}");
            }
            let [x, y, z] = report.grid;
            say(format_args!(
                "{} triangles, {x} × {y} × {z} cells of {} mm\n",
                report.triangles, report.pitch_mm
            ));
            say(format_args!(
                "{} voxels, {:.1} mm³, {} nodes, {} of them on the surface\n",
                report.voxels, report.volume_mm3, report.nodes, report.surface_nodes
            ));
            say(format_args!(
                "{} edge springs, {} body diagonals, {:.0} ms\n",
                report.springs.edge, report.springs.body_diagonal, report.ms
            ));
        }
        Err(error) => return fail(&error, args.json, 2),
    }
    ExitCode::SUCCESS
}

fn print_json(value: &impl serde::Serialize) {
    match serde_json::to_string(value) {
        Ok(text) => say(format_args!("{text}\n")),
        Err(error) => eprintln!("error: {error}"),
    }
}

/// Writes to stdout. Whoever closes it has read enough: that is no error.
fn say(text: std::fmt::Arguments<'_>) {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_fmt(text).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => eprintln!("error: stdout: {error}"),
        _ => {}
    }
}

/// One line on stderr, and under `--json` an object on stdout.
fn fail(error: &dyn std::error::Error, json: bool, code: u8) -> ExitCode {
    if json {
        say(format_args!("{}\n", serde_json::json!({ "error": error.to_string() })));
    }
    eprintln!("error: {error}");
    ExitCode::from(code)
}

/// One line for arguments that are wrong: what clap says up to its advice.
fn misused(error: &clap::Error) -> ExitCode {
    let text = error.to_string();
    let lines = text.lines().take_while(|line| !line.is_empty());
    let line = lines.map(str::trim).collect::<Vec<_>>().join(" ");
    if std::env::args().any(|argument| argument == "--json") {
        let what = line.trim_start_matches("error: ");
        say(format_args!("{}\n", serde_json::json!({ "error": what })));
    }
    eprintln!("{line}");
    ExitCode::from(2)
}

fn mesh(text: &str) -> Result<(String, PathBuf), String> {
    let (tissue, path) = text
        .split_once('=')
        .ok_or("TISSUE=PATH is needed, such as skin=arm.stl")?;
    Ok((tissue.to_owned(), path.into()))
}

fn seconds(text: &str) -> Result<f64, String> {
    let most = f64::from(run::TICKS_MAX) * 1e-3;
    let range = || format!("a number of seconds from 0.001 to {most} is needed");
    text.parse()
        .ok()
        .filter(|seconds| (0.001..=most).contains(seconds))
        .ok_or_else(range)
}
