//! The patch: the block of tissue around a wound that the controller simulates, as cells of tissues in the patch frame.
//!
//! The meshes are voxelized in the patch frame, so that the skin is a layer of cells and not a staircase. A cell inside any mesh belongs to
//!
//! 1. the first rigid tissue (bone) whose mesh it is in;
//! 2. the skin, where a thickness is given and fewer cells than that lie above it in its column;
//! 3. the first other tissue whose mesh it is in, the skin's own mesh aside where a thickness is given: it then only says where the body ends;
//! 4. the fill, between the surfaces of an anatomy whose tissues do not touch (fat between skin and muscle).
//!
//! So meshes may nest (each including what is within it) or share borders, and the skin may be a mesh, a shell or both.
//! Cells that no chain of faces links to the main body are left out: nothing would hold them.

mod layers;
mod plan;

use nalgebra::Isometry3;

use super::frame::{FrameError, Site, patch_from_world};
use super::grid::{Grid, GridError};
use super::mesh::Mesh;
use layers::{drop_loose, soft_depth, tissues};
use plan::Plan;

/// Most that skin may rise above the wound's middle before it is cut off [mm].
pub const RISE_MM_MAX: f64 = 3.0;

/// A tissue of an anatomy.
#[derive(Clone, Copy, Debug)]
pub struct Tissue<'a> {
    /// Its name, for messages.
    pub name: &'a str,
    /// Where it is [mm], if a mesh says so.
    pub mesh: Option<&'a Mesh>,
    /// Whether it is held fixed, like bone.
    pub rigid: bool,
}

/// A tissue that lies as a layer under the outer surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shell {
    /// Which one, an index into [`Anatomy::tissues`].
    pub tissue: usize,
    /// Its thickness [mm]; it takes [`layers`] of cells.
    pub thickness_mm: f64,
}

/// Layers of cells that hold a shell of this thickness, at least one: none is lost, and as stiffness in the plane goes with the thickness, what
/// the cells are too many is made up for by softer ones.
#[must_use]
pub fn layers(thickness_mm: f64, pitch_mm: f64) -> usize {
    // A hair of room, for a multiple of the pitch that was rounded up.
    ((thickness_mm / pitch_mm - 1e-6).ceil() as usize).max(1)
}

/// What there is to cut a patch from.
#[derive(Clone, Copy, Debug)]
pub struct Anatomy<'a> {
    /// In order of priority; the last with a mesh is the outermost, on which the site lies. At most 255.
    pub tissues: &'a [Tissue<'a>],
    /// The skin, where it is a layer of given thickness and not just a mesh.
    pub shell: Option<Shell>,
    /// Tissue of cells inside the outer surface that no mesh claims, an index into `tissues`.
    pub fill: usize,
}

/// A slit in the skin, centred on the site and open above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wound {
    /// Across, along x [mm]; rounded to a multiple of the pitch.
    pub width_mm: f64,
    /// Along y [mm]; rounded, and cut at the ends of the patch.
    pub length_mm: f64,
    /// Down from the site [mm]; rounded.
    pub depth_mm: f64,
}

/// The block to cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Extent across the wound, along it and down from the site [mm]; rounded so that the block is symmetric about the wound.
    pub size_mm: [f64; 3],
    /// Edge of a cell [mm].
    pub pitch_mm: f64,
    /// The wound; none is a block of whole skin.
    pub wound: Option<Wound>,
    /// Soft tissue that there must be below the site [mm].
    pub soft_depth_mm: f64,
    /// Most nodes of the block's whole lattice, empty corners included.
    pub nodes_max: usize,
}

/// A block of tissue in the patch frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// From the frame of the meshes to that of the patch [mm].
    pub patch_from_world: Isometry3<f64>,
    /// Where the cells are in the patch frame [mm]; z = 0 is a layer of nodes.
    pub grid: Grid,
    /// For each cell, x fastest: 0 empty, 1 + i for tissue i.
    pub cells: Vec<u8>,
    /// Cells of each tissue.
    pub voxels: Vec<usize>,
    /// Cells that the wound took away.
    pub wound_voxels: usize,
    /// Least soft tissue in a column of the wound and its rim, at most the depth of the block [mm].
    pub soft_depth_mm: f64,
    /// What is not as asked for.
    pub warnings: Vec<Warning>,
}

impl Patch {
    /// Place of node (0, 0, 0) in the patch frame [m].
    #[must_use]
    pub fn origin_m(&self) -> [f64; 3] {
        (self.grid.origin * 1e-3).into()
    }
}

