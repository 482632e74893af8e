//! What a run was: every tick's telemetry, and the figures drawn from it.

use serde::Serialize;
use sutura_shared::message::{PunctureEvent, Telemetry};
use sutura_shared::scene::Stage;

use super::profile::Profiles;
use super::watch::Motion;

impl Log {
    /// Runs of ticks with one stage of one stitch, in order.
    #[must_use]
    pub fn stages(&self) -> Vec<StageSpan> {
        let same = |a: &Telemetry, b: &Telemetry| (a.stage, a.stitch) == (b.stage, b.stitch);
        self.ticks.chunk_by(same).filter_map(StageSpan::of).collect()
    }

    /// The punctures as they are reported.
    #[must_use]
    pub fn punctures(&self) -> Vec<Puncture> {
        let report = |event: &PunctureEvent| Puncture {
            site: event.site.name(),
            stitch: event.stitch.into(),
            tick: event.tick,
            force_n: event.force_n,
            f0_n: event.f0_n,
            depth_mm: event.depth_m * 1e3,
        };
        self.punctures.iter().map(report).collect()
    }

    /// Gap before the first and after the last tick, at each stitch.
    #[must_use]
    pub fn gaps(&self) -> Vec<Change> {
        let at = |stitch: usize| self.change(|tick| tick.gap_m[stitch]);
        (0..self.stitches).filter_map(at).collect()
    }

    /// Mean gap before the first and after the last tick.
    #[must_use]
    pub fn mean_gap(&self) -> Option<Change> {
        self.change(|tick| tick.gap_mean_m)
    }

    /// Step between the edges after the last tick, at each stitch [mm].
    #[must_use]
    pub fn steps(&self) -> Vec<f32> {
        self.last_motion(|motion, stitch| motion.step_m[stitch] * 1e3)
    }

    /// Force that draws the wound together after the last tick, at each stitch [N].
    #[must_use]
    pub fn closing(&self) -> Vec<f32> {
        self.last_motion(|motion, stitch| motion.closing_n[stitch])
    }

    /// How far the thread has cut through the tissue [mm].
    #[must_use]
    pub fn torn(&self) -> f32 {
        self.motion.last().map_or(0.0, |motion| motion.torn_m * 1e3)
    }

    fn last_motion(&self, of: impl Fn(&Motion, usize) -> f32) -> Vec<f32> {
        let last = self.motion.last();
        last.map_or_else(Vec::new, |motion| {
            (0..self.stitches).map(|stitch| of(motion, stitch)).collect()
        })
    }

    fn change(&self, of: impl Fn(&Telemetry) -> f32) -> Option<Change> {
        Some(Change {
            before: of(self.ticks.first()?) * 1e3,
            after: of(self.ticks.last()?) * 1e3,
        })
    }

    /// Largest simulated and largest rendered force.
    #[must_use]
    pub fn peaks(&self) -> Peaks {
        Peaks {
            peak_simulated: largest(self.ticks.iter().map(|tick| length(tick.simulated_n))),
            peak_rendered: largest(self.ticks.iter().map(|tick| length(tick.rendered_n))),
        }
    }

    /// Fault bits that stood in any tick.
    #[must_use]
    pub fn faults(&self) -> u32 {
        self.ticks.iter().fold(0, |bits, tick| bits | tick.faults)
    }

    /// Ticks in which the device's limit shortened the force.
    #[must_use]
    pub fn saturated(&self) -> usize {
        self.ticks.iter().filter(|tick| tick.saturated).count()
    }
}

impl StageSpan {
    fn of(ticks: &[Telemetry]) -> Option<Self> {
        let (first, last) = (ticks.first()?, ticks.last()?);
        let forces = || ticks.iter().map(|tick| length(tick.simulated_n));
        Some(Self {
            stage: first.stage,
            name: first.stage.name(),
            stitch: first.stitch.into(),
            from_tick: first.tick,
            to_tick: last.tick,
            peak_n: largest(forces()),
            mean_n: (forces().map(f64::from).sum::<f64>() / ticks.len() as f64) as f32,
            thread_peak_n: largest(ticks.iter().map(|tick| tick.thread_n)),
        })
    }
}

