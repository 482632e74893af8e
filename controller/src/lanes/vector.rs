//! Sixteen lanes on vector instructions, by a crate that makes them safe.

use super::{Lanes, Level, SUM_LANES};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};

impl Level {
    /// The best this processor has.
    #[must_use]
    pub fn best() -> Self {
        Self::Vector(fearless_simd::Level::new())
    }

    /// Every level this processor has, the plainest first, with its name.
    pub fn all() -> impl Iterator<Item = (&'static str, Self)> {
        let best = fearless_simd::Level::new();
        #[cfg(target_arch = "x86_64")]
        let vectors = [
            ("sse2", best.as_sse2().map(|token| token.level())),
            ("sse4.2", best.as_sse4_2().map(|token| token.level())),
            ("avx2", best.as_avx2().map(|token| token.level())),
            ("avx512", best.as_avx512().map(|token| token.level())),
        ];
        #[cfg(not(target_arch = "x86_64"))]
        let vectors = [("vector", Some(best))];
        let vectors = vectors
            .into_iter()
            .filter_map(|(name, level)| Some((name, Self::Vector(level?))));
        core::iter::once(("off", Self::Single)).chain(vectors)
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
