//! Weights of the thesis's integral (3.7) on samples that need not be uniform.

use std::ops::Range;

/// Trapezoidal weights \[s\]: half the time to either neighbour, so that `sum(w e^2)` is the integral (3.7).
pub(super) fn trapezoid(t_s: &[f64]) -> Vec<f64> {
    let n = t_s.len();
    (0..n)
        .map(|i| {
            let before = if i > 0 { t_s[i] - t_s[i - 1] } else { 0.0 };
            let after = if i + 1 < n { t_s[i + 1] - t_s[i] } else { 0.0 };
            0.5 * (before + after)
        })
        .collect()
}

/// Phases of at least `shortest` samples in which the encoder repeats one rounding error.
///
/// A joint at rest under a silent encoder reads one value: one rounding error, not many. Noise that is added after
/// rounding does not help: the reading flickers evenly about one step, and says no more about the angle. Noise before
/// rounding does: the reading divides its time between two steps in proportion to where the angle lies, and its mean
/// is as good as its number of samples; such a phase is not listed.
pub(super) fn repeated_roundings(readings: &[f64], step: f64, shortest: usize) -> Vec<Range<usize>> {
    let mut phases = Vec::new();
    let mut from = 0;
    while from < readings.len() {
        let (mut low, mut high) = (readings[from], readings[from]);
        let mut to = from + 1;
        while to < readings.len() {
            let (l, h) = (low.min(readings[to]), high.max(readings[to]));
            if h - l > 2.5 * step {
                break;
            }
            (low, high) = (l, h);
            to += 1;
        }
        if to - from >= shortest && is_one_rounding(&readings[from..to], low, high, step) {
            phases.push(from..to);
            from = to;
        } else {
            // A phase may begin at any sample; identical readings need no second look.
            let first = readings[from];
            let same = readings[from..to].iter().take_while(|r| **r == first).count();
            if same >= shortest {
                phases.push(from..from + same);
            }
            from += same;
        }
    }
    phases
}

/// Samples from which on a flicker about one step is taken for rest.
const SHORTEST_FLICKER: usize = 40;

/// One value throughout, or a flicker of one step either way that favours neither side.
fn is_one_rounding(readings: &[f64], low: f64, high: f64, step: f64) -> bool {
    if low == high {
        return true;
    }
    if high - low < 1.5 * step {
        return false;
    }
    let middle = 0.5 * (low + high);
    let above = readings.iter().filter(|r| **r > middle + 0.5 * step).count() as f64;
    let below = readings.iter().filter(|r| **r < middle - 0.5 * step).count() as f64;
    let changes = readings.windows(2).filter(|w| w[0] != w[1]).count();
    // A joint that creeps through three steps changes its reading twice, a flicker at every other sample; a slow
    // turning point is over before it could pass for rest.
    let flickers = changes * 4 > readings.len() && readings.len() >= SHORTEST_FLICKER;
    flickers && (above - below).abs() <= 2.0 * (above + below).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn weights_integrate_a_straight_line_exactly_on_uneven_samples() {
        let t = [0.0, 0.1, 0.15, 0.4, 1.0];
        let integral: f64 = trapezoid(&t).iter().zip(&t).map(|(w, t)| w * (3.0 * t + 1.0)).sum();
        assert_relative_eq!(integral, 2.5, epsilon = 1e-15);
    }

    #[test]
    fn identical_readings_are_one_rounding() {
        assert_eq!(repeated_roundings(&[1.0, 1.0, 2.0, 9.0, 9.0, 9.0], 1.0, 2), vec![0..2, 3..6]);
        assert!(repeated_roundings(&[], 1.0, 2).is_empty());
    }

    #[test]
    fn an_even_flicker_is_one_rounding_and_a_dithered_angle_or_a_creeping_joint_is_not() {
        let flicker: Vec<f64> = (0..60).map(|i| f64::from((i * 7 % 3) - 1)).collect();
        assert_eq!(repeated_roundings(&flicker, 1.0, 12), vec![0..60]);
        let dithered: Vec<f64> = (0..60).map(|i| f64::from(i32::from(i * 7 % 10 < 3))).collect();
        assert!(repeated_roundings(&dithered, 1.0, 12).is_empty());
        let creeping: Vec<f64> = (0..30).map(|i| f64::from(i / 10)).collect();
        assert!(repeated_roundings(&creeping, 1.0, 12).is_empty());
    }
}
