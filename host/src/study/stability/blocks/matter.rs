//! Tissues as stiff, soft, heavy and light as they come, under a ball that presses, drags and is lifted off.

use sutura_controller::math::Vec3;

use super::patch::{FLESH, Patch, Stuff};
use crate::study::stability::bench::{Bench, memory};
use crate::study::stability::case::{Attempt, Case, Unfinished};
use crate::study::stability::watch::Trace;

/// Young's moduli [MPa].
const YOUNG_MPA: [f64; 5] = [0.01, 0.1, 1.0, 10.0, 50.0];
/// Voxel edges [mm].
const PITCHES_MM: [f64; 2] = [1.0, 2.0];

/// All of them.
pub(super) fn cases() -> Vec<Case> {
    let young = PITCHES_MM
        .into_iter()
        .flat_map(|pitch| YOUNG_MPA.map(|young| of_stiffness(young, pitch)));
    young.chain(ratios()).collect()
}

fn of_stiffness(young_mpa: f64, pitch_mm: f64) -> Case {
    let stuff = Stuff {
        young_pa: young_mpa * 1e6,
        ..FLESH
    };
    let patch = Patch {
        pitch_m: pitch_mm * 1e-3,
        stuff: [stuff; 2],
        ..Patch::default()
    };
    Case {
        name: format!("young:{young_mpa}-mpa:{pitch_mm}-mm"),
        what: format!("tissue of {young_mpa} MPa in voxels of {pitch_mm} mm, pressed and dragged by a voxel's edge"),
        equilibrium: None,
        run: Box::new(move |attempt| stroke(attempt, &patch)),
    }
}

/// Two tissues 1 : 10⁴ apart.
fn ratios() -> impl Iterator<Item = Case> {
    RATIOS.into_iter().map(|(name, what, over, fill)| {
        let stuff = over.map(|[young, density]| Stuff {
            young_pa: FLESH.young_pa * young,
            density_kg_m3: FLESH.density_kg_m3 * density,
        });
        let patch = Patch {
            stuff,
            fill,
            ..Patch::default()
        };
        Case {
            name: format!("ratio-10000:{name}"),
            what: format!("{what}, 1 to 10,000, pressed and dragged by a voxel's edge"),
            equilibrium: None,
            run: Box::new(move |attempt| stroke(attempt, &patch)),
        }
    })
}

/// Name, description, stiffness and density of each tissue over those of flesh, and which voxels are of which.
type Ratio = (&'static str, &'static str, [[f64; 2]; 2], fn([u32; 3]) -> u8);

const RATIOS: [Ratio; 7] = [
    (
        "stiff-on-soft",
        "stiff on soft layers",
        [[1e2, 1.0], [1e-2, 1.0]],
        layers,
    ),
    (
        "soft-on-stiff",
        "soft on stiff layers",
        [[1e-2, 1.0], [1e2, 1.0]],
        layers,
    ),
    (
        "heavy-on-light",
        "heavy on light layers",
        [[1.0, 1e2], [1.0, 1e-2]],
        layers,
    ),
    (
        "light-on-heavy",
        "light on heavy layers",
        [[1.0, 1e-2], [1.0, 1e2]],
        layers,
    ),
    (
        "stiff-light",
        "stiff and light layers on soft and heavy ones",
        [[1e2, 1e-2], [1e-2, 1e2]],
        layers,
    ),
    (
        "stiff-heavy",
        "stiff and heavy layers on soft and light ones",
        [[1e2, 1e2], [1e-2, 1e-2]],
        layers,
    ),
    (
        "chessboard",
        "voxels stiff and light by turns with soft and heavy ones",
        [[1e2, 1e-2], [1e-2, 1e2]],
        chessboard,
    ),
];

/// The two upper layers of five, and the others.
fn layers([_, _, k]: [u32; 3]) -> u8 {
    if k >= 3 { 1 } else { 2 }
}

fn chessboard([i, j, k]: [u32; 3]) -> u8 {
    1 + ((i + j + k) % 2) as u8
}

/// Presses by a voxel's edge within 0.3 s, drags as far within 0.2 s, and lifts off.
fn stroke(attempt: &Attempt<'_>, patch: &Patch) -> Result<Trace, Unfinished> {
    let (scene, cells) = patch.scene(attempt);
    let mut memory = memory();
    let mut bench = Bench::new(*attempt, &mut memory, &scene, &cells)?;
    let tip = |tick: u16| {
        let part = |from: u16, to: u16| f32::from(tick.clamp(from, to) - from) / f32::from(to - from);
        Vec3::new(part(300, 500), 0.0, -part(0, 300)) * patch.pitch()
    };
    for tick in 0..=500 {
        bench.tick(patch.grasp(tip(tick)))?;
    }
    patch.lift_off(bench, tip(500))
}
