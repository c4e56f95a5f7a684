//! Two and four numbers side by side, one operation on all.
//!
//! Legs come in twos, robots in as many as a register holds. On x86-64 a pair is one register of the baseline instruction
//! set, and a quad one of AVX2 where the build may use that, so nothing has to be detected at run time; elsewhere a pair is
//! two plain numbers. No operation fuses a multiplication with an addition, so the bits of a result depend neither on the
//! processor nor on what is in the other lanes.
//!
//! The only unsafe code of the project is here: calls of intrinsics that every processor the build is for has.
#![allow(unsafe_code)]

use super::Number;
use crate::number::Lanes;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

/// Two numbers.
#[derive(Clone, Copy, Debug)]
#[cfg(target_arch = "x86_64")]
pub(in crate::robot) struct Pair(__m128d);

/// Two numbers.
#[derive(Clone, Copy, Debug)]
#[cfg(not(target_arch = "x86_64"))]
pub(in crate::robot) struct Pair([f64; 2]);

/// Four numbers.
#[derive(Clone, Copy, Debug)]
#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
pub(in crate::robot) struct Quad(__m256d);

/// As many numbers as a register holds.
#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
pub(in crate::robot) type Widest = Quad;

/// As many numbers as a register holds.
#[cfg(not(all(target_arch = "x86_64", target_feature = "avx2")))]
pub(in crate::robot) type Widest = Pair;

/// Constants of two bodies: a register of both, or each on its own.
#[derive(Clone, Copy, Debug)]
#[repr(align(16))]
pub(in crate::robot) struct Two(pub [f64; 2]);

impl Two {
    /// Both, side by side.
    #[inline(always)]
    pub fn pair(&self) -> Pair {
        Pair::new(self.0[0], self.0[1])
    }
}

/// Calls an intrinsic that the build has.
#[cfg(target_arch = "x86_64")]
macro_rules! present {
    ($call:expr) => {
        // SAFETY: the only condition of these intrinsics is SSE2, which every x86-64 processor has, or AVX2 where the
        // build is for that; they touch no memory.
        unsafe { $call }
    };
}

#[cfg(target_arch = "x86_64")]
impl Pair {
    /// Two numbers.
    #[inline(always)]
    pub fn new(first: f64, second: f64) -> Self {
        Self(present!(_mm_set_pd(second, first)))
    }

    /// Both numbers.
    #[inline(always)]
    pub fn lanes(self) -> [f64; 2] {
        present!([_mm_cvtsd_f64(self.0), _mm_cvtsd_f64(_mm_unpackhi_pd(self.0, self.0))])
    }
}

#[cfg(not(target_arch = "x86_64"))]
impl Pair {
    /// Two numbers.
    #[inline(always)]
    pub fn new(first: f64, second: f64) -> Self {
        Self([first, second])
    }

    /// Both numbers.
    #[inline(always)]
    pub fn lanes(self) -> [f64; 2] {
        self.0
    }
}

impl Pair {
    /// The same number twice.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Self::new(value, value)
    }

    /// Zero twice.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::splat(0.0)
    }

    /// The sum of both numbers.
    #[inline(always)]
    pub fn sum(self) -> f64 {
        let [first, second] = self.lanes();
        first + second
    }
}

impl Number for Pair {
    type Each = [f64; 2];
    const LANES: usize = 2;

    #[inline(always)]
    fn of(mut lane: impl FnMut(usize) -> f64) -> Self {
        let first = lane(0);
        Self::new(first, lane(1))
    }

    #[inline(always)]
    fn each(self) -> [f64; 2] {
        self.lanes()
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        #[cfg(target_arch = "x86_64")]
        return Self(present!(_mm_div_pd(_mm_set1_pd(1.0), self.0)));
        #[cfg(not(target_arch = "x86_64"))]
        Self(self.0.map(|x| 1.0 / x))
    }

