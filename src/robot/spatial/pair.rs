//! Two numbers side by side, one operation on both.
//!
//! Legs come in twos. On x86-64 a pair is one register of the baseline instruction set, so nothing has to be detected
//! at run time; elsewhere it is two plain numbers. No operation fuses a multiplication with an addition, so the bits of
//! a result do not depend on the processor.
//!
//! The only unsafe code of the project is here: a call of an intrinsic that every processor of the target has.
#![allow(unsafe_code)]

use std::ops::{Add, AddAssign, Mul, Neg, Sub};

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{
    __m128d, _mm_add_pd, _mm_cvtsd_f64, _mm_div_pd, _mm_mul_pd, _mm_set_pd, _mm_set1_pd, _mm_sub_pd, _mm_unpackhi_pd,
};

/// Two numbers.
#[derive(Clone, Copy, Debug)]
#[cfg(target_arch = "x86_64")]
pub(in crate::robot) struct Pair(__m128d);

/// Two numbers.
#[derive(Clone, Copy, Debug)]
#[cfg(not(target_arch = "x86_64"))]
pub(in crate::robot) struct Pair([f64; 2]);

/// Calls a baseline intrinsic.
#[cfg(target_arch = "x86_64")]
macro_rules! baseline {
    ($call:expr) => {
        // SAFETY: the only condition of these intrinsics is SSE2, which every x86-64 processor has; they touch no memory.
        unsafe { $call }
    };
}

#[cfg(target_arch = "x86_64")]
impl Pair {
    /// Two numbers.
    #[inline(always)]
    pub fn new(first: f64, second: f64) -> Self {
        Self(baseline!(_mm_set_pd(second, first)))
    }

    /// The same number twice.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Self(baseline!(_mm_set1_pd(value)))
    }

    /// Both numbers.
    #[inline(always)]
    pub fn lanes(self) -> [f64; 2] {
        baseline!([_mm_cvtsd_f64(self.0), _mm_cvtsd_f64(_mm_unpackhi_pd(self.0, self.0))])
    }

    /// One divided by each.
    #[inline(always)]
    pub fn inverse(self) -> Self {
        Self(baseline!(_mm_div_pd(_mm_set1_pd(1.0), self.0)))
    }
}

#[cfg(not(target_arch = "x86_64"))]
impl Pair {
    /// Two numbers.
    #[inline(always)]
    pub fn new(first: f64, second: f64) -> Self {
        Self([first, second])
    }

    /// The same number twice.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Self([value; 2])
    }

    /// Both numbers.
    #[inline(always)]
    pub fn lanes(self) -> [f64; 2] {
        self.0
    }

    /// One divided by each.
    #[inline(always)]
    pub fn inverse(self) -> Self {
        Self(self.0.map(|x| 1.0 / x))
    }
}

impl Pair {
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

macro_rules! operation {
    ($operation:ident, $method:ident, $intrinsic:ident, $sign:tt) => {
        impl $operation for Pair {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                #[cfg(target_arch = "x86_64")]
                return Self(baseline!($intrinsic(self.0, other.0)));
                #[cfg(not(target_arch = "x86_64"))]
                Self([self.0[0] $sign other.0[0], self.0[1] $sign other.0[1]])
            }
        }
    };
}

operation!(Add, add, _mm_add_pd, +);
operation!(Sub, sub, _mm_sub_pd, -);
operation!(Mul, mul, _mm_mul_pd, *);

impl AddAssign for Pair {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Neg for Pair {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::zero() - self
    }
}
