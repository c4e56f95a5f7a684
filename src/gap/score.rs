//! What a hypothesis is worth: how well it explains the fitted logs, what it asks of the beliefs, and what it has in it.

use super::compare::correlation_length;
use super::evidence::{Evidence, counts};
use super::trial::Trial;
use crate::number::math;

/// Charge for having been chosen among the catalogue, in deviance.
pub(super) const FOR_THE_CHOICE: f64 = 6.0;

/// The measure that hypotheses of one comparison share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measure {
    /// How many samples count as independent, over all fitted logs.
    pub effective: f64,
}

impl Measure {
    /// By the residuals of the hypothesis that explains most.
    pub fn by(evidence: &Evidence, best: &Trial) -> Self {
        let samples: f64 = evidence.fit.iter().map(|e| counts(e).sum::<f64>()).sum();
        Self { effective: (samples / correlation_length(evidence, best)).max(2.0) }
    }

    /// Deviance of a hypothesis whose residual variance is unknown, with what its numbers were moved under the beliefs:
    /// differences of it compare hypotheses.
    pub fn deviance(self, evidence: &Evidence, trial: &Trial) -> f64 {
        let loss = trial.fit_loss(evidence);
        if loss.is_finite() { self.effective * math::ln(loss.max(1e-300)) + trial.strain() } else { f64::INFINITY }
    }

    /// What a hypothesis is charged for its effects and their parameters (Schwarz 1978, and the choice).
    pub fn charge(self, trial: &Trial) -> f64 {
        let searched: usize = trial.model.forms().iter().map(|form| form.searched_count()).sum();
        let law = trial.model.law().map_or(0.0, |law| law.charge + FOR_THE_CHOICE);
        let (choices, values) = trial.model.choices_of_logs();
        let (searched, chosen) = (searched + values, trial.effects().len() + choices);
        searched as f64 * math::ln(self.effective) + chosen as f64 * FOR_THE_CHOICE + law
    }

    /// Deviance and charge: less is better.
    pub fn score(self, evidence: &Evidence, trial: &Trial) -> f64 {
        self.deviance(evidence, trial) + self.charge(trial)
    }
}
