//! Sine and cosine of an angle, or of several at once.
//!
//! The angle is brought to within pi/4 of a multiple of pi/2 by a subtraction in three parts (Cody and Waite 1980) with
//! the rounding error kept, then fdlibm's polynomials (Sun Microsystems 1993) give both functions. Below
//! [`LARGEST_RAD`] the result is within one unit in the last place; beyond, the slower reduction of the crate `libm` is used.
//! Unlike the standard library's, both give the same bits on every processor.

use std::ops::{Add, Mul, Sub};

/// Angles up to here are reduced here; a million turns is no joint.
pub(crate) const LARGEST_RAD: f64 = 8.0e5;
/// 1.5 * 2^52: adding it rounds to an integer, which then stands in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// pi/2 in three parts; the first two have 33 bits, so their products with a small integer are exact.
const HALF_PI: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
const SIN: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
const COS: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// One number, or several that are worked on at once.
pub(crate) trait Lanes: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// The same number in every lane.
    fn splat(value: f64) -> Self;
}

impl Lanes for f64 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }
}

/// Sine and cosine \[-\] of an angle \[rad\].
#[inline(always)]
pub(crate) fn sin_cos(angle_rad: f64) -> (f64, f64) {
    if !(angle_rad.abs() < LARGEST_RAD) {
        return libm::sincos(angle_rad);
    }
    let (sine, cosine, quarters) = of_rest(angle_rad);
    in_quadrant(sine, cosine, quarters.to_bits())
}

/// Sine and cosine of what is left of angles below [`LARGEST_RAD`] beyond quarter turns, and the number of these in the low
/// bits, for [`in_quadrant`].
#[inline(always)]
pub(crate) fn of_rest<L: Lanes>(angle_rad: L) -> (L, L, L) {
    let [p1, p2, p3] = [L::splat(HALF_PI[0]), L::splat(HALF_PI[1]), L::splat(HALF_PI[2])];
    let rounded = angle_rad * L::splat(std::f64::consts::FRAC_2_PI) + L::splat(ROUND);
    let turns = rounded - L::splat(ROUND);
    let coarse = angle_rad - turns * p1;
    let fine = turns * p2;
    let high = coarse - fine;
    // What the subtraction lost, and the third part of pi/2.
    let lost = turns * p3 - ((coarse - high) - fine);
    let x = high - lost;
    let low = (high - x) - lost;
    let (sine, cosine) = kernels(x, low);
    (sine, cosine, rounded)
}

/// Sine and cosine of `x + low` with `|x| <= pi/4`.
#[inline(always)]
fn kernels<L: Lanes>(x: L, low: L) -> (L, L) {
    let one = L::splat(1.0);
    let half = L::splat(0.5);
    let z = x * x;
    let v = z * x;
    let s = |k: usize| L::splat(SIN[k]);
    let r = s(1) + z * (s(2) + z * (s(3) + z * (s(4) + z * s(5))));
    let sine = x - ((z * (half * low - v * r) - low) - v * s(0));
    let c = |k: usize| L::splat(COS[k]);
    let r = z * (c(0) + z * (c(1) + z * (c(2) + z * (c(3) + z * (c(4) + z * c(5))))));
    let hz = half * z;
    let w = one - hz;
    let cosine = w + (((one - w) - hz) + (z * r - x * low));
    (sine, cosine)
}

/// Sine and cosine of an angle from those of its rest, by the two low bits of the number of quarter turns.
#[inline(always)]
pub(crate) fn in_quadrant(sine: f64, cosine: f64, quarters: u64) -> (f64, f64) {
    let (s, c) = if quarters & 1 == 0 { (sine, cosine) } else { (cosine, sine) };
    let sign = |x: f64, negative: u64| f64::from_bits(x.to_bits() ^ (negative << 63));
    (sign(s, (quarters >> 1) & 1), sign(c, ((quarters + 1) >> 1) & 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn units_apart(a: f64, b: f64) -> u64 {
        if a == b { 0 } else { a.to_bits().abs_diff(b.to_bits()) }
    }

    fn compare(x: f64) {
        let ((s0, c0), (s1, c1)) = (sin_cos(x), sin_cos(-x));
        assert!(units_apart(s0, x.sin()) <= 1, "sin {x:?}: {s0:?} against {:?}", x.sin());
        assert!(units_apart(c0, x.cos()) <= 1, "cos {x:?}: {c0:?} against {:?}", x.cos());
        assert_eq!((s1, c1), (-s0, c0));
    }

    #[test]
    fn special_angles() {
        for k in -40..=40 {
            for nudge in [0.0, 1e-16, -3e-12, 1e-5] {
                compare(f64::from(k) * std::f64::consts::FRAC_PI_4 + nudge);
            }
        }
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
        assert!(sin_cos(f64::NAN).0.is_nan() && sin_cos(1e300).0.abs() <= 1.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn within_one_unit_in_the_last_place(x in prop_oneof![-4.0..4.0, -1e3..1e3, -8e5..8e5]) {
            compare(x);
        }
    }
}
