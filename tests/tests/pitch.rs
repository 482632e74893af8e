//! The lattice's pitch is a dial and not a part of the scene: the skin gives way as deep on a finer lattice, and no voxel turns inside out on the way.

// The lint knows tests, not what they call.
#![allow(clippy::unwrap_used)]

use sutura::run::embedded::PcRig;
use sutura::study::stability::inverted::inverted as inside_out;
use sutura_controller::lanes::Level;
use sutura_controller::link::Plant as _;
use sutura_shared::scene::Site;
use sutura_tests::scenario;

/// Ticks between two looks at all voxels.
const LOOK: u32 = 10;
/// Longest way to the right puncture [ticks].
const TICKS: u32 = 10_000;

/// Depths at the left and the right puncture [mm], and tick and number of inverted voxels at each look until then that found any.
fn indent(scene: &str) -> ([f32; 2], Vec<(u32, usize)>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, scene).unwrap();
    let built = scenario::built(Some(&path)).unwrap();
    let mut memory = scenario::memory();
    let mut rig = PcRig::new(&mut memory, Level::best());
    rig.load(&built.scene, &built.cells).unwrap();
    let mut depths_mm = [f32::NAN; 2];
    let mut inverted = Vec::new();
    for tick in 1..=TICKS {
        let output = rig.tick();
        if tick % LOOK == 0 {
            let voxels = inside_out(rig.controller().lattice(), rig.controller().tissue(), &built.cells);
            inverted.extend((voxels > 0).then_some((tick, voxels)));
        }
        let Some(puncture) = output.puncture else { continue };
        depths_mm[usize::from(puncture.site == Site::D)] = puncture.depth * 1e3;
        if puncture.site == Site::D {
            break;
        }
    }
    (depths_mm, inverted)
}

/// Without a wound: no width of one is a multiple of both pitches, and where its faces are decides where the needle comes out.
#[test]
fn the_depth_at_f0_does_not_depend_on_the_pitch() {
    let text = sutura::scene::BUILT_IN.replace("\"wound-contact\", ", "");
    let (before, wound) = text.split_once("[wound]").unwrap();
    let (_, after) = wound.split_once("[needle]").unwrap();
    let coarse = format!("{before}[needle]{after}");
    let fine = coarse.replace("pitch_mm = 2 ", "pitch_mm = 1.5 ");
    let ([coarse, fine], inverted) = {
        let [(coarse, a), (fine, b)] = [coarse.as_str(), fine.as_str()].map(indent);
        ([coarse, fine], [a, b])
    };
    println!("depth at F0, left and right: {coarse:.3?} mm at 2 mm, {fine:.3?} mm at 1.5 mm");
    assert!(
        inverted.iter().all(Vec::is_empty),
        "tick and inverted voxels: {inverted:?}"
    );
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        assert!(
            (fine / coarse - 1.0).abs() < 0.15,
            "{coarse} mm at 2 mm, {fine} mm at 1.5 mm"
        );
    }
}
