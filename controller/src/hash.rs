//! The state hash: FNV-1a over what the tick produces, the same on every target.

use crate::math::Vec3;
use sutura_shared::hash::Fnv1a;

/// A running hash that takes vectors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hasher(Fnv1a);

impl Hasher {
    /// Adds a word.
    pub const fn word(&mut self, word: u32) {
        self.0 = self.0.u32(word);
    }

    /// Adds a vector.
    pub fn vector(&mut self, v: Vec3) {
        self.0 = self.0.f32s(v.as_slice());
    }

    /// The hash so far.
    #[must_use]
    pub const fn get(self) -> u64 {
        self.0.get()
    }
}
