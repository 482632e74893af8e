//! What a run says at its end: one JSON object, or a table for people.

use std::fmt::{self, Display, Formatter};

use serde::Serialize;
use sutura_controller::effects::TABLE;

use super::log::{Change, Peaks, Puncture, StageSpan};
use crate::scene::skill::Person;
use crate::score::Score;
use crate::study::budget::Auto;
use crate::voxelize::Springs;

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.manifest(f)?;
        writeln!(f)?;
        writeln!(
            f,
            "{} voxels, {} nodes, {} edge springs, {} body diagonals; solver {}",
            self.voxels, self.nodes, self.springs.edge, self.springs.body_diagonal, self.solver
        )?;
        if let Some(Person { skill, seed }) = &self.person {
            writeln!(f, "sewn by a hand of skill {}, seed {seed}", skill.name)?;
        }
        if let Some(auto) = &self.auto {
            writeln!(f, "the solver was chosen {auto}")?;
        }
        writeln!(f)?;
        self.stages(f)?;
        writeln!(f)?;
        for puncture in &self.punctures {
            let Puncture {
                site,
                stitch,
                force_n,
                f0_n,
                depth_mm,
                ..
            } = puncture;
            writeln!(
                f,
                "puncture {site}, stitch {stitch}: {force_n:.3} N (F0 {f0_n:.3} N) after {depth_mm:.2} mm"
            )?;
        }
        self.gaps(f)?;
        if let Some(torn) = self.torn_mm {
            writeln!(f, "the thread has cut {torn:.2} mm through the tissue")?;
        }
        if !self.faults.is_empty() {
            writeln!(f, "faults: {}", self.faults.join(", "))?;
        }
        let TickTime { median, p99, max } = self.tick_us;
        writeln!(
            f,
            "a tick took {median:.0} µs (median), {p99:.0} µs (99 %), {max:.0} µs (most); state hash {}",
            self.state_hash
        )?;
        writeln!(f)?;
        if let Some(score) = &self.score {
            writeln!(f, "{score}")?;
            writeln!(f)?;
        }
        write!(
            f,
            "files: {0}/force.csv, {0}/force.png, {0}/score.md, {0}/score.json, {0}/scene.toml",
            self.out
        )
    }
}

impl Report {
    /// Times and forces of the stages.
    fn stages(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "stitch stage            from s      to s    peak N    mean N  thread N"
        )?;
        for stage in &self.stages {
            let [from, to] = [stage.from_tick - 1, stage.to_tick].map(|tick| f64::from(tick) * 1e-3);
            let StageSpan {
                name,
                stitch,
                peak_n,
                mean_n,
                thread_peak_n,
                ..
            } = stage;
            writeln!(
                f,
                "{stitch:>6} {name:<13}{from:>10.3}{to:>10.3}{peak_n:>10.3}{mean_n:>10.3}{thread_peak_n:>10.3}"
            )?;
        }
        Ok(())
    }

    /// The wound before and after.
    fn gaps(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (stitch, Change { before, after }) in (1..).zip(&self.wound_gap_mm.at_stitch) {
            write!(f, "gap at stitch {stitch}: {before:.2} mm before, {after:.2} mm after")?;
            if let Some(step) = self.wound_step_mm.get(stitch - 1) {
                write!(f, "; step between the edges {:.2} mm", step.abs())?;
            }
            if let Some(closing) = self.closing_n.get(stitch - 1) {
                write!(f, "; drawn together with {closing:.2} N")?;
            }
            writeln!(f)?;
        }
        if let Some(Change { before, after }) = &self.wound_gap_mm.mean {
            let over = match self.wound_gap_mm.at_stitch.len() {
                0 | 1 => "over the wound's length",
                _ => "between the end stitches",
            };
            writeln!(f, "gap {over}: {before:.2} mm before, {after:.2} mm after")?;
        }
        Ok(())
    }

    /// What the scene simulates, and what it does not.
    fn manifest(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for row in TABLE.iter().filter(|row| self.effects.contains(&row.effect.name())) {
            writeln!(f, "{:<15} {}", row.effect.name(), row.simulates)?;
        }
        if !self.effects_off.is_empty() {
            writeln!(f, "not simulated:  {}", self.effects_off.join(", "))?;
        }
        Ok(())
    }
}

