//! FNV-1a, 64 bits: small enough to run in the tick and the same on every target (Fowler, Noll, Vo).

use crate::math::Vec3;

/// A running hash over little-endian bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hasher(u64);

impl Default for Hasher {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Hasher {
    /// Adds bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    /// Adds a word.
    pub fn word(&mut self, word: u32) {
        self.bytes(&word.to_le_bytes());
    }

    /// Adds a number by its bits; every NaN counts as the same one, for its bits are not the program's.
    pub fn number(&mut self, x: f32) {
        self.word(if x.is_nan() {
            f32::NAN.to_bits() & 0x7fff_ffff
        } else {
            x.to_bits()
        });
    }

    /// Adds a vector.
    pub fn vector(&mut self, v: Vec3) {
        v.iter().for_each(|x| self.number(*x));
    }

    /// The hash so far.
    #[must_use]
    pub const fn get(self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Test vectors of the FNV reference (Noll).
    #[test]
    fn known_strings_hash_as_published() {
        for (text, hash) in [
            ("", 0xcbf2_9ce4_8422_2325_u64),
            ("a", 0xaf63_dc4c_8601_ec8c),
            ("foobar", 0x8594_4171_f739_67e8),
        ] {
            let mut hasher = Hasher::default();
            hasher.bytes(text.as_bytes());
            assert_eq!(hasher.get(), hash);
        }
    }
}
