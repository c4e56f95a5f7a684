//! The fixed-step kernel of the pendulums, over any number type.

use crate::joint::Real;
use std::ops::{Add, Mul};

/// One step of the classical fourth-order Runge-Kutta method.
///
/// `first` is the rate at `(t, y)`, which the caller usually has; `rate` gives it elsewhere. The step may carry
/// derivatives, so that an event whose time depends on a parameter is differentiated exactly; most carry none, and a
/// plain number then costs less. No allocation.
#[inline]
pub fn rk4<T, S, const N: usize>(
    rate: impl Fn(T, &[T; N]) -> [T; N],
    t: T,
    y: &[T; N],
    first: &[T; N],
    step: S,
) -> [T; N]
where
    T: Real + Add<S, Output = T> + Mul<S, Output = T>,
    S: Copy + Mul<f64, Output = S>,
{
    let half = step * 0.5;
    let at = |k: &[T; N], h: S| {
        let mut there = *y;
        for (y, k) in there.iter_mut().zip(k) {
            *y += *k * h;
        }
        there
    };
    let k2 = rate(t + half, &at(first, half));
    let k3 = rate(t + half, &at(&k2, half));
    let k4 = rate(t + step, &at(&k3, step));
    let sixth = step * (1.0 / 6.0);
    let mut end = *y;
    for (i, y) in end.iter_mut().enumerate() {
        *y += (first[i] + (k2[i] + k3[i]) * 2.0 + k4[i]) * sixth;
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fourth_order_on_an_oscillator() {
        let error = |n: usize| {
            let rate = |_t: f64, y: &[f64; 2]| [y[1], -y[0]];
            let h = 2.0 / n as f64;
            let mut y = [1.0, 0.0];
            for _ in 0..n {
                let k1 = rate(0.0, &y);
                y = rk4(rate, 0.0, &y, &k1, h);
            }
            (y[0] - 2.0f64.cos()).abs()
        };
        let ratio = error(20) / error(40);
        assert!((14.0..18.0).contains(&ratio), "halving the step divides the error by 16, not {ratio}");
    }
}
