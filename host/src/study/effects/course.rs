//! Scenes that differ in an effect, from beginning to end, some ticks of each in turn.

use std::sync::atomic::{AtomicBool, Ordering};

use sutura_controller::lanes::Level;
use sutura_controller::lattice::PC_NODES;
use sutura_controller::link::Plant;
use sutura_controller::record::Output;
use sutura_controller::tick::Memory;
use sutura_shared::scene::{Scene, Stage};

use super::{Error, Progress};
use crate::link::thread_time;
use crate::run::embedded::PcRig;
use crate::run::log::length;
use crate::run::{AFTER, TICKS_MAX};

/// Ticks of one scene before the next has its turn: enough for its memory to be in the cache again.
const TURN: u32 = 100;

/// What one scene did, tick by tick.
#[derive(Clone, Debug, Default)]
pub(super) struct Course {
    seen: Vec<Seen>,
    /// CPU time of each tick [ns].
    ns: Vec<u64>,
}

/// What is kept of a tick.
#[derive(Clone, Copy, Debug)]
struct Seen {
    stage: Stage,
    simulated_n: [f32; 3],
    gap_m: f32,
}

/// Runs all scenes for as long as the first goes on.
pub(super) fn run(
    scenes: &[&Scene],
    cells: &[u8],
    level: Level,
    interrupted: &AtomicBool,
    progress: Progress<'_>,
) -> Result<Vec<Course>, Error> {
    let mut memories: Vec<Box<Memory<PC_NODES>>> = scenes.iter().map(|_| bytemuck::zeroed_box()).collect();
    let mut runs = Vec::new();
    for (memory, scene) in memories.iter_mut().zip(scenes) {
        let mut rig = PcRig::new(memory, level);
        rig.load(scene, cells).map_err(|error| Error::Refused(error.0))?;
        runs.push((rig, Course::default()));
    }
    let mut tick = 0;
    while tick < TICKS_MAX && !runs.first().is_none_or(|(_, first)| first.is_over()) {
        progress(&format!(
            "{:.1} s simulated of {} scenes",
            f64::from(tick) * 1e-3,
            runs.len()
        ));
        for (rig, course) in &mut runs {
            (0..TURN).for_each(|_| course.tick(rig));
        }
        tick += TURN;
        if interrupted.load(Ordering::Relaxed) {
            return Err(Error::Interrupted);
        }
    }
    Ok(runs.into_iter().map(|(_, course)| course).collect())
}

impl Course {
    fn tick(&mut self, rig: &mut PcRig<'_>) {
        let start = thread_time();
        let output = rig.tick();
        self.ns.push(thread_time().saturating_sub(start).as_nanos() as u64);
        self.seen.push(Seen::of(&output));
    }

    /// Whether the stitch has been done for as long as a run goes on after it.
    fn is_over(&self) -> bool {
        let done = self.seen.iter().rev().take_while(|seen| seen.stage == Stage::Done);
        done.count() >= AFTER as usize
    }

    /// Ticks that were run.
    pub(super) fn ticks(&self) -> usize {
        self.seen.len()
    }

    /// Median CPU time of a tick [µs].
    pub(super) fn median_us(&self) -> f64 {
        crate::run::report::TickTime::of(self.ns.clone()).median
    }

    /// Root mean square over the ticks of the distance between this force and the other's in the same tick [N].
    pub(super) fn force_change_rms_n(&self, other: &Self) -> f64 {
        let squares = self.seen.iter().zip(&other.seen).map(|(a, b)| {
            let parts = a.simulated_n.iter().zip(b.simulated_n);
            parts.map(|(a, b)| f64::from(b - a).powi(2)).sum::<f64>()
        });
        (squares.sum::<f64>() / self.seen.len().max(1) as f64).sqrt()
    }

    /// Largest force of a stage, 0 where it was not reached [N].
    fn peak_n(&self, stage: Stage) -> f64 {
        let forces = self.seen.iter().filter(|seen| seen.stage == stage);
        f64::from(forces.map(|seen| length(seen.simulated_n)).fold(0.0, f32::max))
    }

    /// The stage whose peak is changed most in the other course, and by how much [N].
    pub(super) fn peak_change_n(&self, other: &Self) -> (Stage, f64) {
        let change = |stage| (stage, other.peak_n(stage) - self.peak_n(stage));
        let larger = |most: (Stage, f64), next: (Stage, f64)| if next.1.abs() > most.1.abs() { next } else { most };
        Stage::ALL.map(change).into_iter().fold((Stage::Approach, 0.0), larger)
    }

    /// How much wider the wound is at the end of the other course [mm].
    pub(super) fn gap_change_mm(&self, other: &Self) -> f64 {
        let end = |course: &Self| course.seen.last().map_or(0.0, |seen| f64::from(seen.gap_m) * 1e3);
        end(other) - end(self)
    }
}

impl Seen {
    fn of(output: &Output) -> Self {
        Self {
            stage: output.stage,
            simulated_n: output.simulated.into(),
            gap_m: output.gap[0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(forces: &[(Stage, f32)], gap_m: f32) -> Course {
        let seen = forces.iter().map(|&(stage, force)| Seen {
            stage,
            simulated_n: [0.6 * force, 0.0, 0.8 * force],
            gap_m,
        });
        Course {
            seen: seen.collect(),
            ns: Vec::new(),
        }
    }

    /// Changes of 0, 3, 0 and 4 N have a root mean square of 5/2 N; that of the peaks is −1 N in the first stage and 4 N in the second.
    #[test]
    fn changes_are_without_less_with() {
        let with = course(
            &[
                (Stage::Indent, 2.0),
                (Stage::Indent, 4.0),
                (Stage::Drive, 1.0),
                (Stage::Drive, 1.0),
            ],
            1e-3,
        );
        let without = course(
            &[
                (Stage::Indent, 2.0),
                (Stage::Indent, 1.0),
                (Stage::Drive, 1.0),
                (Stage::Drive, 5.0),
            ],
            3e-3,
        );
        assert!((with.force_change_rms_n(&without) - 2.5).abs() < 1e-6);
        let (stage, change) = with.peak_change_n(&without);
        assert!(stage == Stage::Drive && (change - 4.0).abs() < 1e-6);
        assert!((with.gap_change_mm(&without) - 2.0).abs() < 1e-6);
    }
}