/// What of a patch is not as asked for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Warning {
    /// A length that is no multiple of the pitch.
    #[error("{what} {asked_mm} mm became {got_mm} mm, a multiple of the pitch")]
    Rounded {
        /// Which length.
        what: &'static str,
        /// As asked for [mm].
        asked_mm: f64,
        /// As it is [mm].
        got_mm: f64,
    },
    /// A shell that is thinner than the cells which hold it.
    #[error("tissue of {asked_mm} mm became {got_mm} mm of softer voxels, as stiff in their plane")]
    Thickened {
        /// As asked for [mm].
        asked_mm: f64,
        /// As it is [mm].
        got_mm: f64,
    },
    /// Skin higher than [`RISE_MM_MAX`] above the site.
    #[error("{cells} cells higher than {top_mm} mm above the site cut off: the skin is not flat there")]
    CutOff {
        /// How many.
        cells: usize,
        /// Where the block ends [mm].
        top_mm: f64,
    },
    /// Cells without a link to the main body.
    #[error("{cells} cells that hang on no face of the rest left out")]
    Loose {
        /// How many.
        cells: usize,
    },
}

/// Why there is no patch.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PatchError {
    /// No tissue with a mesh.
    #[error("no tissue has a mesh")]
    NoMesh,
    /// The site has no frame.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The pitch or the size is impossible.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// A length that is no length.
    #[error("{what} {value} mm is not a positive number")]
    Length {
        /// Which length.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// More nodes than the controller holds.
    #[error("a lattice of {} × {} × {} = {count} nodes is more than the patch holds ({nodes_max}): pitch {fits_mm} mm or more fits", nodes[0], nodes[1], nodes[2])]
    TooManyNodes {
        /// Nodes along x, y and z.
        nodes: [usize; 3],
        /// Their product.
        count: usize,
        /// The capacity.
        nodes_max: usize,
        /// A pitch that fits [mm].
        fits_mm: f64,
    },
    /// No cell centre in any tissue.
    #[error("pitch {pitch_mm} mm gives no voxel at the site")]
    NoVoxel {
        /// The pitch [mm].
        pitch_mm: f64,
    },
    /// Bone or air too near under the site.
    #[error(
        "only {found_mm} mm of soft tissue under the wound and its rim, {needed_mm} mm are needed: {below} is below"
    )]
    Shallow {
        /// What there is [mm].
        found_mm: f64,
        /// What there should be [mm].
        needed_mm: f64,
        /// What is under it.
        below: String,
    },
}

/// Cuts the patch of an anatomy at a site.
///
/// # Errors
/// See [`PatchError`].
pub fn cut(anatomy: &Anatomy, site: &Site, block: &Block) -> Result<Patch, PatchError> {
    let outer = anatomy
        .tissues
        .iter()
        .rev()
        .find_map(|tissue| tissue.mesh)
        .ok_or(PatchError::NoMesh)?;
    let (plan, mut warnings) = Plan::of(block)?;
    // Cells cost time, so what is too much even without a rise of the skin is refused before there are any.
    plan.check_capacity(&plan.grid(0), block)?;
    warnings.extend(anatomy.shell.and_then(|shell| thickened(&shell, plan.pitch)));
    let patch_from_world = patch_from_world(outer, site)?;
    // One layer more than may be used shows whether anything is cut off.
    let tall = plan.grid(plan.above_max + 1);
    let mut cells = tissues(anatomy, &patch_from_world, &tall);
    let layer = plan.across[0] * plan.across[1];
    let cut_off = count(&cells[tall.len() - layer..]);
    if cut_off > 0 {
        warnings.push(Warning::CutOff {
            cells: cut_off,
            top_mm: plan.above_max as f64 * plan.pitch,
        });
    }
    let above = (0..plan.above_max)
        .rev()
        .find(|a| count(&cells[layer * (plan.below + a)..][..layer]) > 0);
    let grid = plan.grid(above.map_or(0, |a| a + 1));
    cells.truncate(grid.len());
    plan.check_capacity(&grid, block)?;
    let loose = drop_loose(&mut cells, grid.cells);
    if loose > 0 {
        warnings.push(Warning::Loose { cells: loose });
    }
    if count(&cells) == 0 {
        return Err(PatchError::NoVoxel {
            pitch_mm: block.pitch_mm,
        });
    }
    let soft_depth_mm = soft_depth(anatomy, (&cells, &grid), &plan, block.soft_depth_mm)?;
    let wound_voxels = plan.remove_wound(&mut cells, &grid);
    let voxels = (1..=anatomy.tissues.len())
        .map(|t| cells.iter().filter(|&&c| usize::from(c) == t).count())
        .collect();
    Ok(Patch {
        patch_from_world,
        grid,
        cells,
        voxels,
        wound_voxels,
        soft_depth_mm,
        warnings,
    })
}

fn thickened(shell: &Shell, pitch: f64) -> Option<Warning> {
    let asked_mm = shell.thickness_mm;
    let got_mm = layers(asked_mm, pitch) as f64 * pitch;
    ((asked_mm - got_mm).abs() > 1e-6 * pitch).then_some(Warning::Thickened { asked_mm, got_mm })
}

