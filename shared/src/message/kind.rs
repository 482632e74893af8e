//! Which number stands for which message.

use super::{ToController, ToHost};
use crate::codec::{self, DecodeError};
use crate::frame::{self, Frame, FrameError, Header};
use crate::limits::{PAYLOAD_MAX, WIRE_MAX};

/// Why a frame is not a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageError {
    /// Nothing this build knows: to be skipped.
    Kind(u8),
    /// The payload is not what the kind says.
    Payload(DecodeError),
}

impl From<DecodeError> for MessageError {
    fn from(error: DecodeError) -> Self {
        Self::Payload(error)
    }
}

impl<'a> ToController<'a> {
    /// The frame's bytes, delimiters included.
    ///
    /// # Errors
    /// [`FrameError::TooLong`] for a chunk above `CHUNK_MAX`.
    pub fn encode<'b>(&self, session: u8, seq: u16, wire: &'b mut [u8; WIRE_MAX]) -> Result<&'b [u8], FrameError> {
        let buffer = &mut [0; PAYLOAD_MAX];
        let (kind, payload) = match self {
            Self::Hello(it) => (0x01, codec::encode(it, buffer)),
            Self::SceneBegin(it) => (0x02, codec::encode(it, buffer)),
            Self::SceneChunk(it) => (0x03, codec::encode(it, buffer)),
            Self::SceneCommit(it) => (0x04, codec::encode(it, buffer)),
            Self::Grant(it) => (0x05, codec::encode(it, buffer)),
            Self::Stop => (0x06, codec::encode(&(), buffer)),
        };
        frame::seal(Header { kind, session, seq }, payload.ok_or(FrameError::TooLong)?, wire)
    }

    /// The message in an intact frame.
    ///
    /// # Errors
    /// See [`MessageError`].
    pub fn decode(frame: &Frame<'a>) -> Result<Self, MessageError> {
        let bytes = frame.payload;
        Ok(match frame.header.kind {
            0x01 => Self::Hello(codec::decode(bytes)?),
            0x02 => Self::SceneBegin(codec::decode(bytes)?),
            0x03 => Self::SceneChunk(codec::decode(bytes)?),
            0x04 => Self::SceneCommit(codec::decode(bytes)?),
            0x05 => Self::Grant(codec::decode(bytes)?),
            0x06 => codec::decode::<()>(bytes).map(|()| Self::Stop)?,
            kind => return Err(MessageError::Kind(kind)),
        })
    }
}

impl ToHost {
    /// The frame's bytes, delimiters included.
    ///
    /// # Errors
    /// None for a message that this type can hold; the limits see to it.
    pub fn encode<'b>(&self, session: u8, seq: u16, wire: &'b mut [u8; WIRE_MAX]) -> Result<&'b [u8], FrameError> {
        let buffer = &mut [0; PAYLOAD_MAX];
        let (kind, payload) = match self {
            Self::Hello(it) => (0x81, codec::encode(it, buffer)),
            Self::Reject(it) => (0x82, codec::encode(it, buffer)),
            Self::Accepted(it) => (0x83, codec::encode(it, buffer)),
            Self::UploadRejected(it) => (0x84, codec::encode(it, buffer)),
            Self::Telemetry(it) => (0x85, codec::encode(it, buffer)),
            Self::Puncture(it) => (0x86, codec::encode(it, buffer)),
            Self::Granted(it) => (0x87, codec::encode(it, buffer)),
            Self::Ended(it) => (0x88, codec::encode(it, buffer)),
        };
        frame::seal(Header { kind, session, seq }, payload.ok_or(FrameError::TooLong)?, wire)
    }

    /// The message in an intact frame.
    ///
    /// # Errors
    /// See [`MessageError`].
    pub fn decode(frame: &Frame<'_>) -> Result<Self, MessageError> {
        let bytes = frame.payload;
        Ok(match frame.header.kind {
            0x81 => Self::Hello(codec::decode(bytes)?),
            0x82 => Self::Reject(codec::decode(bytes)?),
            0x83 => Self::Accepted(codec::decode(bytes)?),
            0x84 => Self::UploadRejected(codec::decode(bytes)?),
            0x85 => Self::Telemetry(codec::decode(bytes)?),
            0x86 => Self::Puncture(codec::decode(bytes)?),
            0x87 => Self::Granted(codec::decode(bytes)?),
            0x88 => Self::Ended(codec::decode(bytes)?),
            kind => return Err(MessageError::Kind(kind)),
        })
    }
}
