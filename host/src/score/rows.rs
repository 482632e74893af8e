//! The rows of a recording. Which there are depends on the scene alone: what was not reached has no value and no points.

use nalgebra::Vector3;
use sutura_shared::scene::{Effect, Stage, Tool};

use super::Row;
use super::record::{Puncture, Recording, Tick};
use super::table::*;
use crate::scene::plan::Plan;

/// Period of a tick [s].
const DT: f64 = 1e-3;
/// Ticks before the knot over which a tension counts as held.
const HELD: usize = 200;
/// Where the needle goes in and where it comes out.
const SITES: [&str; 2] = ["a", "d"];

/// Every row.
pub(super) fn rows(recording: &Recording) -> Vec<Row> {
    let plan = &recording.plan;
    let has = |effect| plan.effects.has(effect);
    let mut rows = Vec::new();
    if let (
        Tool::Needle {
            radius_m,
            length_m,
            grasp_m,
        },
        true,
    ) = (plan.tool, has(Effect::Puncture))
    {
        let needle = Needle {
            radius: radius_m.into(),
            ahead: (length_m - grasp_m).into(),
        };
        for stitch in 1..=stitches(recording) {
            let mut one = Stitch::of(recording, stitch).rows(recording, &needle);
            one.iter_mut().for_each(|row| row.stitch = Some(stitch));
            rows.extend(one);
        }
        rows.extend(spacing(recording));
        rows.push(Row::new(EXTRA, Some(extra(recording))));
    }
    rows.extend(forces(&recording.ticks));
    if has(Effect::Thread) {
        rows.extend(thread(recording));
    }
    if has(Effect::Tearing) {
        rows.push(Row::new(TORN, recording.ticks.last().and_then(|last| last.torn_mm)));
    }
    let way = recording
        .ticks
        .windows(2)
        .map(|pair| (pair[1].position - pair[0].position).norm());
    rows.push(Row::new(PATH, Some(way.sum())));
    rows.push(Row::new(TIME, finished(&recording.ticks)));
    rows.extend(stages(&recording.ticks));
    rows
}

/// A needle's arc.
struct Needle {
    radius: f64,
    /// Arc length from the grasp to the tip.
    ahead: f64,
}

impl Needle {
    /// The tip and its direction.
    fn tip(&self, tick: &Tick) -> (Vector3<f64>, Vector3<f64>) {
        let (sin, cos) = (self.ahead / self.radius).sin_cos();
        let place = tick.position + tick.turn * Vector3::new(cos - 1.0, sin, 0.0) * self.radius;
        (place, tick.turn * Vector3::new(-sin, cos, 0.0))
    }

    /// Distance of `place` from the circle of the arc as it stands at `tick` [m].
    fn off_circle(&self, tick: &Tick, place: Vector3<f64>) -> f64 {
        let centre = tick.position - tick.turn * Vector3::x() * self.radius;
        let from = tick.turn.inverse() * (place - centre);
        (from.xy().norm() - self.radius).hypot(from.z)
    }

    /// Angle between needle and skin at a puncture [°].
    fn angle(&self, tick: &Tick) -> f64 {
        self.tip(tick).1.z.abs().min(1.0).asin().to_degrees()
    }

    /// The steepest angle at which the arc can meet the skin at both ends of the bite that the scene asks for [°]: its sine is half their
    /// distance over the radius.
    fn best(&self, plan: &Plan) -> Option<f64> {
        let gap_mm = plan.wound.map_or(0.0, |wound| wound.gap_mm);
        let half_mm = plan.stitch?.bite_mm + gap_mm / 2.0;
        Some((half_mm * 1e-3 / self.radius).min(1.0).asin().to_degrees())
    }
}

/// The punctures that one stitch has used: of several at one site the last.
struct Stitch<'a> {
    ends: [Option<&'a Puncture>; 2],
}

impl<'a> Stitch<'a> {
    fn of(recording: &'a Recording, stitch: u32) -> Self {
        let last = |site| {
            let of_site = |puncture: &&Puncture| puncture.stitch == stitch && puncture.site == site;
            recording.punctures.iter().rev().find(of_site)
        };
        Self { ends: SITES.map(last) }
    }

    /// Both ends, entry first.
    fn both(&self) -> Option<[&'a Puncture; 2]> {
        let [entry, exit] = self.ends;
        Some([entry?, exit?])
    }

