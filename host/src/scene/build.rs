//! From a checked scene and its meshes to what the controller takes.

use std::path::{Path, PathBuf};

use nalgebra::{Matrix3x4, Vector4};
use sutura_shared::scene::{self, Body, Lattice, Scene, Solver, Tool};

use super::file::{Mesh as MeshFile, Phantom};
use super::needle::{self, Needle};
use super::operator::{self, Operator, Place};
use super::plan::{self, Plan};
use super::reach;
use super::setting::Setting;
use crate::geometry::Vec3;
use crate::geometry::frame::Site;
use crate::geometry::lattice::{self, LatticeCounts};
use crate::geometry::mesh::Mesh;
use crate::geometry::patch::{self, Anatomy, Block, Patch, PatchError, Shell};
use crate::geometry::phantom;
use crate::geometry::stl::{self, StlError};

/// Tissue that the scene wants below what the tool reaches [pitches].
const SPARE: f64 = 1.0;

/// Reads the meshes, cuts the patch and puts the scene together; `nodes_max` is the controller's capacity.
///
/// # Errors
/// A mesh cannot be read, or there is no such patch.
pub fn build(plan: &Plan, nodes_max: usize) -> Result<Built, Error> {
    let mut warnings = Vec::new();
    let meshes = meshes(plan, &mut warnings)?;
    let patch = cut(plan, &meshes, nodes_max)?;
    warnings.extend(patch.warnings.iter().map(ToString::to_string));
    let places = rows_mm(plan)
        .map(|y_mm| place(plan, &patch, y_mm))
        .collect::<Result<Vec<_>, _>>()?;
    let hand = plan.operator.hand(plan.hand, &places);
    reach::check(plan, &places)?;
    let scene = Scene {
        effects: plan.effects,
        solver: match plan.solver {
            Setting::Fixed(solver) => solver,
            // Until a clock has chosen.
            Setting::Auto { .. } => Solver::default(),
        },
        lattice: Lattice {
            cells: patch.grid.cells.map(|cells| cells as u16),
            pitch_m: (patch.grid.pitch * 1e-3) as f32,
            origin_m: patch.origin_m().map(|part| part as f32),
            law: plan.patch.law,
            assembly: plan.patch.assembly,
            damping_per_s: plan.patch.damping_per_s,
            spring_damping_s: plan.patch.spring_damping_s,
        },
        tissues: plan.tissues.iter().map(|tissue| tissue.body.clone()).collect(),
        tool: plan.tool,
        contact: plan.contact,
        stitch: plan.stitch.map(|stitch| scene::Stitch {
            a_m: [-half_mm(plan), first_row_mm(plan)].map(|mm| (mm * 1e-3) as f32),
            count: stitch.stitches,
            spacing_m: (stitch.spacing_mm * 1e-3) as f32,
            f0_n: stitch.f0_n,
            under_m: stitch.under_m,
            friction_n_per_m: stitch.friction_n_per_m,
            cutting_n: stitch.cutting_n,
            tension_gain: stitch.tension_gain,
        }),
        thread: plan.thread,
        wound: plan.wound.map(|wound| faces(&wound, &patch)),
        output: plan.output,
        device: scene::Device {
            profile: plan.profile,
            patch_from_device: operator::patch_from_device(&hand),
        },
        hand: Some(hand),
    };
    let names = plan.tissues.iter().map(|tissue| tissue.name.clone());
    Ok(Built {
        counts: lattice::count(&patch.cells, patch.grid.cells),
        tissues: names.zip(patch.voxels.iter().copied()).collect(),
        cells: patch.cells,
        scene,
        warnings,
    })
}

