//! Passes over arrays, written once: a vector's lanes at a time on a PC, one number at a time on a microcontroller.
//!
//! A pass is generic over [`Lanes`] and runs through `run_on!`, which picks the processor's instructions by a [`Level`] found
//! once at start. Lanes never mix but in a [`Lanes::Sum`], which has [`SUM_LANES`] of them on every target, and nothing is
//! fused or approximate: every level gives the same bits. Functions of a pass must be `#[inline(always)]`, so that they are
//! compiled with the instructions of the level; for the same reason nothing in lanes goes through a closure of `core`, as in `map`.

use crate::math::sqrt;
use core::ops::{Add, Div, Mul, Sub};

/// Lanes of a sum on every target; arrays that passes run over begin and end at multiples of it.
pub const SUM_LANES: usize = 16;

/// Some numbers that are worked on together.
pub trait Lanes: Copy {
    /// The numbers.
    type F: Copy + Add<Output = Self::F> + Sub<Output = Self::F> + Mul<Output = Self::F> + Div<Output = Self::F>;
    /// Partial sums, one a lane.
    type Sum: Copy;
    /// How many numbers; a divisor of [`SUM_LANES`].
    const WIDTH: usize;

    /// The same number in every lane.
    fn splat(self, x: f32) -> Self::F;
    /// The numbers from index `at`; zeros where they would reach past the end.
    fn load(self, from: &[f32], at: usize) -> Self::F;
    /// Stores at index `at`; nothing where it would reach past the end.
    fn store(self, x: Self::F, to: &mut [f32], at: usize);
    /// Square root, correctly rounded.
    fn root(self, x: Self::F) -> Self::F;
    /// `a` where it is above `b`, else `b`.
    fn larger(self, a: Self::F, b: Self::F) -> Self::F;
    /// `x` where `test` > 0, else 0 (also where it is not a number).
    fn where_positive(self, test: Self::F, x: Self::F) -> Self::F;
    /// No sum yet.
    fn nothing(self) -> Self::Sum;
    /// Adds the numbers from index `at` to the partial sums.
    fn add(self, sum: Self::Sum, at: usize, x: Self::F) -> Self::Sum;
    /// The partial sums.
    fn partial(self, sum: Self::Sum) -> [f32; SUM_LANES];

    /// The three components from index `at`.
    #[inline(always)]
    fn vector<const N: usize>(self, field: &[[f32; N]; 3], at: usize) -> [Self::F; 3] {
        let [x, y, z] = field;
        [self.load(x, at), self.load(y, at), self.load(z, at)]
    }

