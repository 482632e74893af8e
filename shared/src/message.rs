//! What the two sides say to each other.
//!
//! The kind stands in the frame's header, outside the encoding, so a side that is older skips what it does not know. Kinds are never used
//! again for something else. [`Hello`] and [`Reject`] never change their encoding: two sides that understand nothing else of each other
//! can still say so. Ticks are counted from the last upload that was taken: tick 0 is the state it describes.

use crate::check::{Invalid, Validate, finite, require};
use crate::hash::Fnv1a;
use crate::limits::{CELLS_MAX, CHUNK_MAX, DETAIL_MAX, SCENE_MAX};
use crate::scene::{STITCHES_MAX, Site, Stage};
use heapless::String;
use serde::{Deserialize, Serialize};

mod kind;

pub use kind::MessageError;

/// First word of a [`Hello`].
pub const MAGIC: u32 = u32::from_le_bytes(*b"SUTU");

/// What this build speaks. The schema hash is that of `golden.txt`: a sample of every message and of every variant in a scene, its field names
/// and its bytes. A test holds the file to the types, so a type cannot change and keep its hash.
pub const VERSION: Version = Version {
    major: 1,
    minor: 0,
    schema_hash: Fnv1a::new().bytes(include_bytes!("golden.txt")).get(),
};

/// A version of the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Version {
    /// Differs where the two sides cannot work together.
    pub major: u16,
    /// Differs where one side knows more.
    pub minor: u16,
    /// Differs where any type does.
    pub schema_hash: u64,
}

impl Version {
    /// Whether two sides understand each other.
    #[must_use]
    pub const fn speaks(self, other: Self) -> bool {
        self.major == other.major && self.schema_hash == other.schema_hash
    }
}

/// From host to controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToController<'a> {
    /// Opens a session, and ends the one before.
    Hello(Hello),
    /// Announces an upload and drops any other.
    SceneBegin(SceneBegin),
    /// A part of it.
    SceneChunk(SceneChunk<'a>),
    /// Its end.
    SceneCommit(SceneCommit),
    /// Leave to run.
    Grant(Grant),
    /// Zero force and no more ticks until another upload.
    Stop,
}

/// From controller to host.
#[derive(Clone, Debug, PartialEq)]
pub enum ToHost {
    /// The session is open; the header carries its number.
    Hello(Hello),
    /// The two sides do not understand each other.
    Reject(Reject),
    /// The upload is the scene now, at tick 0.
    Accepted(Accepted),
    /// The upload is dropped; the scene before stays, except after [`UploadError::Build`].
    UploadRejected(UploadRejected),
    /// What happened in a tick.
    Telemetry(Telemetry),
    /// A puncture.
    Puncture(PunctureEvent),
    /// A grant is used up.
    Granted(Granted),
    /// No more ticks.
    Ended(Ended),
}

/// The first message of either side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// [`MAGIC`].
    pub magic: u32,
    /// What the sender speaks.
    pub version: Version,
    /// Chosen by the host, repeated by the controller: tells this answer from an old one.
    pub nonce: u32,
}

/// A refused [`Hello`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reject {
    /// What the sender of this speaks.
    pub mine: Version,
    /// What the other side said.
    pub yours: Version,
}

/// Announces `postcard(Scene)` followed by one byte a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneBegin {
    /// Number of the upload.
    pub transfer: u8,
    /// Bytes of the scene, [1, `SCENE_MAX`].
    pub scene_len: u32,
    /// Bytes of the cells, [1, `CELLS_MAX`].
    pub cells_len: u32,
    /// [`Fnv1a`] of all bytes.
    pub hash: u64,
}

/// Part of an upload. Parts come in order and without gaps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneChunk<'a> {
    /// Number of the upload.
    pub transfer: u8,
    /// Where the part begins.
    pub offset: u32,
    /// [1, `CHUNK_MAX`] bytes.
    #[serde(borrow)]
    pub data: &'a [u8],
}

/// Ends an upload.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneCommit {
    /// Number of the upload.
    pub transfer: u8,
    /// [`Fnv1a`] of all bytes.
    pub hash: u64,
    /// The scene is taken between this tick and the next; not in the past.
    pub apply_at_tick: u32,
}

/// Leave to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Grant {
    /// Last tick that may be run.
    pub until_tick: u32,
}

/// An upload that is the scene now.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Accepted {
    /// Number of the upload.
    pub transfer: u8,
    /// [`Fnv1a`] of all bytes.
    pub hash: u64,
    /// Voxels of the patch.
    pub voxels: u32,
    /// Nodes of the patch.
    pub nodes: u32,
}

