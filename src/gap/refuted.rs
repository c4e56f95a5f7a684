//! Causes that held-out logs refute: the fitted logs ask for them, and with them logs that were not fitted are predicted
//! clearly worse. Two or three logs seldom show more than they were made to show.

use super::attribute::calibrate;
use super::compare::{Difference, blocks};
use super::evidence::Evidence;
use super::trial::Trial;
use crate::fit::Budget;
use crate::joint::EffectId;
use rayon::prelude::*;

/// Held-out logs refute what they are predicted better without: their squares by this factor, and by so many standard
/// deviations.
const BETTER: f64 = 0.8;
const CLEARLY: f64 = 1.0;
/// Evaluations of a fit that begins near its end.
const AGAIN: Budget = Budget { evaluations: 24 };

/// The evidence with beliefs whose tails are light, where held-out logs refute the numbers that heavy ones let go far.
pub(super) fn soundly_believed(evidence: Evidence) -> Evidence {
    if evidence.held.is_empty() {
        return evidence;
    }
    let calibrated = |evidence: &Evidence| {
        let coarse = evidence.coarse();
        let baseline = coarse.baseline();
        let mut numbers = calibrate(&coarse, &baseline, &Trial::as_given(&coarse, &baseline));
        numbers.predict(&coarse, None);
        numbers
    };
    let normal = Evidence { normal: true, ..evidence.with_logs(evidence.fit.clone(), evidence.held.clone()) };
    if refutes(&evidence.coarse(), &calibrated(&evidence), &calibrated(&normal)) { normal } else { evidence }
}

/// A hypothesis without the causes that the held-out logs refute, and these; everything else refitted.
pub(super) fn unrefuted(evidence: &Evidence, best: Trial) -> (Trial, Vec<EffectId>) {
    let mut best = best;
    let mut refuted = Vec::new();
    if evidence.held.is_empty() {
        return (best, refuted);
    }
    best.predict(evidence, None);
    while !best.effects().is_empty() {
        let causes = best.effects().len();
        // One after the other; and all at once, where none is refuted alone.
        let sets = (0..causes).map(|k| (0..causes).filter(|i| *i != k).collect::<Vec<_>>()).chain([Vec::new()]);
        let tried = sets.collect::<Vec<_>>().into_par_iter().map(|kept| {
            let mut less = best.keeping(evidence, &kept, AGAIN);
            less.predict(evidence, Some(&best));
            less
        });
        let tried: Vec<Trial> = tried.collect();
        let (singly, at_once) = tried.split_at(causes);
        let better = |tried: &[Trial]| {
            let least = tried.iter().min_by(|a, b| a.held_loss(evidence).total_cmp(&b.held_loss(evidence)));
            least.filter(|less| refutes(evidence, &best, less)).cloned()
        };
        let Some(less) = better(singly).or_else(|| better(at_once)) else { break };
        refuted.extend(best.effects().iter().filter(|e| !less.effects().contains(e)));
        best = less;
    }
    (best, refuted)
}

/// Whether the held-out logs are predicted clearly better by a hypothesis that has less.
pub(super) fn refutes(evidence: &Evidence, more: &Trial, less: &Trial) -> bool {
    let gained = Difference::of(&blocks(&evidence.held, &more.held, &less.held).collect::<Vec<f64>>());
    less.held_loss(evidence) < BETTER * more.held_loss(evidence) && gained.z() > CLEARLY
}
