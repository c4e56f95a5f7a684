//! Blocks of samples that are long enough to count as independent.

use super::log_part::LogPart;
use crate::gap::diagnosis::Phase;
use crate::number::math;

/// A block is this many correlation times long.
const TIMES: f64 = 3.0;
/// Fewest samples in a block.
const FEWEST: f64 = 5.0;

/// Length of a log's blocks, and the correlation time of its residual torque \[s\].
#[derive(Clone, Copy, Debug)]
pub(in crate::gap) struct Blocks {
    pub correlation_s: f64,
    pub length_s: f64,
}

impl Blocks {
    /// From the residual torque in units of its uncertainty: the time after which its autocorrelation is below 1/e.
    pub(in crate::gap) fn of(part: &LogPart) -> Self {
        let n = part.len();
        let period_s = part.weights_s.iter().sum::<f64>() / part.weights_s.len().max(1) as f64;
        let r = &part.torque;
        let in_sigmas = |k: usize| if is_moving(part, k) { r.torque_nm[k] / r.sigma_nm[k] } else { 0.0 };
        let z: Vec<f64> = (0..n).map(in_sigmas).map(|z| if z.is_finite() { z } else { 0.0 }).collect();
        let variance: f64 = z.iter().map(|z| z * z).sum();
        let below = |lag: &usize| {
            let product: f64 = z.iter().zip(&z[*lag..]).map(|(a, b)| a * b).sum();
            !(product > variance * math::exp(-1.0f64))
        };
        let lag = (1..n / 3).find(below).unwrap_or(n / 3).max(1);
        let correlation_s = lag as f64 * period_s;
        Self { correlation_s, length_s: (TIMES * correlation_s).max(FEWEST * period_s) }
    }
}

/// Whether a sample has a residual torque that is an estimate, not a bound.
pub(in crate::gap) fn is_moving(part: &LogPart, k: usize) -> bool {
    part.torque.torque_nm[k].is_finite() && !matches!(part.torque.phase[k], Phase::Hold | Phase::Stick)
}
