//! The host's side of the wire: handshake, upload, grants, what comes back.
//!
//! [`Link`] speaks to a controller behind any [`Transport`]; [`run_controller`] is the loop of one that lives in a thread of this process,
//! behind the same frames. Grants are given at ticks that depend on ticks alone, so a run is the same at any speed.

mod controller;
mod transport;

pub(crate) use controller::thread_time;
pub use controller::{Pace, Ran, run_controller};
pub use transport::{ChannelTransport, StreamTransport, Transport, channel};

use std::collections::VecDeque;
use std::io;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};
use sutura_shared::codec;
use sutura_shared::frame::Decoder;
use sutura_shared::hash::Fnv1a;
use sutura_shared::limits::{CELLS_MAX, CHUNK_MAX, SCENE_MAX, WIRE_MAX};
use sutura_shared::message::{
    Accepted, Grant, Hello, MAGIC, MessageError, SceneBegin, SceneChunk, SceneCommit, ToController, ToHost,
    UploadError, VERSION, Version,
};
use sutura_shared::scene::Scene;

/// How far ahead of the last seen tick is granted, and after how many ticks more [ticks].
const AHEAD: u32 = 200;
const BATCH: u32 = 100;
/// How long the controller may be silent when it owes an answer.
const PATIENCE: Duration = Duration::from_secs(10);

/// What can go wrong between host and controller.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The transport is closed or broken.
    #[error("the link to the controller broke: {0}")]
    Io(#[from] io::Error),
    /// No answer in time.
    #[error("the controller has not answered {0} for {1} s: is it running, and is this its port?")]
    Silent(&'static str, u64),
    /// The two sides were built from different sources.
    #[error(
        "the controller speaks version {}, this program {}: build both from the same source", version(.theirs), version(.ours)
    )]
    Version {
        /// What this program speaks.
        ours: Version,
        /// What the controller speaks.
        theirs: Version,
    },
    /// The scene does not fit the wire.
    #[error("the {what} takes {bytes} bytes, at most {most} can be sent: make it smaller or coarser")]
    TooLong {
        /// Scene or cells.
        what: &'static str,
        /// Its length.
        bytes: usize,
        /// The limit.
        most: usize,
    },
    /// The controller refused the scene.
    #[error("the controller refused the scene ({reason:?} after {offset} bytes): {detail}")]
    Refused {
        /// Why.
        reason: UploadError,
        /// How much had come.
        offset: u32,
        /// The value that is wrong, or what would be right.
        detail: String,
    },
    /// The controller ended a run that nobody stopped.
    #[error("the controller ended the run at tick {0}: has another host taken it?")]
    Ended(u32),
}

fn version(version: &Version) -> String {
    format!(
        "{}.{} (schema {:016x})",
        version.major, version.minor, version.schema_hash
    )
}

/// What came in on the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Intact frames.
    pub frames: u64,
    /// Broken frames, intact ones that are no valid message, and frames missing in the sequence.
    pub errors: u64,
}

/// An open session with a controller.
#[derive(Debug)]
pub struct Link<T> {
    transport: T,
    decoder: Decoder,
    session: u8,
    /// Sequence number of the next frame to the controller.
    next: u16,
    /// Sequence number of the last frame from it.
    last: u16,
    transfer: u8,
    counts: Counts,
    /// Bytes just read, and the messages in them that nobody has asked for yet.
    read: Vec<u8>,
    arrived: VecDeque<(u8, ToHost)>,
}

