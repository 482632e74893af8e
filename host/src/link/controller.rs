//! The loop of a controller that lives in a thread of this process.

use super::transport::Transport;
use rustix::time::{ClockId, clock_gettime};
use std::time::{Duration, Instant};
use sutura_controller::link::{Plant, Received, Server};
use sutura_shared::limits::STAGING_MAX;

/// The tick's period.
const PERIOD: Duration = Duration::from_millis(1);
/// How long to wait at once when nothing is granted.
const IDLE: Duration = Duration::from_secs(1);
/// Telemetry is sent on in pieces of about this many bytes, so that the threads wake each other rarely.
const PIECE: usize = 4096;
/// Ticks whose times fit without moving: one minute.
const TIMES: usize = 60_000;

/// How fast granted ticks are run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// As fast as they can be computed.
    Free,
    /// One each millisecond.
    Realtime,
}

/// What is known at the end.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ran {
    /// Thread CPU time of each tick, its telemetry included [ns].
    pub tick_ns: Vec<u32>,
    /// Milliseconds that passed without a tick because one took longer; always 0 at [`Pace::Free`].
    pub skipped: u64,
    /// What came in on the line.
    pub received: Received,
}

/// Runs a controller until the other side is gone. It sleeps while no tick is granted.
pub fn run_controller(mut transport: impl Transport, plant: impl Plant, pace: Pace) -> Ran {
    let mut staging = vec![0; STAGING_MAX];
    let mut server = Server::new(plant, &mut staging);
    let mut clock = Clock::default();
    let mut tick_ns = Vec::with_capacity(TIMES);
    let (mut incoming, mut outgoing) = (Vec::new(), Vec::with_capacity(2 * PIECE));
    loop {
        let mut ran = false;
        if server.ready() {
            if pace == Pace::Realtime {
                clock.wait();
            }
            let before = thread_time();
            ran = server.step(&mut |frame| outgoing.extend_from_slice(frame));
            if ran {
                tick_ns.push(u32::try_from((thread_time() - before).as_nanos()).unwrap_or(u32::MAX));
            }
        } else {
            clock.rest();
        }
        let idle = !server.ready();
        let full = outgoing.len() >= PIECE || pace == Pace::Realtime || !ran || idle;
        let sent = !full || outgoing.is_empty() || transport.send(&outgoing).is_ok();
        if full {
            outgoing.clear();
        }
        incoming.clear();
        if !sent
            || transport
                .receive(if idle { IDLE } else { Duration::ZERO }, &mut incoming)
                .is_err()
        {
            break;
        }
        server.receive(&incoming, &mut |frame| outgoing.extend_from_slice(frame));
    }
    Ran {
        tick_ns,
        skipped: clock.skipped,
        received: server.received(),
    }
}

/// CPU time of this thread.
pub(crate) fn thread_time() -> Duration {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(
        now.tv_sec.unsigned_abs(),
        u32::try_from(now.tv_nsec).unwrap_or_default(),
    )
}

/// Gives the moments at which ticks are due.
#[derive(Debug, Default)]
struct Clock {
    /// When the next tick is due; nothing after a rest.
    due: Option<Instant>,
    skipped: u64,
}

impl Clock {
    /// Waits until the next tick is due.
    fn wait(&mut self) {
        let now = Instant::now();
        let due = self.next(now);
        std::thread::sleep(due.saturating_duration_since(now));
    }

    /// Starts over with the next tick.
    const fn rest(&mut self) {
        self.due = None;
    }

    /// When to wake, seen from `now`: missed moments are counted, never made up for by a burst.
    fn next(&mut self, now: Instant) -> Instant {
        let due = self.due.unwrap_or(now);
        let missed =
            u32::try_from(now.saturating_duration_since(due).as_nanos() / PERIOD.as_nanos()).unwrap_or(u32::MAX);
        self.skipped += u64::from(missed);
        let due = due + PERIOD * missed;
        self.due = Some(due + PERIOD);
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_tick_skips_and_does_not_burst() {
        let start = Instant::now();
        let at = |ms: f64| start + Duration::from_secs_f64(ms * 1e-3);
        let mut clock = Clock::default();
        assert_eq!(clock.next(at(0.0)), at(0.0));
        assert_eq!(clock.next(at(0.2)), at(1.0));
        // Half a period late: run at once, the next one on time.
        assert_eq!(clock.next(at(2.5)), at(2.0));
        assert_eq!((clock.next(at(2.6)), clock.skipped), (at(3.0), 0));
        // Due at 4, seen at 7.5: the moments 4, 5 and 6 are lost.
        assert_eq!((clock.next(at(7.5)), clock.skipped), (at(7.0), 3));
        assert_eq!(clock.next(at(7.6)), at(8.0));
        clock.rest();
        assert_eq!((clock.next(at(500.0)), clock.skipped), (at(500.0), 3));
    }
}
