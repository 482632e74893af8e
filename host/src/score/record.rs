//! A recorded run as its folder has it: the scene, force.csv, motion.csv and punctures.csv.

use std::path::{Path, PathBuf};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use sutura_shared::scene::{STITCHES_MAX, Stage};

use super::Error;
use crate::run::files::{FORCE, MOTION, PUNCTURES, SCENE};
use crate::scene::draft::Draft;
use crate::scene::plan::Plan;

/// A run.
#[derive(Debug)]
pub(super) struct Recording {
    pub(super) plan: Plan,
    /// One record a tick, the first of tick 1.
    pub(super) ticks: Vec<Tick>,
    /// In order.
    pub(super) punctures: Vec<Puncture>,
}

/// One tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tick {
    pub(super) stage: Stage,
    /// Grasp point of the tool, patch frame [m].
    pub(super) position: Vector3<f64>,
    /// Axes of the tool, patch frame.
    pub(super) turn: UnitQuaternion<f64>,
    /// Simulated force on the hand [N].
    pub(super) force: f64,
    /// Of it, what lies across the needle [N].
    pub(super) side: f64,
    /// Tension on the needle, and between the punctures [N].
    pub(super) tension: [f64; 2],
    /// Thread between the punctures [m].
    pub(super) stitch_m: f64,
    /// How far the thread has cut through the tissue [mm].
    pub(super) torn_mm: Option<f64>,
    /// Width of the wound at each stitch [mm]; of no meaning beyond the scene's last.
    pub(super) gap_mm: [f64; STITCHES_MAX],
    /// How much higher the right edge stands, at each stitch [mm]; none beyond the scene's last.
    pub(super) step_mm: [Option<f64>; STITCHES_MAX],
    /// Force with which the thread draws the wound together, at each stitch [N]; none beyond the scene's last.
    pub(super) closing_n: [Option<f64>; STITCHES_MAX],
}

/// A line of punctures.csv.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub(super) struct Puncture {
    pub(super) tick: usize,
    pub(super) stitch: u32,
    pub(super) site: String,
    x_m: f64,
    y_m: f64,
    z_m: f64,
}

impl Puncture {
    /// The place in the tissue before anything moved, patch frame [m].
    pub(super) fn place(&self) -> Vector3<f64> {
        Vector3::new(self.x_m, self.y_m, self.z_m)
    }
}

/// A line of force.csv, as far as it is scored.
#[derive(Deserialize)]
struct ForceLine {
    tick: usize,
    stage: String,
    x_m: f64,
    y_m: f64,
    z_m: f64,
    simulated_n: f64,
    thread_n: f64,
    gap_mm: f64,
}

/// A line of motion.csv, as far as it is scored.
#[derive(Deserialize)]
struct MotionLine {
    tick: usize,
    qw: f64,
    qx: f64,
    qy: f64,
    qz: f64,
    side_n: f64,
    stitch_n: f64,
    stitch_m: f64,
    #[serde(default)]
    gap_2_mm: f64,
    #[serde(default)]
    gap_3_mm: f64,
    torn_mm: Option<f64>,
    step_mm: Option<f64>,
    step_2_mm: Option<f64>,
    step_3_mm: Option<f64>,
    closing_n: Option<f64>,
    closing_2_n: Option<f64>,
    closing_3_n: Option<f64>,
}

/// Reads a run's folder.
pub(super) fn read(folder: &Path) -> Result<Recording, Error> {
    let plan = Draft::open(Some(&folder.join(SCENE)), &[])?.plan()?;
    let [force, motion, punctures] = [FORCE, MOTION, PUNCTURES].map(|name| folder.join(name));
    let (forces, motions) = (lines::<ForceLine>(&force)?, lines::<MotionLine>(&motion)?);
    if forces.len() != motions.len() {
        let what = format!(
            "{} ticks, but {FORCE} has {}: one of them is cut off",
            motions.len(),
            forces.len()
        );
        return Err(bad(&motion, what));
    }
    if forces.is_empty() {
        return Err(bad(&force, "it holds no tick"));
    }
    let pairs = forces.iter().zip(&motions).zip(1..);
    let ticks = pairs.map(|((force_line, motion_line), tick)| {
        for (path, found) in [(&force, force_line.tick), (&motion, motion_line.tick)] {
            if found != tick {
                return Err(bad(path, format!("tick {found} stands where tick {tick} is to be")));
            }
        }
        joined(force_line, motion_line).map_err(|what| bad(&force, format!("tick {tick}: {what}")))
    });
    let ticks = ticks.collect::<Result<Vec<_>, _>>()?;
    let made: Vec<Puncture> = lines(&punctures)?;
    let outside = |puncture: &&Puncture| !(1..=ticks.len()).contains(&puncture.tick);
    if let Some(puncture) = made.iter().find(outside) {
        return Err(bad(&punctures, format!("tick {} is not in {FORCE}", puncture.tick)));
    }
    Ok(Recording {
        plan,
        ticks,
        punctures: made,
    })
}

fn joined(force: &ForceLine, motion: &MotionLine) -> Result<Tick, String> {
    let stage = Stage::ALL.into_iter().find(|stage| stage.name() == force.stage);
    let tick = Tick {
        stage: stage.ok_or_else(|| format!("there is no stage `{}`", force.stage))?,
        position: Vector3::new(force.x_m, force.y_m, force.z_m),
        turn: UnitQuaternion::new_normalize(Quaternion::new(motion.qw, motion.qx, motion.qy, motion.qz)),
        force: force.simulated_n,
        side: motion.side_n,
        tension: [force.thread_n, motion.stitch_n],
        stitch_m: motion.stitch_m,
        gap_mm: [force.gap_mm, motion.gap_2_mm, motion.gap_3_mm],
        torn_mm: motion.torn_mm,
        step_mm: [motion.step_mm, motion.step_2_mm, motion.step_3_mm],
        closing_n: [motion.closing_n, motion.closing_2_n, motion.closing_3_n],
    };
    let scalars = [tick.force, tick.side, tick.stitch_m];
    let numbers = scalars
        .iter()
        .chain(&tick.tension)
        .chain(&tick.gap_mm)
        .chain(&tick.torn_mm)
        .chain(tick.step_mm.iter().flatten())
        .chain(tick.closing_n.iter().flatten())
        .chain(&tick.position)
        .chain(&tick.turn.coords);
    if numbers.copied().all(f64::is_finite) {
        Ok(tick)
    } else {
        Err("not every number is finite".to_owned())
    }
}

/// All lines of a table, which must end with a whole one.
fn lines<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, Error> {
    let text = std::fs::read_to_string(path).map_err(|error| bad(path, error))?;
    if !text.ends_with('\n') {
        return Err(bad(path, "its last line is cut off"));
    }
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let read: Result<Vec<T>, _> = reader.deserialize().collect();
    read.map_err(|error| bad(path, error))
}

fn bad(path: &Path, what: impl ToString) -> Error {
    Error::Recording {
        path: PathBuf::from(path),
        what: what.to_string(),
    }
}
