//! What the logged torques of position-driven logs say of the drive: how much arrives per torque that its law asks for.
//!
//! Along the measured motion the control law says what it asks for; the log says what there was. Their ratio needs no
//! simulation, and no number of the link.

use crate::identify::{Belief, Experiment, Signal, counts, smooth_along};
use crate::joint::{Motor, Setpoint};
use crate::log::{Derivative, Uncertain};
use crate::number::math;

/// Samples of a log that are looked at, at the most.
const SAMPLES: usize = 2000;
/// Parts of the logs whose ratios say how well it is known.
const PARTS: usize = 8;
/// What the law asks for counts up to this share of its limit.
const UNLIMITED: f64 = 0.95;
/// Fewer samples that count say nothing.
const FEWEST: usize = 40;

/// The belief about the logarithm of the drive's gain that logged torques give; `None` where no log has one.
pub(in crate::gap) fn gain_seen(experiments: &[Experiment], uncertain: &Uncertain) -> Option<Belief> {
    let mut pairs: Vec<[f64; 2]> = experiments.iter().flat_map(pairs).collect();
    if pairs.len() < FEWEST {
        return None;
    }
    let part = pairs.len().div_ceil(PARTS);
    let parts: Vec<f64> = pairs.chunks_mut(part).filter_map(ratio).map(math::ln).collect();
    let mean = parts.iter().sum::<f64>() / parts.len() as f64;
    let spread = parts.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (parts.len() - 1).max(1) as f64;
    let at = math::ln(ratio(&mut pairs)?);
    let sd = math::hypot(uncertain.torque.of("tau"), (spread / parts.len() as f64).sqrt());
    (at.is_finite() && sd > 0.0).then(|| Belief::new(at, sd))
}

/// What the law asks for and what the log says there was, along one log \[N m\].
fn pairs(e: &Experiment) -> Vec<[f64; 2]> {
    let (Some(seen_nm), Some(spec)) = (&e.torque_seen_nm, e.motor) else { return Vec::new() };
    let Signal::Position { setpoint_rad, on, .. } = &e.signal else { return Vec::new() };
    // What an integral holds at the start of a log nobody knows.
    if spec.ki_nm_rad_s != 0.0 {
        return Vec::new();
    }
    let motor = Motor::<f64>::new(spec);
    let motion = smooth_along(&e.t_s, &e.measured_rad);
    let limit_nm = spec.torque_limit_nm.unwrap_or(f64::INFINITY);
    let counted: Vec<f64> = counts(e).collect();
    (e.uncompared.max(1)..e.t_s.len())
        .step_by(e.t_s.len().div_ceil(SAMPLES))
        .filter(|&k| on.as_ref().is_none_or(|on| on[k]) && counted[k - e.uncompared] > 0.0)
        .filter_map(|k| {
            let [angle_rad, rate_rad_s, _] = motion[k];
            let slope = (setpoint_rad[k] - setpoint_rad[k - 1]) / (e.t_s[k] - e.t_s[k - 1]);
            let rate = if spec.derivative == Derivative::Error { slope } else { 0.0 };
            let setpoint = Setpoint { angle_rad: setpoint_rad[k], rate_rad_s: rate };
            let answer = motor.command(setpoint, angle_rad, rate_rad_s, 0.0);
            let asked_nm = motor.unlimited_nm(answer, rate_rad_s);
            let is_free = asked_nm.abs() < UNLIMITED * limit_nm && motor.delivered_nm(answer, rate_rad_s) == asked_nm;
            (is_free && seen_nm[k].is_finite()).then_some([asked_nm, seen_nm[k]])
        })
        .collect()
}

/// The ratio that leaves the least absolute differences: the median of all ratios, each with the weight of what was asked
/// for. Half of the samples may be anything, a saturated torque or a late one.
fn ratio(pairs: &mut [[f64; 2]]) -> Option<f64> {
    pairs.sort_by(|a, b| (a[1] / a[0]).total_cmp(&(b[1] / b[0])));
    let half = 0.5 * pairs.iter().map(|p| p[0].abs()).sum::<f64>();
    let mut sum = 0.0;
    let middle = pairs.iter().find(|p| {
        sum += p[0].abs();
        sum >= half
    })?;
    let ratio = middle[1] / middle[0];
    (ratio.is_finite() && ratio > 0.0).then_some(ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ratio_does_not_see_what_saturates() {
        let mut pairs: Vec<[f64; 2]> = (0..200)
            .map(|k| {
                let asked = 2.0 * (0.1 * k as f64).sin() + 1e-3;
                [asked, (1.3 * asked).clamp(-2.4, 2.4) + 0.01 * (k as f64).cos()]
            })
            .collect();
        assert!((ratio(&mut pairs).unwrap() - 1.3).abs() < 0.02);
        assert_eq!(ratio(&mut []), None);
    }
}
