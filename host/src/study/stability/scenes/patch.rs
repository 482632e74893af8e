//! The scenes of the cases: the built-in one on 24 × 16 × 10 mm, under the setting of an attempt.

use std::sync::OnceLock;

use sutura_shared::scene::{Effect, Effects, Scene, Tool};

use crate::run::embedded::NODES_MAX;
use crate::scene::build::{self, Built};
use crate::scene::operator::{Operator, Touch};
use crate::scene::{self, Plan};
use crate::study::stability::case::{Attempt, Unfinished};
use crate::study::stability::setting::Curve;

/// Across the wound, along it, deep [mm].
const SIZE_MM: [f64; 3] = [24.0, 16.0, 10.0];
/// Length of the wound [mm]: rims at both of its ends.
const WOUND_MM: f64 = 10.0;
/// How far the wound's edges are undermined [voxels]: a puncture is two from the wound.
const UNDERMINED: usize = 3;
/// Radius of the ball [m], as of the scene that is stroked.
pub(super) const BALL_M: f32 = 3e-3;

/// What is built once.
type Piece = OnceLock<Result<Built, String>>;

/// The built-in scene's needle and thread at its wound; and its cells.
pub(super) fn sewn(attempt: &Attempt<'_>) -> Result<(Scene, Vec<u8>), Unfinished> {
    static PIECE: Piece = OnceLock::new();
    under(attempt, PIECE.get_or_init(|| piece(|_| {})))
}

/// The same with three stitches close together, and a thread of 200 links as long as the scene has them, 5 mm. With links of 2 or 3 mm the case
/// fails: a slack thread so finely divided tugs at the skin.
pub(super) fn long(attempt: &Attempt<'_>) -> Result<(Scene, Vec<u8>), Unfinished> {
    let (mut scene, cells) = sewn(attempt)?;
    if let (Some(stitch), Some(thread)) = (&mut scene.stitch, &mut scene.thread) {
        (stitch.count, stitch.spacing_m) = (3, 3e-3);
        stitch.a_m[1] = -stitch.spacing_m;
        thread.nodes = 201;
    }
    Ok((scene, cells))
}

/// The same with both edges of the wound undermined as far as the muscle is open, to beyond the punctures: a layer of skin is left, one voxel
/// thick.
pub(super) fn undermined(attempt: &Attempt<'_>) -> Result<(Scene, Vec<u8>), Unfinished> {
    let (scene, mut cells) = sewn(attempt)?;
    let Some(wound) = scene.wound else {
        return Err(Unfinished::Built("there is no wound to undermine"));
    };
    let [nx, ny, _] = scene.lattice.cells.map(usize::from);
    let [left, right] = wound.faces.map(usize::from);
    let columns = left.saturating_sub(UNDERMINED)..right + UNDERMINED;
    let rows = usize::from(wound.rows[0])..usize::from(wound.rows[1]);
    for (n, cell) in cells.iter_mut().enumerate() {
        let [i, j, k] = [n % nx, n / nx % ny, n / (nx * ny)];
        if *cell > 1 && columns.contains(&i) && rows.contains(&j) && k >= usize::from(wound.floor) {
            *cell = 0;
        }
    }
    Ok((scene, cells))
}

/// A ball tip instead of them; and the cells.
pub(super) fn stroked(attempt: &Attempt<'_>) -> Result<(Scene, Vec<u8>), Unfinished> {
    static PIECE: Piece = OnceLock::new();
    under(attempt, PIECE.get_or_init(|| piece(take_ball)))
}

/// The same with bone right under one layer of skin, against a coupling of `stiffness` [N/m].
pub(super) fn bony(attempt: &Attempt<'_>, stiffness: f32) -> Result<(Scene, Vec<u8>), Unfinished> {
    let (mut scene, mut cells) = stroked(attempt)?;
    let bone = scene.tissues.len() as u8;
    cells.iter_mut().filter(|cell| **cell > 1).for_each(|cell| *cell = bone);
    scene.contact.coupling_n_per_m = stiffness;
    Ok((scene, cells))
}

/// A piece of the built-in scene, changed.
fn piece(change: impl FnOnce(&mut Plan)) -> Result<Built, String> {
    let mut plan = scene::load(None).map_err(|error| error.to_string())?;
    plan.patch.size_mm = SIZE_MM;
    plan.wound.iter_mut().for_each(|wound| wound.length_mm = WOUND_MM);
    change(&mut plan);
    build::build(&plan, NODES_MAX).map_err(|error| error.to_string())
}

fn take_ball(plan: &mut Plan) {
    let effects = [
        Effect::Stiffening,
        Effect::SpringDamping,
        Effect::WoundContact,
        Effect::Passivity,
    ];
    plan.effects = effects.into_iter().fold(Effects::default(), Effects::with);
    plan.tool = Tool::Ball { radius_m: BALL_M };
    (plan.stitch, plan.thread) = (None, None);
    plan.operator = Operator::Touch(Touch {
        approach_m_per_s: 0.04,
        push_m_per_s: 0.008,
        push_m: 0.002,
        drag_m: 0.0,
    });
}

/// A piece with the attempt's solver and springs.
fn under(attempt: &Attempt<'_>, piece: &'static Result<Built, String>) -> Result<(Scene, Vec<u8>), Unfinished> {
    let built = piece.as_ref().map_err(|error| Unfinished::Built(error))?;
    let mut scene = built.scene.clone();
    let springs = attempt.setting.springs;
    scene.solver = attempt.setting.solver;
    (scene.lattice.law, scene.lattice.assembly) = (springs.law, springs.assembly);
    if springs.curve == Curve::Linear {
        scene.effects = Effects(scene.effects.0 & !(Effect::Stiffening as u32));
    }
    Ok((scene, built.cells.clone()))
}
