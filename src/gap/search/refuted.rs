//! Causes that held-out logs refute, or do not know: the fitted logs ask for them, and with them logs that were not fitted
//! are predicted clearly worse, or no better. Two or three logs seldom show more than they were made to show. Where the
//! study holds none out, a few logs are held out in turn, or the parts of the only one.

use crate::gap::hypothesis::compare::{Difference, blocks};
use crate::gap::hypothesis::evidence::{Evidence, counts};
use crate::gap::hypothesis::held_out::{FEW_LOGS, HeldOut};
use crate::gap::hypothesis::trial::{AGAIN, Trial};
use crate::joint::{EffectForm, EffectId};
use rayon::prelude::*;

/// Held-out logs refute what they are predicted better without: their squares by this factor, and by so many standard
/// deviations.
const BETTER: f64 = 0.8;
const CLEARLY: f64 = 1.0;
/// A cause without which the held-out squares hardly rise, and the fitted ones by less than this factor, is idle.
const HARDLY: f64 = 1.008;
const LITTLE: f64 = 1.3;
/// Share of what all causes close, and of a step of the encoder, below which one of them is negligible; unless the fitted squares
/// are so many times as large without it: a held-out log may be quiet about what others show.
const NEGLIGIBLE: f64 = 0.02;
const OF_A_STEP: f64 = 0.4;
const SHOWN: f64 = 4.0;
/// What is left out where this is not asked.
const WHETHER_REFUTED: &str = "whether held-out logs refute a cause";

/// The evidence with beliefs whose tails are light, where held-out logs are predicted clearly better by the same causes
/// with numbers that heavy tails have not let go far; `None` where they are not.
pub(in crate::gap) fn soundly_believed(evidence: &Evidence, best: &Trial) -> Option<Evidence> {
    if evidence.held.is_empty()
        || evidence.normal_beliefs
        || evidence.deadline.leaves_out("a search with numbers held to their beliefs")
    {
        return None;
    }
    let normal = Evidence { normal_beliefs: true, ..evidence.with_logs(evidence.fit.clone(), evidence.held.clone()) };
    let all: Vec<usize> = (0..best.effects().len()).collect();
    let mut held_back = best.keeping(&normal, &all, AGAIN).settled(&normal, AGAIN);
    held_back.predict(&normal, Some(best));
    predicts_clearly_worse(evidence, best, &held_back).then_some(normal)
}

/// A hypothesis without the causes that the held-out logs refute or do not know, and these; everything else refitted.
/// What was found on a choice of the samples is judged on all. Of the `known` hypotheses those with fewer of its causes are
/// judged as well: they may have found a better place than it leads to without the others.
pub(in crate::gap) fn unrefuted(
    coarse: &Evidence,
    evidence: &Evidence,
    best: Trial,
    known: &[Trial],
) -> (Trial, Vec<EffectId>) {
    let in_turn = evidence.held.is_empty();
    if best.effects().is_empty() || in_turn && !(1..=FEW_LOGS).contains(&evidence.fit.len()) {
        return (best, Vec::new());
    }
    if evidence.deadline.cuts(WHETHER_REFUTED) {
        return (best, Vec::new());
    }
    let whole = best.carried(coarse, evidence, AGAIN);
    let fewer = |t: &&Trial| {
        (1..best.effects().len()).contains(&t.effects().len()) && t.effects().iter().all(|e| best.effects().contains(e))
    };
    let known: Vec<Trial> = known.iter().filter(fewer).map(|t| t.carried(coarse, evidence, AGAIN)).collect();
    let (mut left, refuted) = if in_turn {
        let held = HeldOut::in_turn(evidence);
        let judged = evidence.with_logs(evidence.fit.clone(), evidence.fit.clone());
        unrefuted_on(&judged, whole, known, &|t, _| t.held = held.residuals(evidence, t))
    } else {
        unrefuted_on(evidence, whole, known, &|t, near| t.predict(evidence, near))
    };
    if left.model.forms() == best.model.forms() {
        return (best, refuted);
    }
    left.held.clear();
    left.held_starts.clear();
    (left.carried(evidence, coarse, AGAIN), refuted)
}

