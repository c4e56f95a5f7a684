//! The sensor's own noise, from the roughness of what models leave.

use super::evidence::Evidence;
use super::trial::Trial;
use crate::identify::Experiment;

/// Samples over which roughness is averaged to one value.
const BLOCK: usize = 24;
/// Steps that the joint moves in a block that counts: where it moves less, successive rounding errors are alike and do
/// not show in differences.
const TRAVEL: f64 = 6.0;
/// One in so many blocks is set aside at either end.
const TRIMMED: usize = 8;

/// Standard deviation of the noise of the readings, pooled over all logs \[rad\].
///
/// Second differences of white noise have six times its variance, and a smooth misfit has hardly any. Each log is
/// judged by the model that leaves it the least rough; blocks in which the joint hardly moves are passed over, and the
/// extreme ones are set aside. Never below a step's rounding.
pub(in crate::gap) fn noise_rad(evidence: &Evidence, trials: &[&Trial]) -> f64 {
    noise_of(&logs(evidence), &each(trials), evidence.reach.resolution_rad)
}

/// The same of what models leave of each log, read in such steps \[rad\].
pub(in crate::gap) fn noise_of(logs: &[&Experiment], models: &[Vec<&[f64]>], step_rad: f64) -> f64 {
    let mut roughness = roughness(logs, models);
    let rounding = step_rad / 12f64.sqrt();
    if roughness.is_empty() {
        return rounding.max(1e-6);
    }
    roughness.sort_by(f64::total_cmp);
    let aside = roughness.len() / TRIMMED;
    root_mean(&roughness[aside..roughness.len() - aside]).max(rounding).max(1e-9)
}

/// Standard deviation of the part of a hypothesis' residuals that has no shape \[rad\]: as above with nothing set aside.
/// Zero where the joint hardly moves.
pub(in crate::gap) fn rough_rad(evidence: &Evidence, trial: &Trial) -> f64 {
    root_mean(&roughness(&logs(evidence), &each(&[trial])))
}

fn logs(evidence: &Evidence) -> Vec<&Experiment> {
    evidence.fit.iter().chain(&evidence.held).collect()
}

/// What each hypothesis leaves of each log; held-out ones stand last, where they were predicted.
fn each<'a>(trials: &[&'a Trial]) -> Vec<Vec<&'a [f64]>> {
    trials.iter().map(|t| t.fit.iter().chain(&t.held).map(Vec::as_slice).collect()).collect()
}

fn root_mean(squares: &[f64]) -> f64 {
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

/// Variances by second differences of the blocks in which the joint moves; each log by the model that leaves it the
/// least rough.
fn roughness(logs: &[&Experiment], models: &[Vec<&[f64]>]) -> Vec<f64> {
    let mut roughness: Vec<f64> = Vec::new();
    for (k, e) in logs.iter().enumerate() {
        let readings = &e.measured_rad[e.uncompared..];
        let of = |left: &Vec<&[f64]>| -> Vec<f64> {
            let Some(r) = left.get(k) else { return Vec::new() };
            let model = |i: usize| r[i] + readings[i];
            let travel = |from: usize| {
                let range = (from..from + BLOCK).map(model);
                let [low, high] = crate::number::extent(range);
                high - low
            };
            (0..(r.len() / BLOCK) * BLOCK)
                .step_by(BLOCK)
                .filter(|&from| travel(from) >= TRAVEL * e.resolution_rad)
                .map(|from| {
                    let second = r[from..from + BLOCK].windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).powi(2));
                    second.sum::<f64>() / (6.0 * (BLOCK - 2) as f64)
                })
                .collect()
        };
        let least = models.iter().map(of).min_by(|a, b| a.iter().sum::<f64>().total_cmp(&b.iter().sum::<f64>()));
        roughness.extend(least.unwrap_or_default().into_iter().filter(|x| x.is_finite()));
    }
    roughness
}
