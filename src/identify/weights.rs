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

/// Runs of at least `shortest` identical readings.
pub(super) fn runs_of_one_reading(readings: &[f64], shortest: usize) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let mut from = 0;
    for i in 1..=readings.len() {
        if i == readings.len() || readings[i] != readings[from] {
            if i - from >= shortest {
                runs.push(from..i);
            }
            from = i;
        }
    }
    runs
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
    fn runs_are_found_to_the_end() {
        assert_eq!(runs_of_one_reading(&[1.0, 1.0, 2.0, 3.0, 3.0, 3.0], 2), vec![0..2, 3..6]);
        assert!(runs_of_one_reading(&[], 2).is_empty());
    }
}
