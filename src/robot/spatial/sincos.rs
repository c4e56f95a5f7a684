//! Sine and cosine of two angles at once.
//!
//! The angle is brought to within pi/4 of a multiple of pi/2 by a subtraction in three parts (Cody and Waite 1980) with
//! the rounding error kept, then fdlibm's polynomials (Sun Microsystems 1993) give both functions. Below
//! [`LARGEST_RAD`] the result is within one unit in the last place; beyond, the standard library's functions are used.
//! Unlike those, this gives the same bits on every machine.

use super::Pair;

/// Angles up to here are reduced here; a million turns is no joint.
const LARGEST_RAD: f64 = 8.0e5;
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

/// Sines and cosines \[-\] of two angles \[rad\].
#[inline(always)]
pub(in crate::robot) fn sin_cos(angle_rad: Pair) -> (Pair, Pair) {
    let [first, second] = angle_rad.lanes();
    if !(first.abs() < LARGEST_RAD && second.abs() < LARGEST_RAD) {
        let ((s0, c0), (s1, c1)) = (first.sin_cos(), second.sin_cos());
        return (Pair::new(s0, s1), Pair::new(c0, c1));
    }
    let [p1, p2, p3] = HALF_PI.map(Pair::splat);
    let rounded = angle_rad * Pair::splat(std::f64::consts::FRAC_2_PI) + Pair::splat(ROUND);
    let turns = rounded - Pair::splat(ROUND);
    let coarse = angle_rad - turns * p1;
    let fine = turns * p2;
    let high = coarse - fine;
    // What the subtraction lost, and the third part of pi/2.
    let lost = turns * p3 - ((coarse - high) - fine);
    let x = high - lost;
    let low = (high - x) - lost;
    let (sine, cosine) = kernels(x, low);
    let ([s0, s1], [c0, c1], [n0, n1]) = (sine.lanes(), cosine.lanes(), rounded.lanes());
    let (s0, c0) = in_quadrant(s0, c0, n0.to_bits());
    let (s1, c1) = in_quadrant(s1, c1, n1.to_bits());
    (Pair::new(s0, s1), Pair::new(c0, c1))
}

/// Sine and cosine of `x + low` with `|x| <= pi/4`.
#[inline(always)]
fn kernels(x: Pair, low: Pair) -> (Pair, Pair) {
    let one = Pair::splat(1.0);
    let half = Pair::splat(0.5);
    let z = x * x;
    let v = z * x;
    let [s1, s2, s3, s4, s5, s6] = SIN.map(Pair::splat);
    let r = s2 + z * (s3 + z * (s4 + z * (s5 + z * s6)));
    let sine = x - ((z * (half * low - v * r) - low) - v * s1);
    let [c1, c2, c3, c4, c5, c6] = COS.map(Pair::splat);
    let r = z * (c1 + z * (c2 + z * (c3 + z * (c4 + z * (c5 + z * c6)))));
    let hz = half * z;
    let w = one - hz;
    let cosine = w + (((one - w) - hz) + (z * r - x * low));
    (sine, cosine)
}

/// Sine and cosine of an angle from those of its rest, by the two low bits of the number of quarter turns.
#[inline(always)]
fn in_quadrant(sine: f64, cosine: f64, quarters: u64) -> (f64, f64) {
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
        let (s, c) = sin_cos(Pair::new(x, -x));
        let ([s0, s1], [c0, c1]) = (s.lanes(), c.lanes());
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
        let (s, c) = sin_cos(Pair::splat(0.0));
        assert_eq!((s.lanes(), c.lanes()), ([0.0; 2], [1.0; 2]));
        let (s, _) = sin_cos(Pair::new(f64::NAN, 1e300));
        assert!(s.lanes()[0].is_nan() && s.lanes()[1].abs() <= 1.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn within_one_unit_in_the_last_place(x in prop_oneof![-4.0..4.0, -1e3..1e3, -8e5..8e5]) {
            compare(x);
        }
    }
}
