//! How rough readings are, and how large what is left of them.

/// Nobody reads angles better than this \[rad\].
pub(super) const LEAST_NOISE_RAD: f64 = 1e-4;

/// The mean of squares.
pub(super) fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64
}
