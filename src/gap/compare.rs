//! Which of two hypotheses explains the logs better, with residuals that are not independent.
//!
//! The unit is the difference of squared residuals, sample by sample (Vuong 1989). Its spread is taken from blocks that
//! are longer than the residuals remember, so that a misfit which comes back in every half swing counts once.

use super::evidence::{Evidence, counts};
use super::trial::Trial;

/// Time over which differences are summed to one draw \[s\].
const BLOCK_S: f64 = 0.25;

/// A difference of two losses with its spread.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Difference {
    /// Loss of the first less loss of the second \[rad^2\].
    pub sum: f64,
    /// Standard deviation of that \[rad^2\].
    pub sd: f64,
}

impl Difference {
    /// How many standard deviations the first is worse.
    pub fn z(&self) -> f64 {
        if self.sd > 0.0 { self.sum / self.sd } else { 0.0 }
    }
}

/// Loss of `a` less loss of `b` over the fitted logs, the held-out ones, or both.
pub(super) fn difference(evidence: &Evidence, a: &Trial, b: &Trial, fitted: bool, held: bool) -> Difference {
    let none = Vec::new();
    let fit = if fitted { (&evidence.fit, &a.fit, &b.fit) } else { (&none, &a.fit, &b.fit) };
    let held = if held { (&evidence.held, &a.held, &b.held) } else { (&none, &a.held, &b.held) };
    let mut blocks: Vec<f64> = Vec::new();
    for (experiments, a, b) in [fit, held] {
        for ((e, a), b) in experiments.iter().zip(a).zip(b) {
            let t = &e.t_s[e.uncompared..];
            let (mut from, mut sum) = (t[0], 0.0);
            for (((c, ra), rb), t) in counts(e).zip(a).zip(b).zip(t) {
                if t - from > BLOCK_S {
                    blocks.push(std::mem::take(&mut sum));
                    from = *t;
                }
                sum += c * (ra * ra - rb * rb);
            }
            blocks.push(sum);
        }
    }
    let n = blocks.len() as f64;
    let sum: f64 = blocks.iter().sum();
    let spread: f64 = blocks.iter().map(|b| (b - sum / n).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    Difference { sum, sd: (n * spread).sqrt() }
}

/// How many successive residuals count as one, over all fitted logs of a trial; each sample by how much it counts.
pub(super) fn correlation_length(evidence: &Evidence, trial: &Trial) -> f64 {
    let (mut sum, mut n) = (0.0, 0.0);
    for (e, r) in evidence.fit.iter().zip(&trial.fit) {
        let counted: Vec<f64> = counts(e).zip(r).map(|(c, r)| c.sqrt() * r).collect();
        let samples = r.len() as f64;
        sum += samples * crate::fit::correlation_length(&counted);
        n += samples;
    }
    if n > 0.0 { (sum / n).max(1.0) } else { 1.0 }
}
