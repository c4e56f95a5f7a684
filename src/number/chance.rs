//! Distributions: how probable what is seen is by chance, and which value a probability belongs to.
//!
//! Written on [`math`] so that an interval's bits do not depend on the processor, which those of the crates for this do.
//! Incomplete beta and gamma functions are continued fractions and a series (Press et al. 2007, 6.2 and 6.4), good to
//! about 1e-12 of a probability; a value is found from its probability by Newton's steps kept between bounds.

use std::f64::consts::{PI, SQRT_2};

use super::math;

/// A continued fraction or series ends once a term changes it by less.
const LAST_BIT: f64 = f64::EPSILON;
/// Terms at most; the fractions need about the root of their parameters.
const TERMS: usize = 20_000;
/// Keeps a denominator of a continued fraction from vanishing.
const TINY: f64 = 1e-300;

/// Half of what a normal deviate is within at 95 %, in its standard deviations.
pub(crate) const HALF_95: f64 = 1.96;

/// Standard deviation behind a value's 95 % interval, of which a bound may have cut one side.
pub(crate) fn sd_of(value: f64, [low, high]: [f64; 2]) -> f64 {
    (high - value).max(value - low) / HALF_95
}

/// Probability that a normal deviate is above `z`.
pub(crate) fn normal_tail(z: f64) -> f64 {
    0.5 * libm::erfc(z / SQRT_2)
}

/// Probability that a normal deviate is below `z`.
pub(crate) fn normal_below(z: f64) -> f64 {
    normal_tail(-z)
}

/// The deviate that a normal one is below with the given probability; infinite at 0 and 1.
pub(crate) fn normal_quantile(probability: f64) -> f64 {
    let tail = probability.min(1.0 - probability);
    if !(tail > 0.0) {
        return if probability < 0.5 { f64::NEG_INFINITY } else { f64::INFINITY };
    }
    let mut z = normal_start(tail);
    // Halley's steps: three times the right digits each, from three.
    for _ in 0..2 {
        let step = (normal_tail(z) - tail) * (2.0 * PI).sqrt() * math::exp(0.5 * z * z);
        z += step / (1.0 - 0.5 * z * step);
    }
    if probability < 0.5 { -z } else { z }
}

/// The deviate that is exceeded with a probability of at most a half, within 4.5e-4 (Abramowitz and Stegun 1964, 26.2.23).
fn normal_start(tail: f64) -> f64 {
    let t = (-2.0 * math::ln(tail)).sqrt();
    let above = 2.515_517 + t * (0.802_853 + t * 0.010_328);
    t - above / (1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308)))
}

/// The value that Student's t is below with the given probability, which is above a half; not a number where there are no
/// degrees of freedom.
pub(crate) fn student_quantile(probability: f64, freedom: f64) -> f64 {
    if !(freedom > 0.0) {
        return f64::NAN;
    }
    if freedom.is_infinite() {
        return normal_quantile(probability);
    }
    // Both tails together are the incomplete beta function of this share.
    let share = beta_quantile(2.0 * (1.0 - probability), 0.5 * freedom, 0.5);
    (freedom * (1.0 - share) / share).sqrt()
}

/// Probability that a sum of squares of so many normal deviates is above `x`.
pub(crate) fn chi_squared_tail(x: f64, freedom: f64) -> f64 {
    if !(x > 0.0) {
        return 1.0;
    }
    let (a, x) = (0.5 * freedom, 0.5 * x);
    let scale = math::exp(a * math::ln(x) - x - libm::lgamma(a));
    if x < a + 1.0 { 1.0 - scale * gamma_series(a, x) } else { scale * gamma_fraction(a, x) }
}

/// The lower incomplete gamma function as a series, less its factor.
fn gamma_series(a: f64, x: f64) -> f64 {
    let mut term = 1.0 / a;
    let mut sum = term;
    for k in 1..TERMS {
        term *= x / (a + k as f64);
        sum += term;
        if term < LAST_BIT * sum {
            break;
        }
    }
    sum
}

/// The upper incomplete gamma function as a continued fraction, less its factor.
fn gamma_fraction(a: f64, x: f64) -> f64 {
    let mut b = x + 1.0 - a;
    let mut fraction = Fraction::new(1.0 / TINY, 1.0 / b);
    for k in 1..TERMS {
        let k = k as f64;
        b += 2.0;
        if fraction.next(-k * (k - a), b) {
            break;
        }
    }
    fraction.value
}

/// Probability that a variable with a beta distribution is below `x`: the incomplete beta function.
pub(crate) fn beta_below(x: f64, a: f64, b: f64) -> f64 {
    if !(x > 0.0) {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    let scale = math::exp(log_beta_scale(a, b) + a * math::ln(x) + b * math::ln_1p(-x));
    // The fraction converges fast on this side of the mean only.
    if x < (a + 1.0) / (a + b + 2.0) {
        scale * beta_fraction(x, a, b) / a
    } else {
        1.0 - scale * beta_fraction(1.0 - x, b, a) / b
    }
}

fn log_beta_scale(a: f64, b: f64) -> f64 {
    libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b)
}

fn beta_fraction(x: f64, a: f64, b: f64) -> f64 {
    let mut fraction = Fraction::new(1.0, 1.0 / kept_off_zero(1.0 - (a + b) * x / (a + 1.0)));
    for m in 1..TERMS {
        let m = m as f64;
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        fraction.next(even, 1.0);
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        if fraction.next(odd, 1.0) {
            break;
        }
    }
    fraction.value
}

