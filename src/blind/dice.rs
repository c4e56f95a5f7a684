//! Chance, from one seed.

use crate::number::math;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Draws of a trial: the same seed and stream, the same draws on any machine.
pub(super) struct Dice(ChaCha8Rng);

impl Dice {
    /// Stream `stream` of `seed`.
    pub(super) fn new(seed: u64, stream: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        Self(rng)
    }

    /// Uniform between two values.
    pub(super) fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// Uniform in the logarithm; both values above zero.
    pub(super) fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        math::exp(self.uniform(math::ln(low), math::ln(high)))
    }

    /// Normal, of mean 0 and standard deviation 1.
    pub(super) fn normal(&mut self) -> f64 {
        // Box and Muller; the logarithm's argument is never zero
        let (radius, angle) = (1.0 - self.0.random::<f64>(), self.uniform(0.0, std::f64::consts::TAU));
        (-2.0 * math::ln(radius)).sqrt() * math::cos(angle)
    }

    /// True with a probability.
    pub(super) fn chance(&mut self, probability: f64) -> bool {
        self.0.random::<f64>() < probability
    }

    /// `1` or `-1`.
    pub(super) fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// A whole number from `low` to `high`, both included.
    pub(super) fn whole(&mut self, low: usize, high: usize) -> usize {
        self.0.random_range(low..=high)
    }

    /// One of several; the list has at least one entry.
    pub(super) fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.whole(0, list.len() - 1)]
    }

    /// `count` different indices below `of`, in random order.
    pub(super) fn some_of(&mut self, count: usize, of: usize) -> Vec<usize> {
        let mut all: Vec<usize> = (0..of).collect();
        for i in 0..count.min(of) {
            let j = self.whole(i, of - 1);
            all.swap(i, j);
        }
        all.truncate(count);
        all
    }

    /// A seed for draws that belong together and must not depend on how often they are repeated.
    pub(super) fn seed(&mut self) -> u64 {
        self.0.random()
    }
}

/// A value with so many significant digits, as an engineer writes it down.
pub(super) fn significant(value: f64, digits: i32) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let shift = digits - 1 - math::log10(value.abs()).floor() as i32;
    // through the decimal text, so that it is the nearest double to what is written
    if shift >= 0 {
        format!("{value:.*}", shift as usize).parse().unwrap_or(value)
    } else {
        let unit = 10f64.powi(-shift);
        (value / unit).round() * unit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_kept_and_cut() {
        assert_eq!(significant(0.012345678, 4), 0.01235);
        assert_eq!(significant(-123.456, 4), -123.5);
        assert_eq!(significant(123456.0, 2), 120000.0);
        assert_eq!(significant(0.0, 4), 0.0);
    }

    #[test]
    fn same_seed_same_draws_and_streams_differ() {
        let draw = |seed, stream| Dice::new(seed, stream).uniform(0.0, 1.0);
        assert_eq!(draw(1, 2), draw(1, 2));
        assert_ne!(draw(1, 2), draw(1, 3));
        let mut some = Dice::new(1, 1).some_of(3, 5);
        some.sort_unstable();
        some.dedup();
        assert_eq!(some.len(), 3);
    }
}
