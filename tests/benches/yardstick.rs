//! What our own work costs beside what the machine allows, in one table: `cargo bench -p sutura-tests --bench yardstick`.
//!
//! Times are of this machine at this hour; the ratios are what counts. It fails where a ratio is above its limit.

use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

use sutura::geometry::grid::Grid;
use sutura::geometry::stl;
use sutura::geometry::voxelize::{between_crossings, inside};
use sutura_tests::{scenario, shared, yardstick};

/// Lattices in nodes, x × y × z.
const SIZES: [[u32; 3]; 4] = [[8, 8, 4], [12, 12, 6], [16, 16, 8], [24, 24, 12]];
/// Median tick of the whole stitch over the limit for as many nodes, at most.
const STITCH: f64 = 12.0;
/// The voxelizer over a plain signed scanline, at most.
const VOXELIZER: f64 = 5.0;
/// Repeats; the machine's other work only ever makes them slower, so the fastest counts.
const REPEATS: usize = 5;
/// Cells along the bunny's largest extent.
const CELLS: f64 = 128.0;

fn main() -> ExitCode {
    limits();
    match [stitch(), voxelizer()].into_iter().collect::<Result<Vec<_>, _>>() {
        Ok(within) if within.iter().all(|within| *within) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn limits() {
    println!("{:<24} {:>8} {:>12}", "lattice", "nodes", "limit [µs]");
    for nodes @ [nx, ny, nz] in SIZES {
        let Some(limit) = yardstick::limit_us(nodes) else {
            return;
        };
        println!("{:<24} {:>8} {limit:>12.1}", format!("{nx}x{ny}x{nz}"), nx * ny * nz);
    }
}

/// The built-in scene's ticks beside the limit for its lattice, one after the other; gives whether the ratio is within its limit.
fn stitch() -> Result<bool, Box<dyn Error>> {
    let cells = scenario::built(None)?.scene.lattice.cells;
    let nodes = cells.map(|cells| u32::from(cells) + 1);
    let [nx, ny, nz] = nodes;
    let limit = yardstick::limit_us(nodes);
    let tick = scenario::run(None)?.tick_us;
    let lattice = format!("{nx}x{ny}x{nz}");
    println!();
    println!(
        "{:<24} {:>8} {:>12} {:>12} {:>12}",
        "stitch", "nodes", "limit [µs]", "median [µs]", "p99 [µs]"
    );
    let known = limit.map_or_else(String::new, |limit| format!("{limit:.1}"));
    println!(
        "{lattice:<24} {:>8} {known:>12} {:>12.1} {:>12.1}",
        nx * ny * nz,
        tick.median,
        tick.p99
    );
    Ok(limit.is_none_or(|limit| judge("median tick over the limit", tick.median / limit, STITCH)))
}

/// The whole voxelizer beside a plain signed scanline on a mesh with holes; gives whether the ratio is within its limit.
fn voxelizer() -> Result<bool, Box<dyn Error>> {
    let Some(path) = shared("the voxelizer's ratio", "data/std/bunny.stl") else {
        return Ok(true);
    };
    let mesh = stl::read(&path)?.mesh;
    let bounds = mesh.bounds().ok_or("the bunny is empty")?;
    let grid = Grid::covering(bounds, (bounds[1] - bounds[0]).max() / CELLS)?;
    let whole = fastest_ms(|| inside(&mesh, &grid).mask.len());
    let plain = fastest_ms(|| between_crossings(&mesh, &grid).len());
    println!();
    println!("{:<24} {:>21} {:>12}", "voxelizer", "scanline [ms]", "whole [ms]");
    println!("{:<24} {plain:>21.2} {whole:>12.2}", "bunny, 128 cells");
    Ok(judge("voxelizer over scanline", whole / plain, VOXELIZER))
}

/// Fastest of some repeats [ms].
fn fastest_ms(work: impl Fn() -> usize) -> f64 {
    let once = || {
        let start = Instant::now();
        std::hint::black_box(work());
        start.elapsed().as_secs_f64() * 1e3
    };
    (0..REPEATS).map(|_| once()).fold(f64::INFINITY, f64::min)
}

fn judge(what: &str, ratio: f64, limit: f64) -> bool {
    let within = ratio <= limit;
    println!(
        "{what}: {ratio:.2}, at most {limit}{}",
        if within { "" } else { ": TOO MUCH" }
    );
    within
}
