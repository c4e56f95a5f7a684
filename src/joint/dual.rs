//! A number with its derivatives by a few variables.
//!
//! Simulations with derivatives are where a diagnosis spends its time. The derivatives stand in an array of known length
//! and every operation is inlined, so that they are worked on several at a time; a constant has zeros there.

use super::Real;
use crate::number::math;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A number and its derivatives by `N` variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    /// The number itself.
    pub re: f64,
    /// Its derivatives.
    pub eps: [f64; N],
}

/// An array by its index, without a call in the innermost loop.
#[inline(always)]
fn each<const N: usize>(of: impl Fn(usize) -> f64) -> [f64; N] {
    let mut all = [0.0; N];
    for (i, one) in all.iter_mut().enumerate() {
        *one = of(i);
    }
    all
}

impl<const N: usize> Dual<N> {
    /// The `index`-th of the variables, at `value`.
    pub fn variable(value: f64, index: usize) -> Self {
        let mut eps = [0.0; N];
        eps[index] = 1.0;
        Self { re: value, eps }
    }

    /// A function of it, by its value and its slope here. What does not depend on a variable does not do so through a
    /// slope that is infinite.
    #[inline(always)]
    fn through(self, value: f64, slope: f64) -> Self {
        Self { re: value, eps: each(|i| if self.eps[i] == 0.0 { 0.0 } else { self.eps[i] * slope }) }
    }

    /// The same where the slope is never infinite.
    #[inline(always)]
    fn along(self, value: f64, slope: f64) -> Self {
        Self { re: value, eps: each(|i| self.eps[i] * slope) }
    }

    /// By the product rule.
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        Self { re: self.re * other.re, eps: each(|i| self.eps[i] * other.re + other.eps[i] * self.re) }
    }

    /// By the quotient rule.
    #[inline(always)]
    fn over(self, other: Self) -> Self {
        let inverse = other.re.recip();
        let slope = |i: usize| (self.eps[i] * other.re - other.eps[i] * self.re) * inverse * inverse;
        Self { re: self.re * inverse, eps: each(slope) }
    }
}

impl<const N: usize> Real for Dual<N> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self { re: value, eps: [0.0; N] }
    }

    #[inline(always)]
    fn re(&self) -> f64 {
        self.re
    }

    #[inline(always)]
    fn is_constant(&self) -> bool {
        self.eps.iter().all(|d| *d == 0.0)
    }

    #[inline(always)]
    fn recip(self) -> Self {
        let inverse = self.re.recip();
        self.through(inverse, -inverse * inverse)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        self.through(root, root * self.re.recip() * 0.5)
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let value = math::exp(self.re);
        self.through(value, value)
    }

    #[inline(always)]
    fn tanh(self) -> Self {
        let (sinh, cosh) = (math::sinh(self.re), math::cosh(self.re));
        self.through(sinh, cosh) / self.through(cosh, sinh)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = crate::number::sin_cos(self.re);
        (self.along(sin, cos), self.along(cos, -sin))
    }

    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        let ratio = self / x;
        ratio.through(math::atan2(self.re, x.re), (1.0 + ratio.re * ratio.re).recip())
    }

    #[inline(always)]
    fn powd(self, exponent: Self) -> Self {
        (self.through(math::ln(self.re), self.re.recip()) * exponent).exp()
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { re: -self.re, eps: each(|i| -self.eps[i]) }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, eps: each(|i| self.eps[i] + other.eps[i]) }
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, eps: each(|i| self.eps[i] - other.eps[i]) }
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.times(other)
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.over(other)
    }
}

impl<const N: usize> Add<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f64) -> Self {
        Self { re: self.re + other, eps: self.eps }
    }
}

impl<const N: usize> Sub<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        Self { re: self.re - other, eps: self.eps }
    }
}

impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        Self { re: self.re * other, eps: each(|i| self.eps[i] * other) }
    }
}

impl<const N: usize> Div<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: f64) -> Self {
        Self { re: self.re / other, eps: each(|i| self.eps[i] / other) }
    }
}

impl<const N: usize> AddAssign for Dual<N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const N: usize> SubAssign for Dual<N> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<const N: usize> MulAssign for Dual<N> {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<const N: usize> AddAssign<f64> for Dual<N> {
    #[inline(always)]
    fn add_assign(&mut self, other: f64) {
        self.re += other;
    }
}

impl<const N: usize> MulAssign<f64> for Dual<N> {
    #[inline(always)]
    fn mul_assign(&mut self, other: f64) {
        *self = *self * other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Every operation, over any number.
    fn all<T: Real>(x: T, y: T) -> Vec<T> {
        let (sin, cos) = x.sin_cos();
        let mut changed = x;
        changed += y;
        changed -= x * y;
        changed *= y;
        changed += 0.3;
        changed *= 1.7;
        vec![
            -x,
            x + y,
            x - y,
            x * y,
            x / y,
            (x + 0.5) * 2.0 / 3.0 - 0.1,
            x.recip(),
            x.sqrt(),
            x.exp(),
            x.tanh(),
            sin,
            cos,
            x.atan2(y),
            x.powd(y),
            changed,
        ]
    }

    #[test]
    fn derivatives_are_slopes() {
        let (x, y, h) = (0.7, 1.3, 1e-6);
        let exact = all(Dual::<2>::variable(x, 0), Dual::variable(y, 1));
        let here = all(x, y);
        let by_x = [all(x + h, y), all(x - h, y)];
        let by_y = [all(x, y + h), all(x, y - h)];
        for (k, exact) in exact.iter().enumerate() {
            assert_relative_eq!(exact.re, here[k], max_relative = 1e-15);
            assert_relative_eq!(exact.eps[0], (by_x[0][k] - by_x[1][k]) / (2.0 * h), epsilon = 1e-8);
            assert_relative_eq!(exact.eps[1], (by_y[0][k] - by_y[1][k]) / (2.0 * h), epsilon = 1e-8);
        }
    }

    #[test]
    fn a_constant_stays_one_where_slopes_are_infinite() {
        let nought = Dual::<3>::nought();
        assert!(nought.sqrt().is_constant() && nought.is_constant());
        assert!(!Dual::<3>::variable(0.0, 2).is_constant());
    }
}
