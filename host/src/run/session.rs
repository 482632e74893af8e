//! A session with a controller of our own: upload, ticks, and all that is heard and seen of them.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use sutura_shared::message::{Telemetry, ToHost};
use sutura_shared::scene::Stage;

use super::embedded::{self, Embedded};
use super::files;
use super::log::Log;
use super::vtk::Series;
use super::watch::Seen;
use super::{AFTER, Error, Request, TICKS_MAX};
use crate::link::{Counts, Link, Pace, Ran};
use crate::scene::build::Built;

/// What came of a session.
pub(super) struct Session {
    pub(super) log: Log,
    pub(super) series: Option<Series>,
    pub(super) ticks: u32,
    pub(super) state_hash: u64,
    pub(super) counts: Counts,
    pub(super) ran: Ran,
}

/// Uploads the scene and listens until the run is over.
pub(super) fn listen(
    request: &Request,
    built: &Built,
    interrupted: &AtomicBool,
    mut progress: impl FnMut(&Telemetry),
) -> Result<Session, Error> {
    let pace = if request.realtime { Pace::Realtime } else { Pace::Free };
    let frames = request.frames.as_ref();
    let mut series = frames.map(|frames| Series::begin(frames, built)).transpose()?;
    let every = frames.map(|frames| frames.every);
    let Embedded { line, seen, thread } = embedded::start(pace, request.level, every).map_err(Error::Thread)?;
    let mut link = Link::connect(line)?;
    link.upload(&built.scene, &built.cells)?;
    let mut log = Log {
        stitches: built.scene.stitch.map_or(1, |stitch| stitch.count.into()),
        ..Log::default()
    };
    let mut filed = Ok(());
    let mut done_for = 0;
    let last_tick = request
        .seconds
        .map_or(TICKS_MAX, |seconds| ((seconds * 1e3).ceil() as u32).clamp(1, TICKS_MAX));
    let (ticks, state_hash) = link.run(last_tick, |message| {
        match message {
            ToHost::Telemetry(tick) => {
                done_for = if tick.stage == Stage::Done { done_for + 1 } else { 0 };
                progress(tick);
                log.ticks.push(*tick);
                let seen = seen.try_recv().unwrap_or_default();
                if filed.is_ok() {
                    filed = keep(seen, &mut log, series.as_mut());
                }
            }
            ToHost::Puncture(puncture) => log.punctures.push(*puncture),
            _ => {}
        }
        if done_for >= AFTER || filed.is_err() || interrupted.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })?;
    let counts = link.counts();
    drop(link);
    let ran = thread.join().map_err(|_| Error::Controller)?;
    if interrupted.load(Ordering::Relaxed) {
        return Err(Error::Interrupted);
    }
    filed?;
    Ok(Session {
        log,
        series,
        ticks,
        state_hash,
        counts,
        ran,
    })
}

/// Keeps what was seen of one tick.
fn keep(seen: Seen, log: &mut Log, series: Option<&mut Series>) -> Result<(), files::Error> {
    log.motion.push(seen.motion);
    log.wound.see(log.ticks.len(), seen.wound);
    log.places.extend(seen.puncture_m);
    match (series, seen.frame) {
        (Some(series), Some(frame)) => series.add(&frame, &log.punctures),
        _ => Ok(()),
    }
}
