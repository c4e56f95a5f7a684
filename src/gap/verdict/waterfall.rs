//! From as given to the floor: what recalibration closes, and then each cause.

use super::decide::{Decision, equivalent_of};
use crate::gap::diagnosis::{CauseShare, Number};
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::held_out::HeldOut;
use crate::gap::hypothesis::trial::Trial;
use crate::gap::search::attribute::Attribution;
use crate::joint::EffectId;

/// The causes of an answer with their shares, from the RMS with the numbers recalibrated down to the floor \[rad\].
pub(in crate::gap) fn causes(
    evidence: &Evidence,
    held: &HeldOut,
    a: &Attribution,
    decision: &Decision<'_>,
    parameters: &[(EffectId, Vec<Number>)],
) -> Vec<CauseShare> {
    let answer = decision.answer;
    let rms = |t: &Trial| held.rms_rad(&held.residuals(evidence, t));
    let calibrated = rms(&a.calibrated);
    let left = calibrated - a.noise_rad;
    let share = |from: f64, to: f64| (left > 0.0).then(|| ((from - to) / left).min(1.0));
    // A law comes behind the causes.
    let after_all = if answer.model.law().is_some() { rms(&a.best) } else { rms(answer) };
    // Where another effect stands for a single one, the hypotheses about the set are not about it.
    let as_found = answer.effects() == a.best.effects();
    (0..answer.effects().len())
        .map(|k| {
            let effect = answer.effects()[k];
            let alone = if as_found { a.alone.get(k).map(rms) } else { Some(after_all) };
            let without = if as_found { a.without.get(k).map(rms) } else { Some(calibrated) };
            let after =
                if k + 1 == answer.effects().len() { after_all } else { a.ladder.get(k).map_or(after_all, rms) };
            let equivalent = if k == 0 { decision.equivalent.clone() } else { equivalent_of(evidence, a, k).0 };
            CauseShare {
                effect,
                form: answer.model.forms()[k].name(),
                only: answer.model.only()[k].as_deref().cloned(),
                equivalent,
                parameters: parameters.iter().find(|(e, _)| *e == effect).map(|(_, p)| p.clone()).unwrap_or_default(),
                alone: alone.and_then(|alone| share(calibrated, alone)),
                last: without.and_then(|without| share(without, after_all)),
                after,
            }
        })
        .collect()
}
