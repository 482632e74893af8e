//! Exact decoding: every byte is used, no number has a second spelling, every value is in range.
//!
//! `postcard` alone leaves a rest unread and takes `81 00` for 1.

use crate::check::{Invalid, Validate};
use postcard::ser_flavors::Flavor;
use serde::{Deserialize, Serialize};

/// Why bytes are not a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DecodeError {
    /// The bytes end too early or hold a tag, a length or text that cannot be.
    Malformed,
    /// Bytes are left over.
    Trailing,
    /// A number is spelt longer than it must be.
    NotCanonical,
    /// Well encoded, but out of range.
    Invalid(Invalid),
}

/// Decodes all of `bytes`.
///
/// # Errors
/// See [`DecodeError`]; the checks come in its order.
pub fn decode<'a, T: Deserialize<'a> + Serialize + Validate>(bytes: &'a [u8]) -> Result<T, DecodeError> {
    let (value, rest) = postcard::take_from_bytes::<T>(bytes).map_err(|_| DecodeError::Malformed)?;
    if !rest.is_empty() {
        return Err(DecodeError::Trailing);
    }
    postcard::serialize_with_flavor(&value, Expect(bytes)).map_err(|_| DecodeError::NotCanonical)?;
    value.validate().map_err(DecodeError::Invalid)?;
    Ok(value)
}

/// Encodes into the front of `buffer`; gives the bytes used, or nothing if they do not fit.
pub fn encode<'b>(value: &impl Serialize, buffer: &'b mut [u8]) -> Option<&'b [u8]> {
    postcard::to_slice(value, buffer).ok().map(|used| &*used)
}

/// An output that takes only these bytes.
struct Expect<'a>(&'a [u8]);

impl Flavor for Expect<'_> {
    type Output = ();

    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        match self.0 {
            [first, rest @ ..] if *first == byte => {
                self.0 = rest;
                Ok(())
            }
            _ => Err(postcard::Error::SerializeBufferFull),
        }
    }

    fn finalize(self) -> postcard::Result<()> {
        if self.0.is_empty() {
            Ok(())
        } else {
            Err(postcard::Error::SerializeBufferFull)
        }
    }
}
