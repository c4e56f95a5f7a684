//! Before any diagnosis: what the logs of a study can tell about its joint, and what they cannot.

use super::diagnose::GapError;
use super::diagnosis::Detectable;
use super::hypothesis::calibrate::calibrate;
use super::hypothesis::compare::correlation_length;
use super::hypothesis::evidence::Evidence;
use super::hypothesis::floor::noise_rad;
use super::hypothesis::trial::Trial;
use super::verdict::detect::detectable;
use super::verdict::doubts::Simulated;
use super::verdict::numbers::numbers;
use crate::fit::Budget;
use crate::identify::{BeliefFound, Case, Estimate};
use crate::joint::EffectId;

/// Evaluations of the fit that carries the recalibrated joint over to all samples.
const CARRIED: Budget = Budget { evaluations: 24 };

/// What the logs of a joint can and cannot tell, before any effect is added.
#[derive(Clone, Debug)]
pub struct Checkup {
    /// RMS over the fitted logs with the study's values as given \[rad\].
    pub given_rad: f64,
    /// The same with the numbers refitted within their beliefs \[rad\].
    pub calibrated_rad: f64,
    /// The sensor's own noise \[rad\].
    pub floor_rad: f64,
    /// The numbers as refitted, with intervals that logs and beliefs together leave.
    pub parameters: Vec<Estimate>,
    /// The numbers that are not exact.
    pub beliefs: Vec<BeliefFound>,
    /// What the logs cannot determine and what would, in sentences.
    pub undetermined: Vec<String>,
    /// The smallest size of each effect of the catalogue that they would show.
    pub detectable: Vec<Detectable>,
    /// What is to be questioned of the study, beside what [`Case::doubts`] says, in sentences.
    pub doubts: Vec<String>,
}

/// Looks at what the logs of a joint study can tell, in seconds: the joint as given and recalibrated, no effect tried.
///
/// ```
/// use aibo_fit::gap::check;
/// use aibo_fit::identify::Case;
///
/// let checkup = check(&Case::of_study("data/examples/delay/study.toml".as_ref())?)?;
/// assert!(checkup.detectable.iter().any(|effect| effect.value.is_some()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`GapError`] where there is nothing to look at.
pub fn check(case: &Case) -> Result<Checkup, GapError> {
    let nominal = case.joint.nominal.ok_or(GapError::NoNominal)?;
    let evidence = Evidence::of(case, nominal).ok_or(GapError::NeverMoved)?;
    let (coarse, baseline) = (evidence.coarse(), evidence.baseline());
    let given = Trial::as_given(&coarse, &baseline);
    let calibrated = calibrate(&coarse, &baseline, &given);
    let (given, calibrated) =
        (given.carried(&coarse, &evidence, CARRIED), calibrated.carried(&coarse, &evidence, CARRIED));
    if !calibrated.criterion().is_finite() {
        return Err(GapError::Diverged { joint: case.joint.name.clone() });
    }
    let floor_rad = noise_rad(&evidence, &[&given, &calibrated]);
    let [given_rad, calibrated_rad] = [&given, &calibrated].map(|trial| trial.fit_rms_rad(&evidence));
    let (parameters, _) = numbers(&evidence, &calibrated);
    let (beliefs, undetermined) = (calibrated.beliefs(), calibrated.undetermined(&evidence));
    let noise = (floor_rad, correlation_length(&evidence, &calibrated));
    let detectable = detectable(&evidence, noise, &calibrated, EffectId::ALL);
    let deadline = &evidence.deadline;
    let doubts = Simulated { causes: &[], beliefs: &beliefs, given_rad, floor_rad, deadline }.doubts(case);
    Ok(Checkup { given_rad, calibrated_rad, floor_rad, parameters, beliefs, undetermined, detectable, doubts })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_friction_at_rest_that_would_show_is_more_than_that_of_motion_and_the_least_gain_is_a_gain() {
        let case = Case::of_study("data/examples/delay/study.toml".as_ref()).unwrap();
        let found = check(&case).unwrap();
        let shows = |effect| found.detectable.iter().find(|d| d.effect == effect).unwrap().value;
        let coulomb_nm = found.parameters.iter().find(|p| p.name == "coulomb").unwrap().value;
        assert!(shows(EffectId::Stribeck).is_some_and(|nm| nm > coulomb_nm), "{:?}", shows(EffectId::Stribeck));
        assert!(shows(EffectId::MotorGain).is_some_and(|c| c > 1.0), "{:?}", shows(EffectId::MotorGain));
    }
}