/// Lets a hypothesis predict the held-out logs; their starts may be near another's.
type Predict<'a> = &'a (dyn Fn(&mut Trial, Option<&Trial>) + Sync);

fn unrefuted_on(
    evidence: &Evidence,
    mut best: Trial,
    mut known: Vec<Trial>,
    predict: Predict<'_>,
) -> (Trial, Vec<EffectId>) {
    let mut refuted = Vec::new();
    predict(&mut best, None);
    known.par_iter_mut().for_each(|t| predict(t, Some(&best)));
    while !best.effects().is_empty() {
        let causes = best.effects().len();
        // One after the other; and all at once, where none is refuted alone.
        let sets = (0..causes).map(|k| (0..causes).filter(|i| *i != k).collect::<Vec<_>>()).chain([Vec::new()]);
        let tried = sets.collect::<Vec<_>>().into_par_iter().map(|kept| {
            let mut less = best.keeping(evidence, &kept, AGAIN);
            predict(&mut less, Some(&best));
            less
        });
        let tried: Vec<Trial> = tried.collect();
        let (singly, at_once) = tried.split_at(causes);
        // What all of them close: beside it a cause may be negligible.
        let all_rad = at_once.iter().map(|bare| held_rms_rad(evidence, bare) - held_rms_rad(evidence, &best)).sum();
        known.retain(|t| t.effects().len() < causes && t.effects().iter().all(|e| best.effects().contains(e)));
        let least = |tried: &[Trial], goes: &dyn Fn(&Trial) -> bool| {
            let those = tried.iter().filter(|less| goes(less));
            those.min_by(|a, b| a.held_loss(evidence).total_cmp(&b.held_loss(evidence))).cloned()
        };
        let is_worse = |less: &Trial| predicts_clearly_worse(evidence, &best, less);
        let may_go = |less: &Trial| {
            is_worse(less)
                || is_idle(evidence, &best, less)
                || causes > 1 && is_negligible(evidence, &best, less, all_rad)
        };
        let better = |tried: &[Trial]| least(tried, &may_go);
        let otherwise = || least(&[in_simpler_forms(evidence, &best, predict), known.clone()].concat(), &is_worse);
        let Some(less) = better(singly).or_else(|| better(at_once)).or_else(otherwise) else { break };
        refuted.extend(best.effects().iter().filter(|e| !less.effects().contains(e)));
        best = less;
    }
    (best, refuted)
}

/// With one of its causes in a form that has fewer values.
fn in_simpler_forms(evidence: &Evidence, best: &Trial, predict: Predict<'_>) -> Vec<Trial> {
    let values = |form: EffectForm| form.parameters(&evidence.reach).len();
    let simpler = |k: usize| {
        let own = best.model.forms()[k];
        own.id.forms().filter(move |form| values(*form) < values(own)).map(move |form| (k, form))
    };
    let others: Vec<(usize, EffectForm)> = (0..best.effects().len()).flat_map(simpler).collect();
    let tried = others.into_par_iter().map(|(k, form)| {
        let mut simpler = best.in_form(evidence, k, form, AGAIN);
        predict(&mut simpler, Some(best));
        simpler
    });
    tried.collect()
}

/// Whether what a hypothesis has more than another does nothing for held-out logs, and little for fitted ones.
fn is_idle(evidence: &Evidence, more: &Trial, less: &Trial) -> bool {
    less.held_loss(evidence) < HARDLY * more.held_loss(evidence)
        && less.fit_loss(evidence) < LITTLE * more.fit_loss(evidence)
}

/// Whether what a hypothesis has more than another closes next to nothing of held-out logs: a small share of what all
/// causes close together, and less than an encoder shows; where the fitted ones do not show it all the more.
fn is_negligible(evidence: &Evidence, more: &Trial, less: &Trial, all_rad: f64) -> bool {
    let closes_rad = held_rms_rad(evidence, less) - held_rms_rad(evidence, more);
    closes_rad < NEGLIGIBLE * all_rad
        && closes_rad < OF_A_STEP * evidence.reach.resolution_rad
        && less.fit_loss(evidence) < SHOWN * more.fit_loss(evidence)
}

/// Root of the mean square of the held-out logs' residuals \[rad\].
fn held_rms_rad(evidence: &Evidence, trial: &Trial) -> f64 {
    let samples: f64 = evidence.held.iter().map(|e| counts(e).sum::<f64>()).sum();
    (trial.held_loss(evidence) / samples).sqrt()
}