/// The keys of `--json`.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Voxels of the patch.
    pub voxels: usize,
    /// Mass points.
    pub nodes: usize,
    /// Those on its surface.
    pub surface_nodes: usize,
    /// Springs.
    pub springs: Springs,
    /// Voxels of each tissue.
    pub tissues: serde_json::Map<String, serde_json::Value>,
    /// Effects that were on.
    pub effects: Vec<&'static str>,
    /// Effects that were off.
    pub effects_off: Vec<&'static str>,
    /// How the tissue was advanced.
    pub solver: String,
    /// Whose hand sewed, as `operator` and `seed`, where it was not the script's own.
    #[serde(flatten)]
    pub person: Option<Person>,
    /// What it was chosen by, where a clock chose it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub auto: Option<Auto>,
    /// Ticks that were run.
    pub ticks: u32,
    /// Stages in order.
    pub stages: Vec<StageSpan>,
    /// Punctures in order.
    pub punctures: Vec<Puncture>,
    /// Width of the wound.
    pub wound_gap_mm: WoundGap,
    /// How much higher the wound's right edge stands than the left one at the end, at each stitch [mm].
    pub wound_step_mm: Vec<f32>,
    /// Force with which the thread draws the wound together at the end, at each stitch [N].
    pub closing_n: Vec<f32>,
    /// How far the thread has cut through the tissue [mm]; effect `tearing`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torn_mm: Option<f32>,
    /// Largest forces.
    pub force_n: Peaks,
    /// Ticks in which the device's limit shortened the force.
    pub saturated_ticks: usize,
    /// Names of faults that stood.
    pub faults: Vec<&'static str>,
    /// Hash of everything that happened, 16 hexadecimal digits.
    pub state_hash: String,
    /// CPU time of a tick [µs].
    pub tick_us: TickTime,
    /// Frames between host and controller.
    pub link: LinkCount,
    /// The score card.
    pub score: Option<Score>,
    /// Folder of the files.
    pub out: String,
}

/// Width of the wound [mm].
#[derive(Clone, Debug, Default, Serialize)]
pub struct WoundGap {
    /// At each stitch; none without a wound.
    pub at_stitch: Vec<Change>,
    /// Over the wound's length.
    pub mean: Option<Change>,
}

/// CPU time of a tick [µs].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TickTime {
    /// Half of the ticks took less.
    pub median: f64,
    /// 99 % took less.
    pub p99: f64,
    /// None took more.
    pub max: f64,
}

impl TickTime {
    /// From the CPU time of every tick [ns].
    #[must_use]
    pub fn of(mut ns: Vec<u64>) -> Self {
        ns.sort_unstable();
        let at = |part: f64| ns.get(((ns.len() as f64 * part) as usize).min(ns.len().saturating_sub(1)));
        let us = |part| at(part).map_or(0.0, |&ns| ns as f64 * 1e-3);
        Self {
            median: us(0.5),
            p99: us(0.99),
            max: us(1.0),
        }
    }
}

/// Frames between host and controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct LinkCount {
    /// Frames that came, both ways.
    pub frames: u64,
    /// Frames that were broken.
    pub errors: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_quantiles_of_the_ticks() {
        let ns: Vec<u64> = (1..=1000).rev().map(|us| us * 1000).collect();
        assert_eq!(
            TickTime::of(ns),
            TickTime {
                median: 501.0,
                p99: 991.0,
                max: 1000.0
            }
        );
        assert_eq!(TickTime::of(Vec::new()), TickTime::default());
    }
}
