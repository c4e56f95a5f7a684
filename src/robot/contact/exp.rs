//! Exponential and hyperbolic tangent whose bits do not depend on the machine.
//!
//! The standard library's come from the system, which picks variants with fused operations where the processor has them;
//! a walk is chaotic enough to show that. The exponential is fdlibm's (Sun Microsystems 1993), within one unit in the last
//! place; the tangent is its series near zero and made of the exponential elsewhere.

const LN2_HIGH: f64 = 6.931_471_803_691_238e-1;
const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;
const P: [f64; 5] = [
    1.666_666_666_666_660_2e-1,
    -2.777_777_777_701_559_3e-3,
    6.613_756_321_437_934e-5,
    -1.653_390_220_546_525_2e-6,
    4.138_136_797_057_238_5e-8,
];
/// Beyond these the exponential is no normal number, and is not needed.
const MOST: f64 = 700.0;
/// Coefficients of `tanh(x) / x` by powers of `x^2`.
const SERIES: [f64; 9] = [
    1.0,
    -1.0 / 3.0,
    2.0 / 15.0,
    -17.0 / 315.0,
    62.0 / 2835.0,
    -1382.0 / 155_925.0,
    21_844.0 / 6_081_075.0,
    -929_569.0 / 638_512_875.0,
    6_404_582.0 / 10_854_718_875.0,
];
/// Up to here nine terms are exact to rounding.
const NEAR: f64 = 0.125;

/// `e^x`; 0 below -700, infinite above 700.
pub(super) fn exp(x: f64) -> f64 {
    if x.is_nan() {
        return x;
    }
    if x.abs() > MOST {
        return if x < 0.0 { 0.0 } else { f64::INFINITY };
    }
    let turns = (x * std::f64::consts::LOG2_E).round();
    let (high, low) = (x - turns * LN2_HIGH, turns * LN2_LOW);
    let r = high - low;
    let t = r * r;
    let c = r - t * (P[0] + t * (P[1] + t * (P[2] + t * (P[3] + t * P[4]))));
    let y = 1.0 - ((low - r * c / (2.0 - c)) - high);
    y * f64::from_bits(((1023 + turns as i64) as u64) << 52)
}

/// Hyperbolic tangent.
pub(super) fn tanh(x: f64) -> f64 {
    let size = x.abs();
    if size < NEAR {
        let square = x * x;
        return x * SERIES.iter().rev().fold(0.0, |sum, coefficient| sum * square + coefficient);
    }
    if size > 20.0 {
        return x.signum();
    }
    (1.0 - 2.0 / (exp(2.0 * size) + 1.0)) * x.signum()
}

#[cfg(test)]
mod tests {
    use super::{exp, tanh};
    use proptest::prelude::*;

    #[test]
    fn ends() {
        assert_eq!((exp(0.0), exp(-1e9), exp(1e9), tanh(0.0)), (1.0, 0.0, f64::INFINITY, 0.0));
        assert_eq!((tanh(1e300), tanh(-1e300)), (1.0, -1.0));
        assert!(exp(f64::NAN).is_nan() && tanh(f64::NAN).is_nan());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn as_the_systems(x in prop_oneof![-30.0..30.0, -0.2..0.2, -699.0..1.0, -1e-6..1e-6]) {
            approx::assert_relative_eq!(exp(x), x.exp(), max_relative = 5e-16, epsilon = 0.0);
            approx::assert_relative_eq!(tanh(x), x.tanh(), max_relative = 2e-15, epsilon = 0.0);
        }
    }
}
