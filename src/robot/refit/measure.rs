//! What residuals say of themselves.

use crate::fit::correlation_length;
use crate::number::math;

/// Residuals that count, correlated ones together.
pub(super) fn counted(residuals: &[Vec<f64>]) -> f64 {
    residuals.iter().map(|r| r.len() as f64 / correlation_length(r)).sum()
}

/// Schwarz's criterion of residuals that a fit with so many searched numbers left.
pub(super) fn information(residuals: &[Vec<f64>], searched: usize, counted: f64) -> f64 {
    counted * math::ln(squares(residuals).max(f64::MIN_POSITIVE)) + searched as f64 * math::ln(counted)
}

/// Their sum.
pub(super) fn squares(residuals: &[Vec<f64>]) -> f64 {
    residuals.iter().flatten().map(|r| r * r).sum()
}

/// Standard deviation of their noise: of white noise second differences have six times its variance, of a smooth misfit hardly any.
pub(super) fn noise(residuals: &[Vec<f64>]) -> f64 {
    let squares: Vec<f64> =
        residuals.iter().flat_map(|r| r.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).powi(2))).collect();
    (squares.iter().sum::<f64>() / (6 * squares.len().max(1)) as f64).sqrt()
}

/// Of no values 0.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}
