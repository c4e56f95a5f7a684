//! The number type that the joint's equations are written over.

use crate::number::math;
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A real number that may carry derivatives: `f64`, or a [`Dual`](super::Dual) number for exact sensitivities.
///
/// Branches (stick or slip, saturated or not) are taken on the real part alone, so that a dual run takes the same path
/// as the plain one.
pub trait Real:
    Copy
    + Debug
    + PartialEq
    + Send
    + Sync
    + 'static
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + AddAssign<f64>
    + MulAssign<f64>
{
    /// A constant.
    fn constant(value: f64) -> Self;

    /// Zero.
    #[inline(always)]
    fn nought() -> Self {
        Self::constant(0.0)
    }

    /// The number itself, without its derivatives.
    fn re(&self) -> f64;

    /// Whether it depends on nothing.
    fn is_constant(&self) -> bool;

    /// Its inverse.
    fn recip(self) -> Self;

    /// Its square root.
    fn sqrt(self) -> Self;

    /// `e` to its power.
    fn exp(self) -> Self;

    /// Its hyperbolic tangent.
    fn tanh(self) -> Self;

    /// Sine and cosine of it \[rad\].
    fn sin_cos(self) -> (Self, Self);

    /// The angle of the point `(x, self)` \[rad\].
    fn atan2(self, x: Self) -> Self;

    /// Its power with an exponent that may carry derivatives too; it is above zero.
    fn powd(self, exponent: Self) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn re(&self) -> f64 {
        *self
    }

    #[inline(always)]
    fn is_constant(&self) -> bool {
        true
    }

    #[inline(always)]
    fn recip(self) -> Self {
        f64::recip(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn exp(self) -> Self {
        math::exp(self)
    }

    #[inline(always)]
    fn tanh(self) -> Self {
        math::tanh(self)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        crate::number::sin_cos(self)
    }

    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        math::atan2(self, x)
    }

    #[inline(always)]
    fn powd(self, exponent: Self) -> Self {
        math::powf(self, exponent)
    }
}
