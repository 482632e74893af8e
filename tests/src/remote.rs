//! A scenario against a controller behind any stream: a serial port, or a stand-in for one.
//!
//! The touch scene on a patch that the smallest controller holds. The controller's device must be the simulated one, since the bits of the
//! run are compared with those of the same run in this process.

use std::fmt::{self, Display, Formatter};
use std::io::{Read, Write};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use sutura::link::{Link, StreamTransport};
use sutura::scene::build::Built;
use sutura_controller::lanes::Level;
use sutura_controller::link::Plant as _;
use sutura_shared::message::ToHost;

use crate::scenario;
use sutura::run::embedded::PcRig;

/// Ticks of the scenario: the ball comes down and presses.
pub const TICKS: u32 = 2_000;
/// The scene's patch, and one of 10 × 8 × 7 nodes.
const PATCH: [&str; 2] = ["size_mm = [40, 30, 12]", "size_mm = [18, 14, 12]"];
/// Messages there and back.
const ROUND_TRIPS: u32 = 20;
/// Longest wait for one of them.
const PATIENCE: Duration = Duration::from_secs(2);

/// What a run took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Ticks that were run.
    pub ticks: u32,
    /// From the first grant to the last telemetry.
    pub run: Duration,
    /// Mean time from a grant that grants nothing to its answer.
    pub round_trip: Duration,
    /// Intact frames from the controller.
    pub frames: u64,
}

impl Display for Timing {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let rate = f64::from(self.ticks) / self.run.as_secs_f64();
        let round_trip_ms = self.round_trip.as_secs_f64() * 1e3;
        write!(
            f,
            "{} ticks in {:.2} s: {rate:.0} ticks/s; round trip {round_trip_ms:.2} ms; {} frames",
            self.ticks,
            self.run.as_secs_f64(),
            self.frames
        )
    }
}

/// Uploads the scene, runs it and holds every tick to the run's rules.
///
/// # Errors
/// One line: the link's own words, a refusal's among them, or what was wrong with the run.
pub fn touch<S: Read + Write>(stream: S) -> Result<Timing, String> {
    let built = small_touch()?;
    let said = |error: sutura::link::LinkError| error.to_string();
    let mut link = Link::connect(StreamTransport(stream)).map_err(said)?;
    link.upload(&built.scene, &built.cells).map_err(said)?;
    let round_trip = round_trip(&mut link)?;
    let (mut last, mut wrong) = (0, None);
    let begun = Instant::now();
    let (ticks, hash) = link
        .run(TICKS, |message| {
            if let ToHost::Telemetry(tick) = message {
                if tick.tick != last + 1 {
                    wrong.get_or_insert(format!("tick {} came after tick {last}", tick.tick));
                }
                if tick.faults != 0 {
                    wrong.get_or_insert(format!("faults {:#x} at tick {}", tick.faults, tick.tick));
                }
                last = tick.tick;
            }
            ControlFlow::Continue(())
        })
        .map_err(said)?;
    let run = begun.elapsed();
    let counts = link.counts();
    link.stop().map_err(said)?;
    let expected = hash_here(&built)?;
    match wrong {
        Some(what) => Err(what),
        None if counts.errors > 0 => Err(format!("{} broken or missing frames", counts.errors)),
        None if hash != expected => Err(format!("state hash {hash:016x} there, {expected:016x} here")),
        None => Ok(Timing {
            ticks,
            run,
            round_trip,
            frames: counts.frames,
        }),
    }
}

/// The touch scene on the small patch.
fn small_touch() -> Result<Built, String> {
    let text = std::fs::read_to_string(scenario::scene_file("touch")).map_err(|error| error.to_string())?;
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let path = folder.path().join("touch.toml");
    std::fs::write(&path, text.replace(PATCH[0], PATCH[1])).map_err(|error| error.to_string())?;
    scenario::built(Some(&path)).map_err(|error| error.to_string())
}

/// Mean time of a message there and back.
fn round_trip<S: Read + Write>(link: &mut Link<StreamTransport<S>>) -> Result<Duration, String> {
    let begun = Instant::now();
    for _ in 0..ROUND_TRIPS {
        link.grant(0).map_err(|error| error.to_string())?;
        match link.receive(PATIENCE).map_err(|error| error.to_string())? {
            Some(ToHost::Granted(_)) => {}
            other => return Err(format!("a grant of nothing was answered by {other:?}")),
        }
    }
    Ok(begun.elapsed() / ROUND_TRIPS)
}

/// The state hash of the same run in this process.
fn hash_here(built: &Built) -> Result<u64, String> {
    let mut memory = scenario::memory();
    let mut rig = PcRig::new(&mut memory, Level::best());
    rig.load(&built.scene, &built.cells)
        .map_err(|error| error.0.to_owned())?;
    (0..TICKS).for_each(|_| {
        rig.tick();
    });
    Ok(rig.state_hash())
}
