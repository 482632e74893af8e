//! FNV-1a, 64 bits (Fowler, Noll & Vo): fast enough for every tick, the same on every target, no table.
//!
//! It tells equal from different, and does not withstand a forger; frames carry a CRC against a bad line.

/// A hash in the making.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fnv1a(u64);

impl Default for Fnv1a {
    fn default() -> Self {
        Self::new()
    }
}

impl Fnv1a {
    /// The hash of nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// With `bytes` appended.
    #[must_use]
    pub const fn bytes(self, mut bytes: &[u8]) -> Self {
        let mut hash = self.0;
        while let [first, rest @ ..] = bytes {
            hash = (hash ^ *first as u64).wrapping_mul(0x0000_0100_0000_01b3);
            bytes = rest;
        }
        Self(hash)
    }

    /// With the little-endian bytes of `value` appended.
    #[must_use]
    pub const fn u32(self, value: u32) -> Self {
        self.bytes(&value.to_le_bytes())
    }

    /// With the bits of every value appended; every NaN counts as the same one, for its bits are not defined.
    #[must_use]
    pub fn f32s(self, values: &[f32]) -> Self {
        values.iter().fold(self, |hash, value| {
            hash.u32(if value.is_nan() { 0x7fc0_0000 } else { value.to_bits() })
        })
    }

    /// The hash.
    #[must_use]
    pub const fn get(self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vectors of the FNV reference distribution (test_fnv.c: "", "a", "foobar").
    #[test]
    fn reference_vectors() {
        assert_eq!(Fnv1a::new().get(), 0xcbf2_9ce4_8422_2325);
        assert_eq!(Fnv1a::new().bytes(b"a").get(), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(Fnv1a::new().bytes(b"foobar").get(), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn words_are_their_little_endian_bytes() {
        assert_eq!(Fnv1a::new().u32(0x0403_0201), Fnv1a::new().bytes(&[1, 2, 3, 4]));
        assert_eq!(Fnv1a::new().f32s(&[1.0]), Fnv1a::new().u32(0x3f80_0000));
        assert_eq!(Fnv1a::new().f32s(&[f32::NAN]), Fnv1a::new().f32s(&[-f32::NAN]));
    }
}