    #[inline(always)]
    #[cfg(target_arch = "x86_64")]
    fn in_quadrant(sine: Self, cosine: Self, quarters: Self) -> (Self, Self) {
        present!({
            let quarters = _mm_castpd_si128(quarters.0);
            let one = _mm_set1_epi64x(1);
            let odd = _mm_castsi128_pd(_mm_sub_epi64(_mm_setzero_si128(), _mm_and_si128(quarters, one)));
            let pick = |even, other| _mm_or_pd(_mm_andnot_pd(odd, even), _mm_and_pd(odd, other));
            // The second bit from below, where the sign is.
            let sign = |bits| _mm_and_pd(_mm_castsi128_pd(_mm_slli_epi64::<62>(bits)), _mm_set1_pd(-0.0));
            let (s, c) = (pick(sine.0, cosine.0), pick(cosine.0, sine.0));
            (Self(_mm_xor_pd(s, sign(quarters))), Self(_mm_xor_pd(c, sign(_mm_add_epi64(quarters, one)))))
        })
    }
}

impl Lanes for Pair {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Pair::splat(value)
    }
}

#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
impl Number for Quad {
    type Each = [f64; 4];
    const LANES: usize = 4;

    #[inline(always)]
    fn of(mut lane: impl FnMut(usize) -> f64) -> Self {
        let (a, b, c, d) = (lane(0), lane(1), lane(2), lane(3));
        Self(present!(_mm256_set_pd(d, c, b, a)))
    }

    #[inline(always)]
    fn each(self) -> [f64; 4] {
        let (low, high) = present!((_mm256_castpd256_pd128(self.0), _mm256_extractf128_pd::<1>(self.0)));
        let ([a, b], [c, d]) = (Pair(low).lanes(), Pair(high).lanes());
        [a, b, c, d]
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        Self(present!(_mm256_div_pd(_mm256_set1_pd(1.0), self.0)))
    }

    #[inline(always)]
    fn in_quadrant(sine: Self, cosine: Self, quarters: Self) -> (Self, Self) {
        present!({
            let quarters = _mm256_castpd_si256(quarters.0);
            // Picks by the highest bit.
            let odd = _mm256_castsi256_pd(_mm256_slli_epi64::<63>(quarters));
            let sign = |bits| _mm256_and_pd(_mm256_castsi256_pd(_mm256_slli_epi64::<62>(bits)), _mm256_set1_pd(-0.0));
            let s = _mm256_blendv_pd(sine.0, cosine.0, odd);
            let c = _mm256_blendv_pd(cosine.0, sine.0, odd);
            let next = _mm256_add_epi64(quarters, _mm256_set1_epi64x(1));
            (Self(_mm256_xor_pd(s, sign(quarters))), Self(_mm256_xor_pd(c, sign(next))))
        })
    }
}

#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
impl Lanes for Quad {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(present!(_mm256_set1_pd(value)))
    }
}

macro_rules! operation {
    ($operation:ident, $method:ident, $of_pairs:ident, $of_quads:ident, $sign:tt) => {
        impl $operation for Pair {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                #[cfg(target_arch = "x86_64")]
                return Self(present!($of_pairs(self.0, other.0)));
                #[cfg(not(target_arch = "x86_64"))]
                Self([self.0[0] $sign other.0[0], self.0[1] $sign other.0[1]])
            }
        }

        #[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
        impl $operation for Quad {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(present!($of_quads(self.0, other.0)))
            }
        }
    };
}

operation!(Add, add, _mm_add_pd, _mm256_add_pd, +);
operation!(Sub, sub, _mm_sub_pd, _mm256_sub_pd, -);
operation!(Mul, mul, _mm_mul_pd, _mm256_mul_pd, *);

macro_rules! follows {
    ($type:ty) => {
        impl AddAssign for $type {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl Neg for $type {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self::zero() - self
            }
        }
    };
}

follows!(Pair);
#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
follows!(Quad);