/// The value that a variable with a beta distribution is below with the given probability.
pub(crate) fn beta_quantile(probability: f64, a: f64, b: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    let mut x = a / (a + b);
    for _ in 0..200 {
        let apart = beta_below(x, a, b) - probability;
        if apart > 0.0 {
            high = x
        } else {
            low = x
        }
        let log_density = log_beta_scale(a, b) + (a - 1.0) * math::ln(x) + (b - 1.0) * math::ln_1p(-x);
        let newton = x - apart / math::exp(log_density);
        let next = if low < newton && newton < high { newton } else { 0.5 * (low + high) };
        if (next - x).abs() <= 2.0 * LAST_BIT * x {
            return next;
        }
        x = next;
    }
    x
}

/// A continued fraction from its front (Lentz 1976).
struct Fraction {
    numerator: f64,
    denominator: f64,
    value: f64,
}

impl Fraction {
    fn new(numerator: f64, value: f64) -> Self {
        Self { numerator, denominator: value, value }
    }

    /// Takes in the next partial numerator and denominator; whether nothing changed any more.
    fn next(&mut self, a: f64, b: f64) -> bool {
        self.denominator = 1.0 / kept_off_zero(b + a * self.denominator);
        self.numerator = kept_off_zero(b + a / self.numerator);
        let change = self.denominator * self.numerator;
        self.value *= change;
        (change - 1.0).abs() <= LAST_BIT
    }
}

fn kept_off_zero(x: f64) -> f64 {
    if x.abs() < TINY { TINY } else { x }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use statrs::distribution::{Beta, ChiSquared, ContinuousCDF, Normal, StudentsT};

    use super::*;

    #[test]
    fn values_are_those_of_printed_tables() {
        // Student's t, two-sided 95 %, as every table prints it; the normal deviate is its limit.
        for (freedom, t) in [(1.0, 12.706), (2.0, 4.303), (10.0, 2.228), (120.0, 1.980)] {
            assert_relative_eq!(student_quantile(0.975, freedom), t, epsilon = 6e-4);
        }
        assert_relative_eq!(normal_quantile(0.975), 1.959_963_984_540_054, max_relative = 1e-14);
        assert_relative_eq!(chi_squared_tail(18.307, 10.0), 0.05, epsilon = 1e-5);
    }

    #[test]
    fn probabilities_agree_with_another_implementation() {
        let gauss = Normal::new(0.0, 1.0).expect("standard");
        for z in [-8.0, -3.1, -0.4, 0.0, 0.01, 1.0, 2.5, 6.0] {
            assert_relative_eq!(normal_below(z), gauss.cdf(z), max_relative = 1e-9);
            assert_relative_eq!(normal_below(z) + normal_tail(z), 1.0, max_relative = 1e-15);
        }
        for freedom in [1.0, 2.5, 7.0, 40.0, 3e3, 1e5] {
            let chi = ChiSquared::new(freedom).expect("positive");
            for share in [0.01, 0.5, 0.97, 1.0, 1.02, 1.5, 3.0] {
                assert_relative_eq!(
                    chi_squared_tail(share * freedom, freedom),
                    chi.sf(share * freedom),
                    epsilon = 1e-9
                );
            }
        }
        for (a, b) in [(0.5, 0.5), (1.0, 9.0), (3.0, 0.5), (20.0, 35.0), (5e3, 0.5), (2.0, 900.0)] {
            let beta = Beta::new(a, b).expect("positive");
            for x in [1e-6, 0.02, 0.3, 0.5, 0.9, 0.9999] {
                assert_relative_eq!(beta_below(x, a, b), beta.cdf(x), epsilon = 1e-9);
            }
        }
    }

    #[test]
    fn a_value_found_from_its_probability_has_that_probability() {
        for p in [1e-9, 1e-4, 0.025, 0.31, 0.5, 0.77, 0.975, 1.0 - 1e-7] {
            assert_relative_eq!(normal_below(normal_quantile(p)), p, max_relative = 1e-13);
            for (a, b) in [(1.0, 9.0), (5.0, 6.0), (250.0, 3.0), (0.5, 0.5), (40.0, 4e3)] {
                assert_relative_eq!(beta_below(beta_quantile(p, a, b), a, b), p, max_relative = 1e-9);
            }
        }
        for freedom in [1.0, 3.0, 11.5, 400.0, 1e4, 1e6] {
            let t = StudentsT::new(0.0, 1.0, freedom).expect("positive");
            assert_relative_eq!(t.cdf(student_quantile(0.975, freedom)), 0.975, epsilon = 1e-9);
        }
    }

    #[test]
    fn ends_are_ends() {
        assert_eq!((normal_quantile(0.0), normal_quantile(1.0)), (f64::NEG_INFINITY, f64::INFINITY));
        assert_eq!((chi_squared_tail(0.0, 3.0), beta_below(0.0, 2.0, 3.0), beta_below(1.0, 2.0, 3.0)), (1.0, 0.0, 1.0));
        assert!(student_quantile(0.975, f64::NAN).is_nan());
        assert_relative_eq!(student_quantile(0.975, f64::INFINITY), normal_quantile(0.975));
    }
}
