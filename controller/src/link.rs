//! The controller behind frames: handshake, scene upload, granted ticks, telemetry. No I/O: bytes go in, frames come out.
//!
//! A tick runs only when the host has granted it, so the moment at which bytes arrive cannot change a result. Whoever owns the loop calls
//! [`Server::step`], which runs one tick at most: pacing and time measurement stay outside.

mod session;
mod staging;

use crate::record::Output;
use session::Session;
use sutura_shared::frame::Decoder;
use sutura_shared::scene::Scene;

/// What is behind the frames.
pub trait Plant {
    /// Becomes the scene at tick 0. Both are valid: every float, every index, every cell.
    ///
    /// # Errors
    /// What this plant cannot build; it is at rest then, without a scene.
    fn load(&mut self, scene: &Scene, cells: &[u8]) -> Result<Loaded, LoadError>;

    /// Advances by one tick. Only between a [`Self::load`] and a [`Self::stop`].
    fn tick(&mut self) -> Output;

    /// Hash of all that happened since [`Self::load`] and of all that is; asking changes nothing.
    fn state_hash(&self) -> u64;

    /// The device gets zero force until the next [`Self::tick`]: no tick is granted, and the host may be gone. Results do not change.
    fn release(&mut self);

    /// The device gets zero force until the next [`Self::load`].
    fn stop(&mut self);
}

/// What a scene has become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Loaded {
    /// Voxels of the patch.
    pub voxels: u32,
    /// Nodes of the patch.
    pub nodes: u32,
}

/// Why a valid scene cannot be built, in at most 64 bytes: `what: what would be right`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoadError(pub &'static str);

/// What came in on the line. All counts wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Received {
    /// Intact frames.
    pub frames: u32,
    /// Broken frames, and intact ones that are no valid message or come out of turn.
    pub errors: u32,
    /// Intact frames of another session, or doubled: dropped.
    pub stale: u32,
    /// Frames missing in the sequence.
    pub missing: u32,
}

/// The controller's side of the wire.
pub struct Server<'m, P> {
    decoder: Decoder,
    session: Session<'m, P>,
}

impl<'m, P: Plant> Server<'m, P> {
    /// A server that waits for a hello. Uploads longer than `staging` are refused;
    /// [`STAGING_MAX`](sutura_shared::limits::STAGING_MAX) bytes hold any.
    pub const fn new(plant: P, staging: &'m mut [u8]) -> Self {
        Self {
            decoder: Decoder::new(),
            session: Session::new(plant, staging),
        }
    }

    /// Takes bytes from the line; answers, frame by frame, go to `sink`.
    pub fn receive(&mut self, bytes: &[u8], sink: &mut dyn FnMut(&[u8])) {
        for byte in bytes {
            match self.decoder.push(*byte) {
                None => {}
                Some(Ok(frame)) => self.session.take(&frame, sink),
                Some(Err(_)) => self.session.broken_frame(),
            }
        }
    }

    /// Whether [`Self::step`] has something to do.
    #[must_use]
    pub const fn ready(&self) -> bool {
        self.session.ready()
    }

    /// Runs one tick if one is granted, and sends its telemetry; or, with the grant used up, releases the device and says so, once.
    /// Gives whether a tick was run.
    pub fn step(&mut self, sink: &mut dyn FnMut(&[u8])) -> bool {
        self.session.step(sink)
    }

    /// What came in on the line.
    #[must_use]
    pub const fn received(&self) -> Received {
        self.session.received()
    }

    /// What is behind the frames.
    pub const fn plant(&self) -> &P {
        self.session.plant()
    }
}

#[cfg(test)]
mod tests;
