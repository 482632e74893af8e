//! Sixteen lanes on vector instructions, by a crate that makes them safe.

use super::{Lanes, Level, SUM_LANES};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};

#[cfg(target_arch = "x86_64")]
impl Level {
    /// Every level this processor has, the plainest first.
    pub fn all() -> impl Iterator<Item = Self> {
        let best = fearless_simd::Level::new();
        let vectors = [
            best.as_sse2().map(Self::Sse2),
            best.as_avx2().map(Self::Avx2),
            best.as_avx512().map(Self::Avx512),
        ];
        core::iter::once(Self::Single).chain(vectors.into_iter().flatten())
    }

    /// What its instructions are called; `off` for none.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Single => "off",
            Self::Sse2(_) => "sse2",
            Self::Avx2(_) => "avx2",
            Self::Avx512(_) => "avx512",
        }
    }
}

#[cfg(not(target_arch = "x86_64"))]
impl Level {
    /// Every level this processor has, the plainest first.
    pub fn all() -> impl Iterator<Item = Self> {
        [Self::Single, Self::Other(fearless_simd::Level::new())].into_iter()
    }

    /// What its instructions are called; `off` for none.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Single => "off",
            Self::Other(_) => "vector",
        }
    }
}

impl Level {
    /// The best this processor has.
    #[must_use]
    pub fn best() -> Self {
        Self::all().last().unwrap_or_default()
    }
}

impl PartialEq for Level {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

/// Sixteen numbers at a time, on the vector instructions whose token it holds.
#[derive(Clone, Copy, Debug)]
pub struct Sixteen<S: Simd>(pub S);

impl<S: Simd> Lanes for Sixteen<S> {
    type F = f32x16<S>;
    type Sum = f32x16<S>;
    const WIDTH: usize = SUM_LANES;

    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        f32x16::splat(self.0, x)
    }
    #[inline(always)]
    fn load(self, from: &[f32], at: usize) -> Self::F {
        match from.get(at..).and_then(|rest| rest.first_chunk::<SUM_LANES>()) {
            Some(chunk) => f32x16::from_slice(self.0, chunk),
            None => f32x16::splat(self.0, 0.0),
        }
    }
    #[inline(always)]
    fn store(self, x: Self::F, to: &mut [f32], at: usize) {
        if let Some(chunk) = to.get_mut(at..).and_then(|rest| rest.first_chunk_mut::<SUM_LANES>()) {
            x.store_slice(chunk);
        }
    }
    #[inline(always)]
    fn root(self, x: Self::F) -> Self::F {
        SimdFloat::sqrt(x)
    }
    #[inline(always)]
    fn larger(self, a: Self::F, b: Self::F) -> Self::F {
        a.simd_gt(b).select(a, b)
    }
    #[inline(always)]
    fn where_positive(self, test: Self::F, x: Self::F) -> Self::F {
        let zero = f32x16::splat(self.0, 0.0);
        test.simd_gt(zero).select(x, zero)
    }
    #[inline(always)]
    fn nothing(self) -> Self::Sum {
        f32x16::splat(self.0, 0.0)
    }
    #[inline(always)]
    fn add(self, sum: Self::Sum, _: usize, x: Self::F) -> Self::Sum {
        sum + x
    }
    #[inline(always)]
    fn partial(self, sum: Self::Sum) -> [f32; SUM_LANES] {
        let mut lanes = [0.0; SUM_LANES];
        sum.store_slice(&mut lanes);
        lanes
    }
}