impl<T: Transport> Link<T> {
    /// Opens a session.
    ///
    /// # Errors
    /// [`LinkError::Version`], [`LinkError::Silent`] or a broken transport.
    pub fn connect(transport: T) -> Result<Self, LinkError> {
        let mut link = Self {
            transport,
            decoder: Decoder::new(),
            session: 0,
            next: 0,
            last: u16::MAX,
            transfer: 0,
            counts: Counts::default(),
            read: Vec::new(),
            arrived: VecDeque::new(),
        };
        // Any number that the answer to an older hello is unlikely to carry; no result depends on it.
        let nonce = std::process::id();
        let hello = Hello {
            magic: MAGIC,
            version: VERSION,
            nonce,
        };
        link.send(&ToController::Hello(hello))?;
        link.answer("hello", |link, session, message| match message {
            ToHost::Hello(theirs) if theirs.nonce == nonce && !VERSION.speaks(theirs.version) => {
                Some(Err(different(theirs.version)))
            }
            ToHost::Hello(theirs) if theirs.nonce == nonce => {
                link.session = session;
                Some(Ok(()))
            }
            ToHost::Reject(reject) => Some(Err(different(reject.mine))),
            _ => None,
        })?;
        Ok(link)
    }

    /// Uploads a scene, which becomes tick 0 at once.
    ///
    /// # Errors
    /// [`LinkError::TooLong`], [`LinkError::Refused`], or the link's own.
    pub fn upload(&mut self, scene: &Scene, cells: &[u8]) -> Result<Accepted, LinkError> {
        let too_long = |what, bytes, most| LinkError::TooLong { what, bytes, most };
        let mut bytes = vec![0; SCENE_MAX];
        let scene_len = codec::encode(scene, &mut bytes)
            .ok_or(too_long("scene", SCENE_MAX + 1, SCENE_MAX))?
            .len();
        if cells.len() > CELLS_MAX {
            return Err(too_long("lattice", cells.len(), CELLS_MAX));
        }
        bytes.truncate(scene_len);
        bytes.extend_from_slice(cells);
        let hash = Fnv1a::new().bytes(&bytes).get();
        self.transfer = self.transfer.wrapping_add(1);
        let transfer = self.transfer;
        self.send(&ToController::SceneBegin(SceneBegin {
            transfer,
            scene_len: scene_len as u32,
            cells_len: cells.len() as u32,
            hash,
        }))?;
        for (index, data) in bytes.chunks(CHUNK_MAX).enumerate() {
            let offset = (index * CHUNK_MAX) as u32;
            self.send(&ToController::SceneChunk(SceneChunk { transfer, offset, data }))?;
        }
        let apply_at_tick = 0;
        self.send(&ToController::SceneCommit(SceneCommit {
            transfer,
            hash,
            apply_at_tick,
        }))?;
        self.answer("an upload", |_, _, message| match message {
            ToHost::Accepted(accepted) if accepted.transfer == transfer => Some(Ok(accepted)),
            ToHost::UploadRejected(rejected) if rejected.transfer == transfer => Some(Err(LinkError::Refused {
                reason: rejected.reason,
                offset: rejected.offset,
                detail: rejected.detail.as_str().to_owned(),
            })),
            _ => None,
        })
    }

    /// Runs until `last_tick`, or for as long as `each` says so of the messages on the way, in their order. After a break the ticks that were
    /// granted already still come, and `each` still sees them. Gives the last tick and the state hash there.
    ///
    /// # Errors
    /// [`LinkError::Ended`] if the controller ends the run, or the link's own.
    pub fn run(
        &mut self,
        last_tick: u32,
        mut each: impl FnMut(&ToHost) -> ControlFlow<()>,
    ) -> Result<(u32, u64), LinkError> {
        let mut granted = AHEAD.min(last_tick);
        let mut goes_on = true;
        self.grant(granted)?;
        loop {
            let message = self.expect("a grant")?;
            goes_on &= each(&message).is_continue();
            match message {
                ToHost::Granted(at) if at.tick == granted && (!goes_on || granted == last_tick) => {
                    return Ok((at.tick, at.state_hash));
                }
                ToHost::Telemetry(telemetry) if goes_on && telemetry.tick % BATCH == 0 => {
                    granted = telemetry.tick.saturating_add(AHEAD).min(last_tick);
                    self.grant(granted)?;
                }
                ToHost::Ended(ended) => return Err(LinkError::Ended(ended.tick)),
                _ => {}
            }
        }
    }

