//! The work of `sutura voxelize`: reads meshes, fills their grid, counts the lattice.

use std::path::PathBuf;
use std::time::Instant;

use serde::Serialize;

use crate::geometry::Vec3;
use crate::geometry::grid::{Grid, GridError, round_up};
use crate::geometry::lattice;
use crate::geometry::mesh::Mesh;
use crate::geometry::stl::{self, StlError};
use crate::geometry::units::Units;
use crate::geometry::voxelize::inside;

/// What to voxelize, and how finely.
#[derive(Clone, Debug)]
pub struct Request {
    /// STL files, of which the union is taken; at least one.
    pub meshes: Vec<PathBuf>,
    /// How finely.
    pub resolution: Resolution,
    /// Unit of all files.
    pub units: Units,
}

/// How the size of a cell is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// Edge of a cell [mm].
    PitchMm(f64),
    /// Cells along the largest extent of all meshes together.
    Cells(u32),
}

/// What came out; the keys of `--json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Triangles of all meshes.
    pub triangles: usize,
    /// Edge of a cell [mm].
    pub pitch_mm: f64,
    /// Cells along x, y and z.
    pub grid: [usize; 3],
    /// Cells inside.
    pub voxels: usize,
    /// Corners of voxels.
    pub nodes: usize,
    /// Corners of voxel faces with no voxel on the other side.
    pub surface_nodes: usize,
    /// Springs of the lattice.
    pub springs: Springs,
    /// Volume of the voxels [mm³].
    pub volume_mm3: f64,
    /// Rows whose signed crossings do not balance, over all meshes.
    pub unbalanced_rows: usize,
    /// What was wrong with the files, one line each.
    pub warnings: Vec<String>,
    /// Wall-clock time of the voxelization alone [ms].
    pub ms: f64,
}

/// Springs of a lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Springs {
    /// Distinct edges of voxels.
    pub edge: usize,
    /// Four for each voxel.
    pub body_diagonal: usize,
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No file given.
    #[error("no mesh: name at least one STL file")]
    NoMesh,
    /// `--cells 0`.
    #[error("0 cells along the largest extent: 1 or more are needed")]
    NoCells,
    /// A file could not be read.
    #[error(transparent)]
    Stl(#[from] StlError),
    /// There is no such grid.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// No cell centre is inside.
    #[error("pitch {pitch_mm} mm gives no voxel: no cell centre is inside a surface of {} × {} × {} mm; try {try_mm} mm or less", extent_mm[0], extent_mm[1], extent_mm[2])]
    NoVoxel {
        /// Edge of a cell [mm].
        pitch_mm: f64,
        /// Size of the meshes' box [mm].
        extent_mm: [f64; 3],
        /// A tenth of the smallest extent that is not zero [mm].
        try_mm: f64,
    },
}

/// Voxelizes the union of some meshes.
///
/// # Errors
/// A file is no usable STL, the grid is impossible or too large, or no cell centre is inside.
pub fn run(request: &Request) -> Result<Report, Error> {
    let mut meshes = Vec::new();
    let mut warnings = Vec::new();
    for path in &request.meshes {
        let reading = stl::read(path)?;
        warnings.extend(
            reading
                .warnings
                .iter()
                .map(|warning| format!("{}: {warning}", path.display())),
        );
        meshes.push(reading.mesh.scaled(request.units.mm()));
    }
    let [low, high] = meshes
        .iter()
        .filter_map(Mesh::bounds)
        .reduce(|[low, high], [l, h]| [low.inf(&l), high.sup(&h)])
        .ok_or(Error::NoMesh)?;
    let pitch = match request.resolution {
        Resolution::PitchMm(pitch) => pitch,
        Resolution::Cells(0) => return Err(Error::NoCells),
        Resolution::Cells(cells) => (high - low).max() / f64::from(cells),
    };
    let grid = Grid::covering([low, high], pitch)?;
    let started = Instant::now();
    let mut mask = vec![0; grid.len()];
    let mut unbalanced_rows = 0;
    for mesh in &meshes {
        let inside = inside(mesh, &grid);
        unbalanced_rows += inside.unbalanced_rows;
        mask.iter_mut().zip(&inside.mask).for_each(|(all, one)| *all |= one);
    }
    let ms = started.elapsed().as_secs_f64() * 1e3;
    let counts = lattice::count(&mask, grid.cells);
    if counts.voxels == 0 {
        return Err(no_voxel(pitch, high - low));
    }
    Ok(Report {
        triangles: meshes.iter().map(|mesh| mesh.triangles.len()).sum(),
        pitch_mm: pitch,
        grid: grid.cells,
        voxels: counts.voxels,
        nodes: counts.nodes,
        surface_nodes: counts.surface_nodes,
        springs: Springs {
            edge: counts.edges,
            body_diagonal: counts.body_diagonals,
        },
        volume_mm3: counts.voxels as f64 * pitch.powi(3),
        unbalanced_rows,
        warnings,
        ms,
    })
}

fn no_voxel(pitch_mm: f64, extent: Vec3) -> Error {
    let smallest = extent
        .iter()
        .copied()
        .filter(|&e| e > 0.0)
        .fold(f64::INFINITY, f64::min)
        .min(pitch_mm);
    Error::NoVoxel {
        pitch_mm,
        extent_mm: extent.into(),
        try_mm: round_up(smallest / 10.0),
    }
}
