//! A low pass without delay: Butterworth's third order, forward and back.

use crate::number::math;
use std::f64::consts::PI;

/// Seconds times the cutoff frequency over which a start is forgotten.
const SETTLED: f64 = 2.5;

/// The filter for samples of one period.
#[derive(Clone, Copy, Debug)]
pub(super) struct LowPass {
    /// `1 / (s + 1)`: gain of both samples, feedback.
    first: [f64; 2],
    /// `1 / (s^2 + s + 1)`: gain of the newest sample, feedbacks.
    second: [f64; 3],
    /// Samples over which a start is forgotten.
    settling: usize,
}

impl LowPass {
    /// By the bilinear transform, bent so that the cutoff frequency stays where it is.
    pub fn new(cutoff_hz: f64, period_s: f64) -> Self {
        let k = math::tan(PI * cutoff_hz * period_s);
        let norm = 1.0 / (1.0 + k + k * k);
        Self {
            first: [k / (1.0 + k), (k - 1.0) / (k + 1.0)],
            second: [k * k * norm, 2.0 * (k * k - 1.0) * norm, (1.0 - k + k * k) * norm],
            settling: (SETTLED / (cutoff_hz * period_s)).ceil() as usize,
        }
    }

    /// Samples at either end that know more of the end than of the signal.
    pub fn settling(&self) -> usize {
        self.settling
    }

    /// Filtered forward and back, beyond its ends turned about them.
    pub fn both_ways(&self, signal: &[f64]) -> Vec<f64> {
        let n = signal.len();
        let (Some(&start), Some(&end)) = (signal.first(), signal.last()) else { return Vec::new() };
        let pad = self.settling.min(n - 1);
        let before = (1..=pad).rev().map(|k| 2.0 * start - signal[k]);
        let behind = (1..=pad).map(|k| 2.0 * end - signal[n - 1 - k]);
        let mut padded: Vec<f64> = before.chain(signal.iter().copied()).chain(behind).collect();
        for _ in 0..2 {
            self.forward(&mut padded);
            padded.reverse();
        }
        padded[pad..pad + n].to_vec()
    }

    /// Filtered in place, as if the first value had stood for ever.
    fn forward(&self, signal: &mut [f64]) {
        let Some(&start) = signal.first() else { return };
        let [b, a] = self.first;
        let [c, a1, a2] = self.second;
        let mut kept = (1.0 - b) * start;
        let (mut near, mut far) = ((1.0 - c) * start, (c - a2) * start);
        for x in signal {
            let y = b * *x + kept;
            kept = b * *x - a * y;
            let z = c * y + near;
            near = 2.0 * c * y - a1 * z + far;
            far = c * y - a2 * z;
            *x = z;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Amplitude of what passes of a sine, and whether it is late.
    fn passed(frequency_hz: f64) -> [f64; 2] {
        let (period_s, n) = (0.002, 5000);
        let at = |k: usize| 2.0 * PI * frequency_hz * period_s * k as f64;
        let sine: Vec<f64> = (0..n).map(|k| at(k).sin()).collect();
        let out = LowPass::new(5.0, period_s).both_ways(&sine);
        let inner = 1000..n - 1000;
        let sum =
            |of: fn(f64) -> f64| inner.clone().map(|k| out[k] * of(at(k))).sum::<f64>() / (0.5 * inner.len() as f64);
        [sum(f64::sin), sum(f64::cos)]
    }

    #[test]
    fn half_passes_at_the_cutoff_all_below_and_nothing_above_and_none_is_late() {
        for (frequency_hz, expected) in [(0.5, 1.0), (5.0, 0.5), (25.0, 6.4e-5)] {
            let [through, late] = passed(frequency_hz);
            assert!((through - expected).abs() < 0.01 * expected.max(1e-3) && late.abs() < 1e-3, "{through} {late}");
        }
    }

    #[test]
    fn a_constant_and_a_line_stay_as_they_are_to_their_ends() {
        let line: Vec<f64> = (0..400).map(|k| 3.0 - 0.01 * f64::from(k)).collect();
        let out = LowPass::new(5.0, 0.004).both_ways(&line);
        assert!(out.iter().zip(&line).all(|(a, b)| (a - b).abs() < 1e-3), "{:?}", &out[..3]);
        assert!(LowPass::new(5.0, 0.004).both_ways(&[2.0]).iter().all(|x| (x - 2.0).abs() < 1e-12));
    }
}