/// The surface of each tissue [mm], in the scene's order.
fn meshes(plan: &Plan, warnings: &mut Vec<String>) -> Result<Vec<Option<Mesh>>, Error> {
    let folder = tempfile::tempdir().map_err(Error::Folder)?;
    let generated = match plan.phantom {
        Some(Phantom::Forearm) => phantom::write(folder.path())?.to_vec(),
        None => Vec::new(),
    };
    let named = |name: &str| {
        generated
            .iter()
            .find(|path: &&PathBuf| path.file_stem().is_some_and(|stem| stem == name))
    };
    let mut read = |path: &Path| -> Result<Mesh, Error> {
        let reading = stl::read(path)?;
        warnings.extend(
            reading
                .warnings
                .iter()
                .map(|warning| format!("{}: {warning}", path.display())),
        );
        Ok(reading.mesh)
    };
    plan.tissues
        .iter()
        .map(|tissue| match (&tissue.mesh, named(&tissue.name)) {
            (Some(file), _) => Ok(Some(placed(&read(&file.path)?, file))),
            (None, Some(path)) => Ok(Some(read(path)?)),
            (None, None) => Ok(None),
        })
        .collect()
}

/// A mesh in the scene's frame [mm].
fn placed(mesh: &Mesh, file: &MeshFile) -> Mesh {
    let scaled = mesh.scaled(file.units.mm());
    match &file.transform {
        None => scaled,
        Some(rows) => {
            let matrix = Matrix3x4::from_row_iterator(rows.get_ref().iter().flatten().copied());
            scaled.mapped(|p| matrix * Vector4::new(p.x, p.y, p.z, 1.0))
        }
    }
}

fn cut(plan: &Plan, meshes: &[Option<Mesh>], nodes_max: usize) -> Result<Patch, Error> {
    // The scene lists tissues from the outside in, the patch by priority.
    let count = plan.tissues.len();
    let tissues: Vec<_> = plan
        .tissues
        .iter()
        .zip(meshes)
        .rev()
        .map(|(tissue, mesh)| patch::Tissue {
            name: &tissue.name,
            mesh: mesh.as_ref(),
            rigid: tissue.body.body == Body::Fixed,
        })
        .collect();
    let shell = plan.tissues.iter().rev().enumerate().find_map(|(tissue, plan)| {
        Some(Shell {
            tissue,
            thickness_mm: plan.sheet_mm?,
        })
    });
    let inner = tissues
        .iter()
        .enumerate()
        .position(|(i, t)| !t.rigid && shell.is_none_or(|shell| shell.tissue != i));
    let anatomy = Anatomy {
        tissues: &tissues,
        shell,
        fill: inner.or(shell.map(|shell| shell.tissue)).unwrap_or(0),
    };
    let (point, normal) = match plan.patch.site_mm {
        Some(site) => (site, plan.patch.normal),
        None => (phantom::SITE, Some(phantom::NORMAL)),
    };
    let [width, length, _] = plan.patch.size_mm;
    let site = Site {
        point: point.into(),
        normal: normal.map(Vec3::from),
        along: plan.patch.along.into(),
        radius_mm: width.min(length) / 2.0,
    };
    let block = Block {
        size_mm: plan.patch.size_mm,
        pitch_mm: plan.patch.pitch_mm,
        wound: plan.wound.map(|wound| patch::Wound {
            width_mm: wound.gap_mm,
            length_mm: wound.length_mm,
            depth_mm: wound.depth_mm,
        }),
        soft_depth_mm: reach_mm(plan) + SPARE * plan.patch.pitch_mm,
        nodes_max,
    };
    let mut patch = patch::cut(&anatomy, &site, &block)?;
    for cell in patch.cells.iter_mut().filter(|cell| **cell != 0) {
        *cell = count as u8 + 1 - *cell;
    }
    patch.voxels.reverse();
    Ok(patch)
}

/// How deep the tool goes below the skin [mm].
fn reach_mm(plan: &Plan) -> f64 {
    match (Needle::of(&plan.tool), plan.operator) {
        (Some(needle), _) => needle.depth_mm(half_mm(plan)),
        (None, Operator::Touch(touch)) => touch.push_m * 1e3,
        (None, Operator::Sew(_)) => 0.0,
    }
}

/// Half the distance of the punctures [mm].
fn half_mm(plan: &Plan) -> f64 {
    let gap = plan.wound.map_or(0.0, |wound| wound.gap_mm);
    plan.stitch.map_or(0.0, |stitch| gap / 2.0 + stitch.bite_mm)
}

