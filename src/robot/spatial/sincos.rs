//! Sine and cosine of two angles at once.

use super::Pair;
use crate::number::{LARGEST_RAD, Lanes, in_quadrant, math, of_rest};

impl Lanes for Pair {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Pair::splat(value)
    }
}

/// Sines and cosines \[-\] of two angles \[rad\].
#[inline(always)]
pub(in crate::robot) fn sin_cos(angle_rad: Pair) -> (Pair, Pair) {
    let [first, second] = angle_rad.lanes();
    if !(first.abs() < LARGEST_RAD && second.abs() < LARGEST_RAD) {
        let ((s0, c0), (s1, c1)) = (math::sin_cos(first), math::sin_cos(second));
        return (Pair::new(s0, s1), Pair::new(c0, c1));
    }
    let (sine, cosine, rounded) = of_rest(angle_rad);
    let ([s0, s1], [c0, c1], [n0, n1]) = (sine.lanes(), cosine.lanes(), rounded.lanes());
    let (s0, c0) = in_quadrant(s0, c0, n0.to_bits());
    let (s1, c1) = in_quadrant(s1, c1, n1.to_bits());
    (Pair::new(s0, s1), Pair::new(c0, c1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_as_one() {
        for [a, b] in [[0.3, -70.2], [f64::NAN, 1e300], [12.5, 0.0]] {
            let (s, c) = sin_cos(Pair::new(a, b));
            for (lane, x) in [a, b].into_iter().enumerate() {
                let (sine, cosine) =
                    if (a.abs() < 8e5) && (b.abs() < 8e5) { crate::number::sin_cos(x) } else { x.sin_cos() };
                assert_eq!((s.lanes()[lane].to_bits(), c.lanes()[lane].to_bits()), (sine.to_bits(), cosine.to_bits()));
            }
        }
    }
}