    /// Sum of everything: the lanes as a tree, halves added until one is left.
    #[inline(always)]
    fn total(self, sum: Self::Sum) -> f32 {
        let [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = self.partial(sum);
        let [a, b, c, d, e, f, g, h] = [a + i, b + j, c + k, d + l, e + m, f + n, g + o, h + p];
        let [a, b, c, d] = [a + e, b + f, c + g, d + h];
        (a + c) + (b + d)
    }
}

/// `at`, or the last index from which whole lanes lie within `N` numbers: never reached where [`crate::lattice::Lattice::guard`] holds,
/// it tells the compiler that the loads and stores at this index need no check.
#[inline(always)]
pub(crate) fn within<L: Lanes, const N: usize>(at: usize) -> usize {
    at.min(N.saturating_sub(L::WIDTH))
}

/// Indices of the lanes that cover the first `n` of `N` numbers.
#[inline(always)]
pub(crate) fn blocks<L: Lanes, const N: usize>(n: usize) -> impl Iterator<Item = usize> {
    (0..n).step_by(L::WIDTH).map(within::<L, N>)
}

/// One number at a time, on any target.
#[derive(Clone, Copy, Debug)]
pub struct Single;

impl Lanes for Single {
    type F = f32;
    type Sum = [f32; SUM_LANES];
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat(self, x: f32) -> f32 {
        x
    }
    #[inline(always)]
    fn load(self, from: &[f32], at: usize) -> f32 {
        from.get(at).copied().unwrap_or(0.0)
    }
    #[inline(always)]
    fn store(self, x: f32, to: &mut [f32], at: usize) {
        if let Some(to) = to.get_mut(at) {
            *to = x;
        }
    }
    #[inline(always)]
    fn root(self, x: f32) -> f32 {
        sqrt(x)
    }
    #[inline(always)]
    fn larger(self, a: f32, b: f32) -> f32 {
        if a > b { a } else { b }
    }
    #[inline(always)]
    fn where_positive(self, test: f32, x: f32) -> f32 {
        if test > 0.0 { x } else { 0.0 }
    }
    #[inline(always)]
    fn nothing(self) -> Self::Sum {
        [0.0; SUM_LANES]
    }
    #[inline(always)]
    fn add(self, mut sum: Self::Sum, at: usize, x: f32) -> Self::Sum {
        if let Some(lane) = sum.get_mut(at % SUM_LANES) {
            *lane += x;
        }
        sum
    }
    #[inline(always)]
    fn partial(self, sum: Self::Sum) -> [f32; SUM_LANES] {
        sum
    }
}

/// Which instructions passes run on. Results do not depend on it, only their time.
#[derive(Clone, Copy, Debug, Default)]
pub enum Level {
    /// One number at a time: what a microcontroller does, and the baseline that instruction counts are taken on.
    #[default]
    Single,
    /// Sixteen lanes on vectors of four, which every x86-64 processor has.
    #[cfg(all(feature = "simd", target_arch = "x86_64"))]
    Sse2(fearless_simd::x86::Sse2),
    /// Sixteen lanes on vectors of eight.
    #[cfg(all(feature = "simd", target_arch = "x86_64"))]
    Avx2(fearless_simd::x86::Avx2),
    /// Sixteen lanes on vectors of sixteen.
    #[cfg(all(feature = "simd", target_arch = "x86_64"))]
    Avx512(fearless_simd::x86::Avx512),
    /// Sixteen lanes on what another kind of processor has.
    #[cfg(all(feature = "simd", not(target_arch = "x86_64")))]
    Other(fearless_simd::Level),
}

/// Runs a pass, an expression of the lanes `$lanes`, on the instructions of `$level`.
macro_rules! run_on {
    ($level:expr, $lanes:ident => $pass:expr) => {
        match $level {
            $crate::lanes::Level::Single => {
                let $lanes = $crate::lanes::Single;
                $pass
            }
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            $crate::lanes::Level::Sse2(token) => $crate::lanes::run_with!(token, $lanes => $pass),
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            $crate::lanes::Level::Avx2(token) => $crate::lanes::run_with!(token, $lanes => $pass),
            #[cfg(all(feature = "simd", target_arch = "x86_64"))]
            $crate::lanes::Level::Avx512(token) => $crate::lanes::run_with!(token, $lanes => $pass),
            #[cfg(all(feature = "simd", not(target_arch = "x86_64")))]
            $crate::lanes::Level::Other(level) => fearless_simd::dispatch!(level, token => {
                let $lanes = $crate::lanes::Sixteen(token);
                $pass
            }),
        }
    };
}

/// Runs a pass with the vector instructions that `$token` proves.
#[cfg(all(feature = "simd", target_arch = "x86_64"))]
macro_rules! run_with {
    ($token:ident, $lanes:ident => $pass:expr) => {{
        let $lanes = $crate::lanes::Sixteen($token);
        fearless_simd::Simd::vectorize(
            $token,
            #[inline(always)]
            || $pass,
        )
    }};
}

#[cfg(all(feature = "simd", target_arch = "x86_64"))]
pub(crate) use run_with;

pub(crate) use run_on;

#[cfg(feature = "simd")]
mod vector;

#[cfg(feature = "simd")]
pub use vector::Sixteen;
