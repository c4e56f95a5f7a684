//! What a hypothesis is worth: how well it explains the fitted logs, what it asks of the beliefs, and what it has in it.

use super::evidence::{Evidence, counts};
use super::trial::Trial;
use crate::identify::{self, Experiment};
use crate::number::math;

/// Deviance within which hypotheses count as equally good.
pub const EQUAL_DEVIANCE: f64 = 9.0;
/// Charge for having been chosen among the catalogue, in deviance.
pub(in crate::gap) const FOR_THE_CHOICE: f64 = 6.0;

/// The measure that hypotheses of one comparison share.
#[derive(Clone, Copy, Debug)]
pub(in crate::gap) struct Measure {
    /// How many samples count as independent, over all fitted logs.
    pub effective: f64,
}

impl Measure {
    /// By the residuals of the hypothesis that explains most.
    pub fn by(evidence: &Evidence, best: &Trial) -> Self {
        Self::of(&evidence.fit, &best.fit)
    }

    /// By the residuals of the fitted logs.
    pub fn of(experiments: &[Experiment], residuals_rad: &[Vec<f64>]) -> Self {
        let samples: f64 = experiments.iter().map(|e| counts(e).sum::<f64>()).sum();
        Self { effective: (samples / identify::correlation_length(experiments, residuals_rad)).max(2.0) }
    }

    /// Deviance of a hypothesis whose residual variance is unknown, with what its numbers were moved under the beliefs:
    /// differences of it compare hypotheses.
    pub fn deviance(self, evidence: &Evidence, trial: &Trial) -> f64 {
        self.deviance_of(trial.fit_loss(evidence)) + trial.strain()
    }

    /// The same of what a hypothesis leaves, by its counted squares \[rad^2\].
    pub fn deviance_of(self, loss_rad2: f64) -> f64 {
        if loss_rad2.is_finite() { self.effective * math::ln(loss_rad2.max(1e-300)) } else { f64::INFINITY }
    }

    /// What a hypothesis is charged for its effects and their parameters (Schwarz 1978, and the choice).
    pub fn charge(self, trial: &Trial) -> f64 {
        let searched: usize = trial.model.forms().iter().map(|form| form.searched_count()).sum();
        let law = trial.model.law().map_or(0.0, |law| law.charge + FOR_THE_CHOICE);
        let (choices, values) = trial.model.choices_of_logs();
        self.charge_of(searched + values, trial.effects().len() + choices) + law
    }

    /// The same of so many parameters, and so many choices.
    pub fn charge_of(self, searched: usize, chosen: usize) -> f64 {
        searched as f64 * math::ln(self.effective) + chosen as f64 * FOR_THE_CHOICE
    }

    /// Deviance and charge: less is better.
    pub fn score(self, evidence: &Evidence, trial: &Trial) -> f64 {
        self.deviance(evidence, trial) + self.charge(trial)
    }
}

/// Whether a hypothesis has a better score than another, by the residuals of the one that explains more.
pub(in crate::gap) fn is_better(evidence: &Evidence, this: &Trial, than: &Trial) -> bool {
    let measure = Measure::by(evidence, if than.fit_loss(evidence) < this.fit_loss(evidence) { than } else { this });
    measure.score(evidence, this) < measure.score(evidence, than)
}