    /// From the entry to the exit, or as long as the needle is driven.
    fn driven(&self, ticks: &'a [Tick]) -> Option<&'a [Tick]> {
        let [entry, exit] = self.ends;
        let from = entry?.tick - 1;
        let drives = |tick: &Tick| matches!(tick.stage, Stage::Indent | Stage::Drive | Stage::Exit);
        let rest = ticks.get(from..)?;
        let to = exit.filter(|exit| exit.tick > from).map_or_else(
            || rest.iter().position(|tick| !drives(tick)).unwrap_or(rest.len()),
            |exit| exit.tick - from,
        );
        rest.get(..to).filter(|driven| !driven.is_empty())
    }

    fn rows(&self, recording: &Recording, needle: &Needle) -> Vec<Row> {
        let ticks = &recording.ticks;
        let angle = |end: Option<&Puncture>| end.map(|puncture| needle.angle(&ticks[puncture.tick - 1]));
        let best = needle.best(&recording.plan);
        let mut rows = vec![
            Row {
                best,
                ..Row::new(ENTRY_ANGLE, angle(self.ends[0]))
            },
            Row {
                best,
                ..Row::new(EXIT_ANGLE, angle(self.ends[1]))
            },
        ];
        if let Some(wound) = recording.plan.wound {
            let bite = |end: Option<&Puncture>| Some(end?.place().x.abs() * 1e3 - wound.gap_mm / 2.0);
            let [entry, exit] = self.ends.map(bite);
            rows.push(Row::new(BITE_IN, entry));
            rows.push(Row::new(BITE_OUT, exit));
            rows.push(Row::new(
                ASYMMETRY,
                entry.zip(exit).map(|(entry, exit)| (entry - exit).abs()),
            ));
        }
        let driven = self.driven(ticks);
        let depth = self.both().zip(driven).map(|([entry, exit], driven)| {
            let skin = (entry.place().z + exit.place().z) / 2.0;
            most(driven.iter().map(|tick| (skin - needle.tip(tick).0.z) * 1e3))
        });
        let off = driven.map(|driven| {
            // Half way the needle stands as it is led, neither pushed into the skin nor lifting it.
            let circle = &driven[driven.len() / 2];
            driven
                .iter()
                .map(|tick| needle.off_circle(circle, needle.tip(tick).0) * 1e3)
        });
        let side = driven.map(|driven| driven.iter().map(|tick| tick.side));
        rows.push(Row::new(DEPTH, depth));
        rows.push(Row::new(ARC, off.clone().map(rms)));
        rows.push(Row::new(ARC_MOST, off.map(most)));
        rows.push(Row::new(SIDE, side.clone().map(mean)));
        rows.push(Row::new(SIDE_MOST, side.map(most)));
        rows
    }
}

/// Stitches of the scene.
fn stitches(recording: &Recording) -> u32 {
    recording.plan.stitch.map_or(1, |stitch| stitch.stitches.into())
}

/// Distances along the wound from stitch to stitch, where there are several.
fn spacing(recording: &Recording) -> Vec<Row> {
    let middle = |stitch| {
        let [entry, exit] = Stitch::of(recording, stitch).both()?;
        Some((entry.place().y + exit.place().y) / 2.0)
    };
    let middles: Vec<_> = (1..=stitches(recording)).filter_map(middle).collect();
    let steps: Vec<_> = middles.windows(2).map(|pair| (pair[1] - pair[0]).abs() * 1e3).collect();
    if stitches(recording) < 2 {
        return Vec::new();
    }
    let average = (!steps.is_empty()).then(|| mean(steps.iter().copied()));
    let spread = average.map(|average| rms(steps.iter().map(|step| step - average)) / average);
    vec![Row::new(SPACING, average), Row::new(SPACING_SPREAD, spread)]
}

/// Punctures at a site that had been punctured before in the same stitch.
fn extra(recording: &Recording) -> f64 {
    let mut sites: Vec<_> = recording
        .punctures
        .iter()
        .map(|p| (p.stitch, p.site.as_str()))
        .collect();
    let made = sites.len();
    sites.sort_unstable();
    sites.dedup();
    (made - sites.len()) as f64
}

/// Force over the whole run.
fn forces(ticks: &[Tick]) -> Vec<Row> {
    let above = |limit: f64| ticks.iter().filter(|tick| tick.force > limit).count() as f64 * DT;
    let touching: Vec<_> = ticks
        .iter()
        .map(|tick| tick.force)
        .filter(|force| *force > TOUCHED_N)
        .collect();
    let changes = ticks.windows(2).filter(|pair| pair[1].force > TOUCHED_N);
    let changes: Vec<_> = changes.map(|pair| (pair[1].force - pair[0].force) / DT).collect();
    vec![
        Row::new(PEAK, Some(most(ticks.iter().map(|tick| tick.force)))),
        Row::new(MEAN, Some(mean(touching.into_iter()))),
        Row::new(ABOVE_EXPERT, Some(above(EXPERT_N))),
        Row::new(ABOVE_NOVICE, Some(above(NOVICE_N))),
        Row::new(ROUGHNESS, Some(rms(changes.into_iter()))),
    ]
}

/// Force in each stage, over all stitches.
fn stages(ticks: &[Tick]) -> Vec<Row> {
    let mut rows = Vec::new();
    for stage in Stage::ALL {
        let forces = || ticks.iter().filter(|tick| tick.stage == stage).map(|tick| tick.force);
        if forces().next().is_none() {
            continue;
        }
        let within = ticks
            .windows(2)
            .filter(|pair| pair.iter().all(|tick| tick.stage == stage));
        let changes = within.map(|pair| (pair[1].force - pair[0].force) / DT);
        let values = [
            (STAGE_PEAK, most(forces())),
            (STAGE_MEAN, mean(forces())),
            (STAGE_IMPULSE, forces().sum::<f64>() * DT),
            (STAGE_ROUGHNESS, rms(changes)),
        ];
        rows.extend(values.map(|(kind, value)| Row {
            stage: Some(stage.name()),
            ..Row::new(kind, Some(value))
        }));
    }
    rows
}

/// Thread and wound.
fn thread(recording: &Recording) -> Vec<Row> {
    let ticks = &recording.ticks;
    let end = ticks.last().filter(|tick| tick.stage == Stage::Done);
    let pulled = ticks
        .iter()
        .rposition(|tick| tick.stage == Stage::Tension)
        .map(|last| &ticks[..=last]);
    let held = pulled.map(|pulled| {
        let back = pulled
            .iter()
            .rev()
            .take(HELD)
            .take_while(|tick| tick.stage == Stage::Tension);
        mean(back.map(|tick| tick.tension[0]))
    });
    let peak = most(ticks.iter().flat_map(|tick| tick.tension));
    let mut rows = vec![
        Row::new(THREAD_PEAK, pulled.map(|_| peak)),
        Row::new(TENSION_HELD, held),
        Row::new(TENSION_LEFT, end.map(|end| end.tension[1])),
    ];
    if let Some(wound) = recording.plan.wound {
        let loaded = pulled.and_then(<[Tick]>::last);
        for stitch in 1..=stitches(recording) {
            let of = |tick: Option<&Tick>| tick.map(|tick| tick.gap_mm[stitch as usize - 1]);
            let step = end.and_then(|end| end.step_mm[stitch as usize - 1]);
            let closing = end.and_then(|end| end.closing_n[stitch as usize - 1]);
            for (kind, value) in [
                (GAP_LOADED, of(loaded)),
                (GAP_LEFT, of(end)),
                (STEP, step.map(f64::abs)),
                (CLOSING, closing),
            ] {
                rows.push(Row {
                    stitch: Some(stitch),
                    ..Row::new(kind, value)
                });
            }
        }
        rows.push(Row::new(
            THREAD_USED,
            end.map(|end| end.stitch_m * 1e3 / wound.length_mm),
        ));
    }
    rows
}

/// When the last stitch was done [s].
fn finished(ticks: &[Tick]) -> Option<f64> {
    let after = ticks.iter().rev().take_while(|tick| tick.stage == Stage::Done).count();
    (after > 0).then(|| (ticks.len() - after) as f64 * DT)
}

fn most(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// Zero of nothing.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
    if count > 0.0 { sum / count } else { 0.0 }
}

/// Zero of nothing.
fn rms(values: impl Iterator<Item = f64>) -> f64 {
    mean(values.map(|value| value * value)).sqrt()
}