    /// Leave to run until a tick; smaller than before changes nothing and is answered again.
    ///
    /// # Errors
    /// A broken transport.
    pub fn grant(&mut self, until_tick: u32) -> Result<(), LinkError> {
        self.send(&ToController::Grant(Grant { until_tick }))
    }

    /// Zero force and no more ticks. Gives the last tick.
    ///
    /// # Errors
    /// A silent controller or a broken transport.
    pub fn stop(&mut self) -> Result<u32, LinkError> {
        self.send(&ToController::Stop)?;
        self.answer("a stop", |_, _, message| match message {
            ToHost::Ended(ended) => Some(Ok(ended.tick)),
            _ => None,
        })
    }

    /// The next message, if one comes within `wait`.
    ///
    /// # Errors
    /// A broken transport.
    pub fn receive(&mut self, wait: Duration) -> Result<Option<ToHost>, LinkError> {
        let until = Instant::now() + wait;
        loop {
            while let Some((session, message)) = self.arrived.pop_front() {
                if session == self.session {
                    return Ok(Some(message));
                }
            }
            let left = until.saturating_duration_since(Instant::now());
            if !self.read(left)? && left.is_zero() {
                return Ok(None);
            }
        }
    }

    /// What came in on the line.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    fn expect(&mut self, what: &'static str) -> Result<ToHost, LinkError> {
        self.receive(PATIENCE)?
            .ok_or(LinkError::Silent(what, PATIENCE.as_secs()))
    }

    /// Waits for the message that `take` takes; others before it are dropped.
    fn answer<A>(
        &mut self,
        what: &'static str,
        mut take: impl FnMut(&mut Self, u8, ToHost) -> Option<Result<A, LinkError>>,
    ) -> Result<A, LinkError> {
        let until = Instant::now() + PATIENCE;
        loop {
            while let Some((session, message)) = self.arrived.pop_front() {
                // Before the session has a number, the message itself says whether it is the answer.
                if (self.session == 0 || session == self.session)
                    && let Some(answer) = take(self, session, message)
                {
                    return answer;
                }
            }
            let left = until.saturating_duration_since(Instant::now());
            if !self.read(left)? && left.is_zero() {
                return Err(LinkError::Silent(what, PATIENCE.as_secs()));
            }
        }
    }

    fn send(&mut self, message: &ToController<'_>) -> Result<(), LinkError> {
        let wire = &mut [0; WIRE_MAX];
        let frame = message
            .encode(self.session, self.next, wire)
            .map_err(|error| io::Error::other(format!("a message does not fit a frame: {error:?}")))?;
        self.next = self.next.wrapping_add(1);
        Ok(self.transport.send(frame)?)
    }

    /// Takes what the transport has; gives whether it had anything.
    fn read(&mut self, wait: Duration) -> Result<bool, LinkError> {
        self.read.clear();
        self.transport.receive(wait, &mut self.read)?;
        for byte in &self.read {
            match self.decoder.push(*byte) {
                None => {}
                Some(Err(_)) => self.counts.errors += 1,
                Some(Ok(frame)) => {
                    self.counts.frames += 1;
                    let session = frame.header.session;
                    let missing = frame.header.seq.wrapping_sub(self.last).wrapping_sub(1);
                    if self.session != 0 && session == self.session {
                        self.counts.errors += u64::from(missing);
                    }
                    self.last = frame.header.seq;
                    match ToHost::decode(&frame) {
                        Ok(message) => self.arrived.push_back((session, message)),
                        // A younger controller may say more.
                        Err(MessageError::Kind(_)) => {}
                        Err(MessageError::Payload(_)) => self.counts.errors += 1,
                    }
                }
            }
        }
        Ok(!self.read.is_empty())
    }
}

const fn different(theirs: Version) -> LinkError {
    LinkError::Version { ours: VERSION, theirs }
}

#[cfg(test)]
mod tests;