fn count(cells: &[u8]) -> usize {
    cells.iter().filter(|&&cell| cell != 0).count()
}

#[cfg(test)]
mod tests {
    use super::super::mesh::tests::cube;
    use super::super::{Vec3, phantom};
    use super::*;

    fn site() -> Site {
        Site {
            point: phantom::SITE.into(),
            normal: None,
            along: Vec3::y(),
            radius_mm: 15.0,
        }
    }

    fn block(pitch_mm: f64) -> Block {
        let wound = Wound {
            width_mm: 4.0,
            length_mm: 20.0,
            depth_mm: 6.0,
        };
        Block {
            size_mm: [40.0, 30.0, 12.0],
            pitch_mm,
            wound: Some(wound),
            soft_depth_mm: 12.0,
            nodes_max: 24 * 24 * 12,
        }
    }

    const NAMES: [&str; 3] = ["bone", "muscle", "skin"];

    fn tissues<'a>(meshes: [Option<&'a Mesh>; 3]) -> [Tissue<'a>; 3] {
        [0, 1, 2].map(|t| Tissue {
            name: NAMES[t],
            mesh: meshes[t],
            rigid: t == 0,
        })
    }

    fn layer(patch: &Patch, k: usize) -> Vec<u8> {
        let size = patch.grid.cells[0] * patch.grid.cells[1];
        patch.cells[k * size..][..size].to_vec()
    }

    #[test]
    fn forearm_has_flat_skin_over_muscle_and_a_symmetric_wound() {
        let arm = phantom::forearm();
        let tissues = tissues([Some(&arm.bone), Some(&arm.muscle), Some(&arm.skin)]);
        let patch = cut(
            &Anatomy {
                tissues: &tissues,
                shell: None,
                fill: 1,
            },
            &site(),
            &block(2.0),
        )
        .unwrap();
        // 15 cells along y became 16, for a wound of 10 in their middle; nothing rises above the flat site.
        assert_eq!(patch.grid.cells, [20, 16, 6]);
        assert!((Vec3::from(patch.origin_m()) - Vec3::new(-0.020, -0.016, -0.012)).norm() < 1e-12);
        assert_eq!(
            (patch.wound_voxels, patch.warnings.as_slice()),
            (2 * 10 * 3, [].as_slice())
        );
        // Skin of 1.5 mm holds the centres of the top layer, 1 mm down, and no others.
        assert!(layer(&patch, 5).iter().all(|cell| [0, 3].contains(cell)));
        assert!((0..5).all(|k| layer(&patch, k).iter().all(|cell| [0, 2].contains(cell))));
        assert_eq!(patch.voxels, [0, 20 * 16 * 5 - 2 * 10 * 2, 20 * 16 - 2 * 10]);
        assert!((patch.soft_depth_mm - 12.0).abs() < 1e-12);
        for j in 0..16 {
            for i in 0..20 {
                let at = |i, j| patch.cells[patch.grid.index([i, j, 5])];
                assert_eq!(at(i, j) == 0, (9..11).contains(&i) && (3..13).contains(&j));
                assert_eq!((at(i, j), at(i, j)), (at(19 - i, j), at(i, 15 - j)));
            }
        }
    }

    /// Without a mesh of its own, and with one that is the whole body, the skin is a shell; the rest of the body is fill.
    #[test]
    fn skin_is_a_shell_of_at_least_one_cell() {
        let arm = phantom::forearm();
        for (thickness_mm, layers) in [(0.5, 1), (2.0, 1), (2.9, 2), (4.0, 2)] {
            let shell = Some(Shell {
                tissue: 2,
                thickness_mm,
            });
            for meshes in [
                [Some(&arm.bone), Some(&arm.skin), None],
                [Some(&arm.bone), None, Some(&arm.skin)],
            ] {
                let tissues = tissues(meshes);
                let patch = cut(
                    &Anatomy {
                        tissues: &tissues,
                        shell,
                        fill: 1,
                    },
                    &site(),
                    &block(2.0),
                )
                .unwrap();
                assert_eq!(patch.voxels[2], (20 * 16 - 2 * 10) * layers, "{thickness_mm} mm");
                assert!(patch.voxels[1] > 0 && patch.voxels[0] == 0);
                let said: Vec<_> = patch.warnings.iter().map(ToString::to_string).collect();
                match thickness_mm {
                    0.5 => assert_eq!(
                        said,
                        ["tissue of 0.5 mm became 2 mm of softer voxels, as stiff in their plane"]
                    ),
                    2.9 => assert_eq!(
                        said,
                        ["tissue of 2.9 mm became 4 mm of softer voxels, as stiff in their plane"]
                    ),
                    _ => assert!(said.is_empty(), "{said:?}"),
                }
            }
        }
    }

    #[test]
    fn bone_wins_over_skin_and_muscle_and_limits_the_depth() {
        let arm = phantom::forearm();
        let tissues = tissues([Some(&arm.bone), Some(&arm.muscle), Some(&arm.skin)]);
        let anatomy = Anatomy {
            tissues: &tissues,
            shell: None,
            fill: 1,
        };
        // The radius is 14 mm under the skin at x = 15.
        let over_bone = Site {
            point: Vec3::new(15.0, 0.0, 31.8),
            ..site()
        };
        let deep = Block {
            size_mm: [20.0, 20.0, 24.0],
            soft_depth_mm: 20.0,
            ..block(2.0)
        };
        let error = cut(&anatomy, &over_bone, &deep).unwrap_err();
        let PatchError::Shallow {
            found_mm, ref below, ..
        } = error
        else {
            panic!("{error}")
        };
        assert!((12.0..=16.0).contains(&found_mm) && below == "bone", "{error}");
        let patch = cut(
            &anatomy,
            &over_bone,
            &Block {
                soft_depth_mm: 12.0,
                ..deep
            },
        )
        .unwrap();
        assert!(patch.voxels[0] > 100);
    }

    #[test]
    fn lengths_are_rounded_to_the_pitch_and_said_so() {
        let arm = phantom::forearm();
        let tissues = tissues([None, Some(&arm.skin), None]);
        let anatomy = Anatomy {
            tissues: &tissues,
            shell: None,
            fill: 1,
        };
        let patch = cut(
            &anatomy,
            &site(),
            &Block {
                nodes_max: 1 << 20,
                ..block(1.5)
            },
        )
        .unwrap();
        let said: Vec<_> = patch.warnings.iter().map(ToString::to_string).collect();
        assert_eq!(
            said,
            [
                "wound width 4 mm became 4.5 mm, a multiple of the pitch",
                "wound length 20 mm became 19.5 mm, a multiple of the pitch"
            ]
        );
        assert_eq!([patch.grid.cells[0] % 2, patch.grid.cells[1] % 2], [1, 1]);
    }

    #[test]
    fn what_cannot_be_cut_is_refused_in_one_line() {
        let cube = cube(Vec3::zeros()).mapped(|p| (p - Vec3::new(0.5, 0.5, 1.0)) * 60.0);
        let tissues = tissues([None, Some(&cube), None]);
        let anatomy = Anatomy {
            tissues: &tissues,
            shell: None,
            fill: 1,
        };
        let site = Site {
            point: Vec3::zeros(),
            ..site()
        };
        let refused = |block: Block, says: &str| {
            let message = cut(&anatomy, &site, &block).unwrap_err().to_string();
            assert!(message.contains(says) && !message.contains('\n'), "{message}");
        };
        refused(
            block(1.0),
            "a lattice of 41 × 31 × 13 = 16523 nodes is more than the patch holds (6912)",
        );
        refused(block(1e-6), "at most");
        refused(block(0.0), "pitch 0 mm is not a positive number");
        refused(
            Block {
                size_mm: [40.0, 30.0, 90.0],
                soft_depth_mm: 80.0,
                ..block(5.0)
            },
            "only 60 mm of soft tissue",
        );
        let PatchError::TooManyNodes { fits_mm, .. } = cut(&anatomy, &site, &block(1.0)).unwrap_err() else {
            panic!()
        };
        assert!(
            cut(&anatomy, &site, &block(fits_mm)).is_ok() && fits_mm < 2.0,
            "{fits_mm}"
        );
    }

    /// A crumb over the skin, within the block but linked to nothing.
    #[test]
    fn loose_cells_are_left_out() {
        let body = cube(Vec3::zeros()).mapped(|p| (p - Vec3::new(0.5, 0.5, 1.0)) * 60.0);
        let crumb = cube(Vec3::zeros()).mapped(|p| p * 1.5 + Vec3::new(10.0, 10.0, 1.5));
        let corners: Vec<_> = body.corners().chain(crumb.corners()).collect();
        let mesh = Mesh::from_corners(&corners).0;
        let tissues = tissues([None, Some(&mesh), None]);
        let anatomy = Anatomy {
            tissues: &tissues,
            shell: None,
            fill: 1,
        };
        let site = Site {
            point: Vec3::zeros(),
            ..site()
        };
        let patch = cut(
            &anatomy,
            &site,
            &Block {
                wound: None,
                nodes_max: 1 << 20,
                ..block(1.0)
            },
        )
        .unwrap();
        assert_eq!(patch.voxels[1], 40 * 30 * 12);
        assert!(
            matches!(patch.warnings.as_slice(), [Warning::Loose { cells: 1..8 }]),
            "{:?}",
            patch.warnings
        );
    }
}
