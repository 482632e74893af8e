//! A patch of real anatomy: skin, muscle and bone of a head CT, one frame, millimetres.
//!
//! The three surfaces nest: the skin is the body's outside, muscle and bone lie within, and fat between them belongs to no mesh of its own.

use std::path::PathBuf;

use sutura::geometry::Vec3;
use sutura::geometry::frame::Site;
use sutura::geometry::mesh::Mesh;
use sutura::geometry::patch::{Anatomy, Block, Patch, PatchError, Shell, Tissue, Wound, cut};
use sutura::geometry::stl::{self, StlError};

const NAMES: [&str; 3] = ["bone", "muscle", "skin"];

fn head(name: &str) -> Option<Result<[Mesh; 3], StlError>> {
    let paths: Option<Vec<_>> = NAMES
        .into_iter()
        .map(|tissue| sutura_tests::shared(name, &format!("data/anat_stl/cranium_{tissue}.stl")))
        .collect();
    let read = |paths: Vec<PathBuf>| {
        let mut meshes = NAMES.map(|_| Mesh::default());
        for (mesh, path) in meshes.iter_mut().zip(paths) {
            *mesh = stl::read(&path)?.mesh;
        }
        Ok(meshes)
    };
    paths.map(read)
}

fn cut_at(meshes: &[Mesh; 3], site: &Site, block: &Block) -> Result<Patch, PatchError> {
    let tissues = [0, 1, 2].map(|t| Tissue {
        name: NAMES[t],
        mesh: Some(&meshes[t]),
        rigid: t == 0,
    });
    cut(
        &Anatomy {
            tissues: &tissues,
            shell: Some(Shell {
                tissue: 2,
                thickness_mm: 2.0,
            }),
            fill: 1,
        },
        site,
        block,
    )
}

/// Where the skin is flat within 2 mm over 44 mm and faces (0.93, 0.36, −0.05).
fn site() -> Site {
    Site {
        point: Vec3::new(195.5, 160.0, 21.0),
        normal: None,
        along: Vec3::z(),
        radius_mm: 15.0,
    }
}

fn block() -> Block {
    let wound = Wound {
        width_mm: 4.0,
        length_mm: 20.0,
        depth_mm: 6.0,
    };
    Block {
        size_mm: [40.0, 30.0, 12.0],
        pitch_mm: 2.0,
        wound: Some(wound),
        soft_depth_mm: 12.0,
        nodes_max: 24 * 24 * 12,
    }
}

#[test]
fn patch_has_skin_on_top_and_muscle_below() {
    let Some(meshes) = head("head_patch") else { return };
    let meshes = meshes.unwrap();
    let patch = cut_at(&meshes, &site(), &block()).unwrap();
    let normal = patch.patch_from_world.rotation.inverse() * Vec3::z();
    assert!(
        normal.dot(&Vec3::new(0.93, 0.36, -0.05).normalize()) > 5.0_f64.to_radians().cos(),
        "{normal:?}"
    );
    let [nx, ny, nz] = patch.grid.cells;
    assert_eq!([nx, ny], [20, 16]);
    for column in (0..nx * ny).map(|c| (0..nz).rev().map(move |k| c + nx * ny * k)) {
        let from_top: Vec<_> = column
            .map(|cell| patch.cells[cell])
            .skip_while(|&cell| cell == 0)
            .collect();
        let skin = from_top.iter().take_while(|&&cell| cell == 3).count();
        // Outside of the wound one layer of skin; no holes and no skin further down.
        assert!(skin <= 1 && from_top.len() >= 3, "{from_top:?}");
        assert!(
            from_top[skin..].iter().all(|&cell| cell == 1 || cell == 2),
            "{from_top:?}"
        );
    }
    assert_eq!(patch.wound_voxels, 2 * 10 * 3);
    assert_eq!(patch.voxels[2], 20 * 16 - 2 * 10);
    // The skull reaches into a corner of the block, but not under the wound.
    assert!(
        patch.soft_depth_mm >= 12.0 && patch.voxels[0] * 20 < patch.voxels[1],
        "{:?}",
        patch.voxels
    );
}

#[test]
fn site_over_the_skull_is_refused() {
    let Some(meshes) = head("head_patch") else { return };
    let meshes = meshes.unwrap();
    // The crown has a few millimetres of skin over the skull.
    let crown = Site {
        point: Vec3::new(128.0, 120.0, 159.0),
        along: Vec3::x(),
        ..site()
    };
    let error = cut_at(&meshes, &crown, &block()).unwrap_err();
    assert!(
        matches!(&error, PatchError::Shallow { found_mm, below, .. } if *found_mm < 8.0 && below == "bone"),
        "{error}"
    );
}