/// Where the first stitch crosses the wound [mm]: all together they lie about its middle.
fn first_row_mm(plan: &Plan) -> f64 {
    plan.stitch
        .map_or(0.0, |stitch| -0.5 * f64::from(stitch.stitches - 1) * stitch.spacing_mm)
}

/// Where the stitches cross the wound, in their order [mm].
fn rows_mm(plan: &Plan) -> impl Iterator<Item = f64> {
    let (stitches, spacing) = plan
        .stitch
        .map_or((1, 0.0), |stitch| (stitch.stitches, stitch.spacing_mm));
    let first = first_row_mm(plan);
    (0..stitches).map(move |stitch| first + f64::from(stitch) * spacing)
}

/// Where the hand works on a row.
fn place(plan: &Plan, patch: &Patch, y_mm: f64) -> Result<Place, Error> {
    let half = half_mm(plan);
    let skin = |x_mm: f64| skin(plan, patch, [x_mm, y_mm]).map(|z_mm| z_mm * 1e-3);
    let (radius_m, ahead_m) = match plan.tool {
        Tool::Needle {
            radius_m,
            length_m,
            grasp_m,
        } => (radius_m, length_m - grasp_m),
        Tool::Ball { radius_m } => (radius_m, 0.0),
    };
    let thread_m = plan
        .thread
        .map_or(0.0, |thread| thread.link_m * f32::from(thread.nodes - 1));
    Ok(Place {
        y_m: y_mm * 1e-3,
        skin_m: [skin(-half)?, skin(half)?],
        half_m: half * 1e-3,
        radius_m: radius_m.into(),
        ahead_m: ahead_m.into(),
        thread_m: thread_m.into(),
    })
}

/// Height of the skin at (x, y) [mm], where there is enough soft tissue for the tool.
fn skin(plan: &Plan, patch: &Patch, [x_mm, y_mm]: [f64; 2]) -> Result<f64, Error> {
    let grid = &patch.grid;
    let [nx, ny, nz] = grid.cells;
    let pitch = grid.pitch;
    let along = |at: f64, origin: f64, cells: usize| (((at - origin) / pitch) as usize).min(cells.saturating_sub(1));
    let (i, j) = (along(x_mm, grid.origin.x, nx), along(y_mm, grid.origin.y, ny));
    let soft = |k: usize| {
        let tissue = usize::from(patch.cells[grid.index([i, j, k])])
            .checked_sub(1)
            .and_then(|t| plan.tissues.get(t));
        tissue.is_some_and(|tissue| tissue.body.body != Body::Fixed)
    };
    let empty = |k: &usize| patch.cells[grid.index([i, j, *k])] == 0;
    let mut column = (0..nz).rev().skip_while(empty).peekable();
    let top = column.peek().copied().ok_or(Error::NoSkin { x_mm, y_mm })?;
    let found_mm = column.take_while(|&k| soft(k)).count() as f64 * pitch;
    let needed_mm = reach_mm(plan) + SPARE * pitch;
    if found_mm < needed_mm {
        return Err(Error::Shallow {
            x_mm,
            y_mm,
            found_mm,
            needed_mm,
            flatter: flatter(plan, found_mm - SPARE * pitch),
        });
    }
    Ok(grid.origin.z + (top + 1) as f64 * pitch)
}

/// What else helps where there are only `depth_mm` of tissue: a flatter needle.
fn flatter(plan: &Plan, depth_mm: f64) -> String {
    let Tool::Needle { length_m, grasp_m, .. } = plan.tool else {
        return String::new();
    };
    let grasp = f64::from(grasp_m / length_m);
    needle::that_can(half_mm(plan), depth_mm, grasp)
        .map_or_else(String::new, |name| format!(", or take needle.kind = \"{name}\""))
}