/// Whether held-out logs are predicted clearly worse by a hypothesis than by another, both found on a choice of the samples.
pub(in crate::gap) fn refutes(coarse: &Evidence, evidence: &Evidence, this: &Trial, other: &Trial) -> bool {
    if evidence.held.is_empty() {
        return false;
    }
    let [this, other] = both_on_all(coarse, evidence, this, other).map(|mut whole| {
        whole.predict(evidence, None);
        whole
    });
    predicts_clearly_worse(evidence, &this, &other)
}

/// The same; where the study holds none out and has few logs, these, or the parts of the only one, are held out in turn.
pub(in crate::gap) fn refutes_in_turn(coarse: &Evidence, evidence: &Evidence, this: &Trial, other: &Trial) -> bool {
    if !evidence.held.is_empty() {
        return refutes(coarse, evidence, this, other);
    }
    if can_refute(evidence) {
        let [this, other] = both_on_all(coarse, evidence, this, other);
        return refuted_by(evidence, &this, &[&other]).is_some();
    }
    false
}

/// Whether there are logs or parts of which it can be asked how they are predicted, and time to do so.
fn can_refute(evidence: &Evidence) -> bool {
    let many = evidence.held.is_empty() && evidence.fit.len() > FEW_LOGS;
    !many && evidence.pooled_from.is_none() && !evidence.deadline.leaves_out(WHETHER_REFUTED)
}

fn both_on_all(coarse: &Evidence, evidence: &Evidence, this: &Trial, other: &Trial) -> [Trial; 2] {
    rayon::join(|| this.carried(coarse, evidence, AGAIN), || other.carried(coarse, evidence, AGAIN)).into()
}

/// Of other hypotheses, all on all samples, the one that predicts held-out logs best, where that is clearly better.
pub(in crate::gap) fn refuted_by<'a>(evidence: &Evidence, this: &Trial, others: &[&'a Trial]) -> Option<&'a Trial> {
    if others.is_empty() || !can_refute(evidence) {
        return None;
    }
    let held = HeldOut::of(evidence);
    let judged = evidence.with_logs(evidence.fit.clone(), held.experiments.clone());
    let predicted = |t: &Trial| Trial { held: held.residuals(evidence, t), ..t.clone() };
    let all: Vec<Trial> = others.par_iter().map(|t| predicted(t)).collect();
    let loss = |k: &usize| all[*k].held_loss(&judged);
    let least = (0..all.len()).min_by(|a, b| loss(a).total_cmp(&loss(b)))?;
    predicts_clearly_worse(&judged, &predicted(this), &all[least]).then(|| others[least])
}

/// Whether a hypothesis predicts held-out logs clearly worse than another; one along which the joint runs away does.
pub(in crate::gap) fn predicts_clearly_worse(evidence: &Evidence, this: &Trial, other: &Trial) -> bool {
    let [of_this, of_other] = [this, other].map(|t| t.held_loss(evidence));
    if !of_this.is_finite() {
        return of_other.is_finite();
    }
    let gained = Difference::of_a_whole(&blocks(&evidence.held, &this.held, &other.held).collect::<Vec<f64>>());
    of_other < BETTER * of_this && gained.z() > CLEARLY
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::Case;

    #[test]
    fn a_joint_that_runs_away_predicts_worse_than_one_that_does_not() {
        let case = Case::of_study("data/examples/delay/study.toml".as_ref()).unwrap();
        let evidence = Evidence::of(&case, case.joint.nominal.unwrap()).unwrap();
        let evidence = evidence.with_logs(evidence.fit.clone(), evidence.fit.clone());
        let mut stays = Trial::as_given(&evidence, &evidence.baseline());
        stays.predict(&evidence, None);
        let mut runs_away = stays.clone();
        runs_away.held[0].fill(f64::INFINITY);
        assert!(predicts_clearly_worse(&evidence, &runs_away, &stays));
        assert!(!predicts_clearly_worse(&evidence, &stays, &runs_away));
        assert!(!predicts_clearly_worse(&evidence, &runs_away, &runs_away));
    }
}
