//! The unit in which beliefs weigh against readings: the residuals' own variance, and how long they hang together.

use super::Experiment;

/// What a model lacks comes back with every stroke; it is not noise that hangs together for longer than this \[s\].
const LONGEST_S: f64 = 0.06;

/// How much each compared sample counts: about 1, and less in phases of one repeated reading.
pub(crate) fn counts(e: &Experiment) -> impl Iterator<Item = f64> + '_ {
    // The heaviest weights are those of the plain samples.
    let period = e.weights_s.iter().copied().fold(0.0, f64::max).min(mean_period(e) * 1.5).max(1e-12);
    e.weights_s.iter().map(move |w| (w / period).min(1.0))
}

fn mean_period(e: &Experiment) -> f64 {
    (e.t_s[e.t_s.len() - 1] - e.t_s[e.uncompared]) / (e.compared() - 1).max(1) as f64
}

/// How many successive residuals count as one, over all experiments; each sample by how much it counts.
pub(crate) fn correlation_length(experiments: &[Experiment], residuals_rad: &[Vec<f64>]) -> f64 {
    let (mut sum, mut n) = (0.0, 0.0);
    for (e, r) in experiments.iter().zip(residuals_rad) {
        let counted: Vec<f64> = counts(e).zip(r).map(|(c, r)| c.sqrt() * r).collect();
        let samples = r.len() as f64;
        let period_s = (e.t_s[e.t_s.len() - 1] - e.t_s[0]) / (e.t_s.len() - 1).max(1) as f64;
        sum += samples * crate::fit::correlation_length(&counted).min((LONGEST_S / period_s).max(1.0));
        n += samples;
    }
    if n > 0.0 { (sum / n).max(1.0) } else { 1.0 }
}

/// What one unit of deviance weighs in the criterion (3.7) \[rad^2 s\], by the size of the compared samples' residuals and
/// how long they hang together, and never below the encoder's rounding.
pub(crate) fn unit_rad2_s(experiments: &[Experiment], residuals_rad: &[Vec<f64>]) -> f64 {
    let (mut sum, mut samples) = (0.0, 0.0);
    for (e, r) in experiments.iter().zip(residuals_rad) {
        sum += e.weights_s.iter().zip(r).map(|(w, r)| w * r * r).sum::<f64>();
        samples += counts(e).sum::<f64>();
    }
    let rounding: f64 = experiments.iter().map(Experiment::rounding_rad2_s).sum();
    let unit = sum.max(rounding).max(1e-18) * correlation_length(experiments, residuals_rad) / samples.max(1.0);
    if unit.is_finite() { unit } else { 0.0 }
}
