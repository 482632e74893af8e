//! The frame: `00 | COBS(kind, session, seq, payload, CRC-32C) | 00`, sequence number and CRC little-endian.
//!
//! A zero byte stands only between frames (Cheshire & Baker, "Consistent overhead byte stuffing", 1999), so after any noise the first whole
//! frame is found again. The CRC is looked at before anything it covers is. 32 bits, because stuffing moves the boundaries that the guarantees
//! of a 16-bit CRC rest on.

use crate::limits::{BODY_MAX, CRC, HEADER, STUFFED_MAX, WIRE_MAX};
use crc::{CRC_32_ISCSI, Crc};

static CRC_32C: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);

/// What stands before a payload.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Header {
    /// What the payload is; see [`crate::message`].
    pub kind: u8,
    /// The session the controller gave out, 0 before that.
    pub session: u8,
    /// Counts the sender's frames and wraps.
    pub seq: u16,
}

/// An intact frame, undecoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// What stands before the payload.
    pub header: Header,
    /// The message.
    pub payload: &'a [u8],
}

/// Why bytes are not a frame. The checks come in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameError {
    /// More bytes between two delimiters than a frame has.
    TooLong,
    /// Fewer bytes than a header and a CRC have.
    TooShort,
    /// Not byte stuffing.
    Stuffing,
    /// The CRC is not that of the bytes.
    Crc,
}

/// Writes a frame into `wire`; gives its bytes, delimiters included.
///
/// # Errors
/// [`FrameError::TooLong`] for a payload above `PAYLOAD_MAX`.
pub fn seal<'b>(header: Header, payload: &[u8], wire: &'b mut [u8; WIRE_MAX]) -> Result<&'b [u8], FrameError> {
    let mut body = heapless::Vec::<u8, BODY_MAX>::new();
    let [low, high] = header.seq.to_le_bytes();
    let mut append = |bytes: &[u8]| body.extend_from_slice(bytes).map_err(|_| FrameError::TooLong);
    append(&[header.kind, header.session, low, high])?;
    append(payload)?;
    let crc = CRC_32C.checksum(&body).to_le_bytes();
    body.extend_from_slice(&crc).map_err(|_| FrameError::TooLong)?;
    let [first, stuffed @ ..] = wire;
    *first = 0;
    let length = cobs::try_encode(&body, stuffed).map_err(|_| FrameError::TooLong)?;
    *stuffed.get_mut(length).ok_or(FrameError::TooLong)? = 0;
    wire.get(..length + 2).ok_or(FrameError::TooLong)
}

/// Finds frames in a stream of bytes: no allocation, bounded work a byte and a frame.
#[derive(Clone, Debug)]
pub struct Decoder {
    stuffed: [u8; STUFFED_MAX],
    /// Bytes since the last delimiter; stops counting above `STUFFED_MAX`.
    length: usize,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// A decoder at the start of a stream.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            stuffed: [0; STUFFED_MAX],
            length: 0,
        }
    }

    /// Takes one byte; at the delimiter that ends a frame, gives it or says why it is none.
    pub fn push(&mut self, byte: u8) -> Option<Result<Frame<'_>, FrameError>> {
        if byte != 0 {
            if let Some(slot) = self.stuffed.get_mut(self.length) {
                *slot = byte;
                self.length += 1;
            } else {
                self.length = STUFFED_MAX + 1;
            }
            return None;
        }
        match core::mem::take(&mut self.length) {
            0 => None,
            length => Some(self.stuffed.get_mut(..length).ok_or(FrameError::TooLong).and_then(open)),
        }
    }
}

/// The frame in the bytes between two delimiters.
fn open(stuffed: &mut [u8]) -> Result<Frame<'_>, FrameError> {
    if stuffed.len() < HEADER + CRC + 1 {
        return Err(FrameError::TooShort);
    }
    let length = cobs::decode_in_place(stuffed).map_err(|_| FrameError::Stuffing)?;
    let body = stuffed.get(..length).ok_or(FrameError::Stuffing)?;
    let (covered, crc) = body.split_last_chunk::<CRC>().ok_or(FrameError::TooShort)?;
    let (&[kind, session, low, high], payload) = covered.split_first_chunk::<HEADER>().ok_or(FrameError::TooShort)?;
    if CRC_32C.checksum(covered) != u32::from_le_bytes(*crc) {
        return Err(FrameError::Crc);
    }
    let seq = u16::from_le_bytes([low, high]);
    let header = Header { kind, session, seq };
    Ok(Frame { header, payload })
}