/// A refused upload.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct UploadRejected {
    /// Number of the upload.
    pub transfer: u8,
    /// Why.
    pub reason: UploadError,
    /// How many bytes had come in order.
    pub offset: u32,
    /// Name of the value that is wrong, or what would be right.
    pub detail: String<DETAIL_MAX>,
}

/// Why an upload is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum UploadError {
    /// Longer than this controller can hold.
    TooLong,
    /// No such upload was announced.
    Transfer,
    /// A part is missing, doubled or beyond the end.
    Order,
    /// Not the bytes that were announced.
    Hash,
    /// The tick at which to take it is in the past.
    Late,
    /// The bytes are not a scene.
    Encoding,
    /// A value of the scene is out of range.
    Value,
    /// The controller cannot build this scene; it has none now.
    Build,
}

/// What happened in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Telemetry {
    /// Number of the tick, from 1.
    pub tick: u32,
    /// Where the stitch is.
    pub stage: Stage,
    /// Number of the stitch, from 1.
    pub stitch: u8,
    /// What went wrong, as bits.
    pub faults: u32,
    /// Grasp point of the tool, patch frame [m].
    pub position_m: [f32; 3],
    /// Force on the hand as the scene says, patch frame [N].
    pub simulated_n: [f32; 3],
    /// Force on the hand as the device is told, device frame [N].
    pub rendered_n: [f32; 3],
    /// Constraint torque on the hand about the grasp point, patch frame [N·m]; a three-axis device does not render it.
    pub torque_n_m: [f32; 3],
    /// Tension of the thread [N].
    pub thread_n: f32,
    /// Width of the wound at each stitch [m]; negative where the rims overlap, zero where there is no stitch.
    pub gap_m: [f32; STITCHES_MAX],
    /// Mean width of the wound: between the end stitches, or over its length for one stitch [m].
    pub gap_mean_m: f32,
    /// Whether the device's limit shortened the force.
    pub saturated: bool,
}

/// A puncture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PunctureEvent {
    /// Where.
    pub site: Site,
    /// Number of the stitch, from 1.
    pub stitch: u8,
    /// When.
    pub tick: u32,
    /// Force along the needle at which the skin gave way [N].
    pub force_n: f32,
    /// The scene's F0 [N].
    pub f0_n: f32,
    /// How far the skin had been pushed [m].
    pub depth_m: f32,
}

/// A used grant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Granted {
    /// The last tick that was run.
    pub tick: u32,
    /// Hash of everything up to it.
    pub state_hash: u64,
}

/// The end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ended {
    /// The last tick that was run.
    pub tick: u32,
    /// Why.
    pub reason: EndReason,
}

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum EndReason {
    /// The host said so.
    Stopped,
    /// The host opened another session.
    Replaced,
}

impl Validate for Hello {
    fn validate(&self) -> Result<(), Invalid> {
        require(self.magic == MAGIC, "hello.magic", "SUTU")
    }
}

impl Validate for SceneBegin {
    fn validate(&self) -> Result<(), Invalid> {
        require(
            (1..=SCENE_MAX as u32).contains(&self.scene_len),
            "scene_begin.scene_len",
            "1 to 4096",
        )?;
        require(
            (1..=CELLS_MAX as u32).contains(&self.cells_len),
            "scene_begin.cells_len",
            "1 to 8192",
        )
    }
}

impl Validate for SceneChunk<'_> {
    fn validate(&self) -> Result<(), Invalid> {
        require(
            (1..=CHUNK_MAX).contains(&self.data.len()),
            "scene_chunk.data",
            "1 to 224 bytes",
        )
    }
}

impl Validate for Telemetry {
    fn validate(&self) -> Result<(), Invalid> {
        finite(&self.position_m, "telemetry.position_m")?;
        finite(&self.simulated_n, "telemetry.simulated_n")?;
        finite(&self.rendered_n, "telemetry.rendered_n")?;
        finite(&self.torque_n_m, "telemetry.torque_n_m")?;
        finite(&[self.thread_n], "telemetry.thread_n")?;
        finite(&self.gap_m, "telemetry.gap_m")?;
        finite(&[self.gap_mean_m], "telemetry.gap_mean_m")
    }
}

impl Validate for PunctureEvent {
    fn validate(&self) -> Result<(), Invalid> {
        finite(&[self.force_n, self.f0_n, self.depth_m], "puncture.force_n")
    }
}

/// Types of which every value makes sense.
macro_rules! always_valid {
    ($($type:ty),*) => {
        $(impl Validate for $type {
            fn validate(&self) -> Result<(), Invalid> {
                Ok(())
            }
        })*
    };
}

always_valid!(SceneCommit, Grant, Reject, Accepted, UploadRejected, Granted, Ended);