/// The wound's faces in nodes of the lattice.
fn faces(wound: &plan::Wound, patch: &Patch) -> scene::Wound {
    let grid = &patch.grid;
    let cells = |mm: f64| (mm / grid.pitch).round() as usize;
    let centred = |cells: usize, count: usize| {
        let first = (cells - count.min(cells)) / 2;
        [first as u16, (first + count.min(cells)) as u16]
    };
    scene::Wound {
        faces: centred(grid.cells[0], cells(wound.gap_mm)),
        rows: centred(grid.cells[1], cells(wound.length_mm)),
        floor: cells(-grid.origin.z).saturating_sub(cells(wound.depth_mm)) as u16,
        penalty_n_per_m: wound.penalty_n_per_m,
    }
}

/// A scene as it goes to the controller, and what is told about it.
#[derive(Clone, Debug)]
pub struct Built {
    /// The scene.
    pub scene: Scene,
    /// One byte a cell, x fastest.
    pub cells: Vec<u8>,
    /// Size of the lattice.
    pub counts: LatticeCounts,
    /// Name and voxels of each tissue.
    pub tissues: Vec<(String, usize)>,
    /// What is not as asked for, one line each.
    pub warnings: Vec<String>,
}

/// Why a scene cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No place for the phantom's files.
    #[error("the phantom's meshes cannot be written: {0}")]
    Folder(std::io::Error),
    /// A mesh file.
    #[error(transparent)]
    Stl(#[from] StlError),
    /// The patch.
    #[error(transparent)]
    Patch(#[from] PatchError),
    /// The simulated arm cannot follow the script.
    #[error(transparent)]
    Reach(#[from] reach::Error),
    /// A puncture site, or the place to touch, outside of the tissue.
    #[error(
        "no tissue at x = {x_mm} mm, y = {y_mm} mm of the patch, where the tool is to meet the skin: move patch.site_mm or make stitch.bite_mm smaller"
    )]
    NoSkin {
        /// Where [mm].
        x_mm: f64,
        /// Where along the wound [mm].
        y_mm: f64,
    },
    /// Bone or nothing too near under a puncture site.
    #[error(
        "only {found_mm} mm of soft tissue at x = {x_mm} mm, y = {y_mm} mm of the patch, {needed_mm:.1} mm are needed: move patch.site_mm away from bone{flatter}"
    )]
    Shallow {
        /// Where [mm].
        x_mm: f64,
        /// Where along the wound [mm].
        y_mm: f64,
        /// What there is [mm].
        found_mm: f64,
        /// What there should be [mm].
        needed_mm: f64,
        /// A needle that goes less deep, if there is one.
        flatter: String,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use sutura_shared::check::Validate;

    #[test]
    fn the_built_in_scene_is_one_the_controller_accepts() {
        let plan = crate::scene::load(None).unwrap();
        let built = build(&plan, 24 * 24 * 12).unwrap();
        built.scene.validate().unwrap();
        built.scene.validate_cells(&built.cells).unwrap();
        assert_eq!(built.warnings, Vec::<String>::new());
        assert!(built.counts.nodes >= 1500, "{:?}", built.counts);
        // 40 × 30 × 12 mm at 2 mm is 20 × 15 × 6 cells; a wound of 4 × 18 × 6 mm takes 2 × 9 × 3 away.
        assert_eq!(built.counts.voxels, 20 * 15 * 6 - 2 * 9 * 3);
        // One layer of skin, the wound left out of it.
        assert_eq!(
            built.tissues,
            [
                ("skin".into(), 20 * 15 - 2 * 9),
                ("muscle".into(), 20 * 15 * 5 - 2 * 9 * 2),
                ("bone".into(), 0)
            ]
        );
        let wound = built.scene.wound.unwrap();
        assert_eq!((wound.faces, wound.rows, wound.floor), ([9, 11], [3, 12], 3));
    }

    #[test]
    fn too_many_nodes_are_refused_with_a_pitch_that_fits() {
        let mut plan = crate::scene::load(None).unwrap();
        plan.patch.pitch_mm = 0.5;
        let error = build(&plan, 24 * 24 * 12).unwrap_err().to_string();
        assert!(
            error.contains("nodes is more than the patch holds (6912): pitch"),
            "{error}"
        );
    }
}
