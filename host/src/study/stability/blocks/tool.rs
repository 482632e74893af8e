//! What a tool may do.

use std::f64::consts::TAU;

use sutura_controller::math::Vec3;

use super::patch::{FLESH, Patch, tissue};
use crate::study::stability::bench::{Bench, memory};
use crate::study::stability::case::{Attempt, Case, Unfinished};
use crate::study::stability::watch::Trace;

/// The tip at each tick [m]; z = 0 is the skin.
type Way = Box<dyn Fn(u32) -> Vec3 + Send + Sync>;

/// How long a tool takes to press as deep as a case has it [ticks].
const PRESS: u32 = 500;
/// A way that passes for as long as a jump lasts [ticks].
const JUMP: u32 = 50;
/// Slopes over the first one and the strains at which they begin: steeper than any tissue.
const STEEP: [(f32, f32); 3] = [(0.0, 1.0), (0.03, 100.0), (0.06, 1000.0)];

/// All of them.
pub(super) fn cases() -> Vec<Case> {
    let ways = [("down", -Vec3::z()), ("sideways", Vec3::x()), ("up", Vec3::z())];
    let teleported = ways.map(|(name, way)| {
        case(
            format!("tool-teleported:{name}"),
            format!("a ball pressed 1 mm into the skin jumps 20 mm {name} for {JUMP} ms and back"),
            Patch::default(),
            (PRESS + 2 * JUMP, teleported(1e-3, way * 20e-3)),
        )
    });
    let others = [
        case(
            "tool-reversed:50-hz".to_owned(),
            "a ball pressed 1 mm into the skin runs 2 mm to and fro at 50 Hz, turning on the spot".to_owned(),
            Patch::default(),
            (PRESS + 500, reversed(1e-3, 2e-3)),
        ),
        case(
            "tremor:60-s".to_owned(),
            "a ball held 1 mm deep for a minute trembles by 0.2 mm along all axes at 10 Hz".to_owned(),
            Patch::default(),
            (PRESS + 60_000, trembling(1e-3, 2e-4)),
        ),
        case(
            "corner-by-one-voxel".to_owned(),
            "a block of 6 × 6 × 4 voxels hangs on one voxel under its corner, and is pushed 1 mm".to_owned(),
            Patch {
                fill: hanging,
                ..Patch::default()
            },
            (PRESS, pressed(1e-3)),
        ),
    ];
    teleported.into_iter().chain(others).chain(segments()).collect()
}

/// Cases whose strains cross the breaks of the curve in every tick.
fn segments() -> impl Iterator<Item = Case> {
    let what = "a ball 1 mm deep is 0.5 mm higher in every other tick: strains cross the breaks of the curve each time";
    let of = |name: &str, steep: bool| Case {
        name: format!("steep-segments:{name}"),
        what: what.to_owned(),
        equilibrium: None,
        run: Box::new(move |attempt| {
            let patch = Patch::default();
            let (mut scene, cells) = patch.scene(attempt);
            if steep {
                scene.tissues = std::iter::once(tissue(FLESH, &STEEP)).collect();
            }
            let mut memory = memory();
            let bench = Bench::new(*attempt, &mut memory, &scene, &cells)?;
            follow(bench, &patch, (PRESS + 1000, &flickering(1e-3, 5e-4)))
        }),
    };
    [of("1-4-10", false), of("1-100-1000", true)].into_iter()
}

fn case(name: String, what: String, patch: Patch, (ticks, way): (u32, Way)) -> Case {
    Case {
        name,
        what,
        equilibrium: None,
        run: Box::new(move |attempt: &Attempt<'_>| {
            let (scene, cells) = patch.scene(attempt);
            let mut memory = memory();
            let bench = Bench::new(*attempt, &mut memory, &scene, &cells)?;
            follow(bench, &patch, (ticks, &way))
        }),
    }
}

/// Goes `ticks` ticks of a way, and lifts off.
fn follow(mut bench: Bench<'_>, patch: &Patch, (ticks, way): (u32, &Way)) -> Result<Trace, Unfinished> {
    for tick in 0..=ticks {
        bench.tick(patch.grasp(way(tick)))?;
    }
    patch.lift_off(bench, way(ticks))
}

/// Presses `deep`.
fn press(deep: f32, tick: u32) -> Vec3 {
    -Vec3::z() * (deep * (tick.min(PRESS) as f32 / PRESS as f32))
}

fn pressed(deep: f32) -> Way {
    Box::new(move |tick| press(deep, tick))
}

/// Presses, jumps by `far`, and is back.
fn teleported(deep: f32, far: Vec3) -> Way {
    Box::new(move |tick| {
        let jumped = (PRESS..PRESS + JUMP).contains(&tick);
        press(deep, tick) + if jumped { far } else { Vec3::zeros() }
    })
}

/// Presses, then runs to and fro along x at 50 Hz at constant speed.
fn reversed(deep: f32, by: f32) -> Way {
    Box::new(move |tick| {
        // From −1 to 1 and back in 20 ticks, from 0.
        let phase = (tick.saturating_sub(PRESS) + 5) % 20;
        let triangle = 1.0 - (phase as f32 - 10.0).abs() / 5.0;
        press(deep, tick) - Vec3::x() * (by * triangle)
    })
}

/// Presses, then trembles at 10 Hz, a third of a period later along each axis.
fn trembling(deep: f32, by: f32) -> Way {
    Box::new(move |tick| {
        let t = f64::from(tick.saturating_sub(PRESS)) * 1e-3;
        let along = |axis: f64| by * ((TAU * (10.0 * t + axis / 3.0)).sin() - (TAU * axis / 3.0).sin()) as f32;
        press(deep, tick) + Vec3::new(along(0.0), along(1.0), along(2.0))
    })
}

/// Presses, then is `by` higher in every other tick.
fn flickering(deep: f32, by: f32) -> Way {
    Box::new(move |tick| {
        let up = tick > PRESS && tick % 2 == 0;
        press(deep, tick) + Vec3::z() * if up { by } else { 0.0 }
    })
}

/// Clear of the sides, on one voxel of the lowest layer.
fn hanging([i, j, k]: [u32; 3]) -> u8 {
    let inside = (1..7).contains(&i) && (1..7).contains(&j) && k > 0;
    u8::from(inside || [i, j, k] == [1, 1, 0])
}