/// Euclidean length.
#[must_use]
pub fn length(v: [f32; 3]) -> f32 {
    v.iter().map(|part| part * part).sum::<f32>().sqrt()
}

fn largest(values: impl Iterator<Item = f32>) -> f32 {
    values.fold(0.0, f32::max)
}

/// All that the controller told and showed.
#[derive(Clone, Debug, Default)]
pub struct Log {
    /// Stitches of the scene.
    pub stitches: usize,
    /// One record a tick.
    pub ticks: Vec<Telemetry>,
    /// How tool and thread moved, one record a tick.
    pub motion: Vec<Motion>,
    /// The wound along its length, ten times a second.
    pub wound: Profiles,
    /// Punctures in order.
    pub punctures: Vec<PunctureEvent>,
    /// Their places in the tissue before anything moved, patch frame [m].
    pub places: Vec<[f32; 3]>,
}

/// Ticks of one stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageSpan {
    /// Which.
    #[serde(skip)]
    pub stage: Stage,
    /// Its name.
    pub name: &'static str,
    /// Number of the stitch, from 1.
    pub stitch: u32,
    /// First tick.
    pub from_tick: u32,
    /// Last tick.
    pub to_tick: u32,
    /// Largest simulated force [N].
    pub peak_n: f32,
    /// Mean simulated force [N].
    pub mean_n: f32,
    /// Largest tension of the thread [N].
    pub thread_peak_n: f32,
}

/// One puncture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Puncture {
    /// Where.
    pub site: &'static str,
    /// Number of the stitch, from 1.
    pub stitch: u32,
    /// When.
    pub tick: u32,
    /// Force along the needle at which the skin gave way [N].
    pub force_n: f32,
    /// The scene's F0 [N].
    pub f0_n: f32,
    /// How far the skin had been pushed [mm].
    pub depth_mm: f32,
}

/// A width before and after [mm].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Change {
    /// Before the stitch.
    pub before: f32,
    /// After it.
    pub after: f32,
}

/// Largest forces of a run [N].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Peaks {
    /// As the scene says.
    pub peak_simulated: f32,
    /// As the device was told.
    pub peak_rendered: f32,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tick(tick: u32, stage: Stage, force: f32) -> Telemetry {
        Telemetry {
            tick,
            stage,
            stitch: 1,
            faults: 0,
            position_m: [0.0; 3],
            simulated_n: [0.6 * force, 0.0, 0.8 * force],
            rendered_n: [0.0, force / 2.0, 0.0],
            torque_n_m: [0.0; 3],
            thread_n: 0.1 * force,
            gap_m: [0.004 - 0.001 * tick as f32, 0.0, 0.0],
            gap_mean_m: 0.004,
            saturated: tick == 2,
        }
    }

    #[test]
    fn stages_are_runs_of_ticks_with_peak_and_mean() {
        let ticks = vec![
            tick(1, Stage::Approach, 0.0),
            tick(2, Stage::Indent, 1.0),
            tick(3, Stage::Indent, 3.0),
            tick(4, Stage::Done, 0.0),
        ];
        let log = Log {
            ticks,
            stitches: 1,
            ..Log::default()
        };
        let stages = log.stages();
        assert_eq!(
            stages
                .iter()
                .map(|s| (s.name, s.from_tick, s.to_tick))
                .collect::<Vec<_>>(),
            [("approach", 1, 1), ("indent", 2, 3), ("done", 4, 4)]
        );
        assert!((stages[1].peak_n - 3.0).abs() < 1e-6 && (stages[1].mean_n - 2.0).abs() < 1e-6);
        assert!((stages[1].thread_peak_n - 0.3).abs() < 1e-6);
        assert!((log.peaks().peak_rendered - 1.5).abs() < 1e-6);
        let gaps = log.gaps();
        let [stitch] = gaps.as_slice() else { panic!("{gaps:?}") };
        assert!((stitch.before - 3.0).abs() < 1e-5 && stitch.after.abs() < 1e-5);
        assert_eq!(log.saturated(), 1);
    }
}
