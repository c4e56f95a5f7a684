//! What stays of a grown set of causes once each has had to show that it is needed, and predicts.

use super::grow::{Growth, Pruned};
use super::refuted::{refutes, unrefuted};
use super::within::within_logs;
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::folds::Folds;
use crate::gap::hypothesis::held_out::{Elsewhere, FEW_LOGS};
use crate::gap::hypothesis::score::Measure;
use crate::gap::hypothesis::trial::{AGAIN, Trial};
use crate::joint::EffectId;
use rayon::prelude::*;

/// Standard deviations by which a cause has to predict logs better that were not fitted.
const PREDICTS: f64 = 0.5;
/// Standard deviations from which on it clearly does.
const CLEARLY: f64 = 2.0;
/// Shares of the squares without a cause that are far less, and little.
const FAR_LESS: f64 = 0.5;
const LITTLE: f64 = 0.25;

/// A set of causes that was judged.
#[derive(Clone)]
pub(in crate::gap) struct Judged {
    /// With the causes that stay.
    pub best: Trial,
    /// The causes before they had to prove themselves.
    pub members: Vec<EffectId>,
    /// For each of these: the sets in which another effect stands in its place, best first.
    pub rivals: Vec<Vec<Trial>>,
    /// Causes that the fitted logs ask for and the held-out ones refute.
    pub refuted: Vec<EffectId>,
    /// Whether one of them stays for how held-out logs are predicted with it, and not for parts of fitted ones.
    pub borne_out: bool,
}

/// A set of causes exchanged, proven, in its best forms, in the logs in which it holds, and without what held-out logs
/// refute; `chance` is the deviance that chance alone may gain, `known` are hypotheses with fewer causes.
pub(in crate::gap) fn judged(
    growth: &Growth<'_>,
    whole: &Evidence,
    grown: Pruned,
    chance: f64,
    known: &[Trial],
) -> Judged {
    let evidence = growth.evidence;
    let (Pruned { best: exchanged, without }, rivals) = growth.exchanged(grown);
    let members = exchanged.effects().to_vec();
    let (proven, borne_out) = proven(evidence, whole, exchanged, without, chance);
    let best = growth.formed(proven);
    let (best, refuted) = unrefuted(evidence, whole, within_logs(growth, best, chance), known);
    Judged { best, members, rivals, refuted, borne_out }
}

/// The set without members that chance may have brought, or that neither predict logs which were not fitted nor leave little
/// of what there is without them; and whether one stays for held-out logs alone.
fn proven(
    evidence: &Evidence,
    whole: &Evidence,
    mut best: Trial,
    mut without: Vec<Trial>,
    chance: f64,
) -> (Trial, bool) {
    let mut borne_out = false;
    while !best.effects().is_empty() && !evidence.deadline.cuts("whether each cause predicts what was not fitted") {
        let measure = Measure::by(evidence, &best);
        let deviance = |t: &Trial| measure.deviance(evidence, t);
        let folds = Folds::of(evidence);
        let held = folds.residuals(&best);
        // What leaves far less everywhere need not tell where a log began whose first part it does not know.
        let leaves_far_less = |t: &Trial| best.fit_loss(evidence) < FAR_LESS * t.fit_loss(evidence);
        let from_starts = Folds::of(evidence).with_starts_held();
        let held_from_starts = without.iter().any(leaves_far_less).then(|| from_starts.residuals(&best));
        // Few logs are as many conditions: what holds in one has to hold in the others. Where logs are held out, these say
        // so better than one or two that are fitted.
        let few = evidence.held.is_empty() && (2..=FEW_LOGS).contains(&evidence.fit.len());
        let worth = |(k, t): (usize, &Trial)| {
            if best.model.has_no_size(&best.found.values, k) {
                return (f64::NEG_INFINITY, false);
            }
            let gained = deviance(t) - deviance(&best);
            let lost = match &held_from_starts {
                Some(there) if leaves_far_less(t) => from_starts.difference(&from_starts.residuals(t), there),
                _ => folds.difference(&folds.residuals(t), &held),
            };
            let elsewhere =
                if few { Elsewhere::of(evidence, t, &best, measure.effective) } else { Elsewhere::default() };
            // What predicts clearly need not exceed chance by itself, but its charge.
            let clearly = lost.z() > CLEARLY || elsewhere.z > CLEARLY;
            let needed = if clearly { measure.charge(&best) - measure.charge(t) } else { chance };
            // What leaves next to nothing of the squares need not do so by chance, and one part that a step of the fit does
            // not reach, where joints stick, outweighs all others.
            let leaves_little = best.fit_loss(evidence) < LITTLE * t.fit_loss(evidence) && lost.z() > -CLEARLY;
            let predicts = lost.sum > PREDICTS * lost.sd || leaves_little;
            // Where a joint sticks, parts of the fitted logs say little: a stop more or less decides all that follows.
            let is_borne_out =
                !predicts && gained > needed && lost.z() > -CLEARLY && refutes(evidence, whole, t, &best);
            let stays = (predicts || is_borne_out) && elsewhere.no_worse(lost.z());
            (if stays { gained - needed } else { f64::NEG_INFINITY }, is_borne_out)
        };
        let weighed: Vec<(f64, bool)> = without.par_iter().enumerate().map(worth).collect();
        borne_out = weighed.iter().any(|(_, by_held_out)| *by_held_out);
        let worths: Vec<f64> = weighed.into_iter().map(|(worth, _)| worth).collect();
        let worst = (0..worths.len()).min_by(|a, b| worths[*a].total_cmp(&worths[*b]));
        match worst {
            Some(k) if worths[k] < 0.0 => {
                // Of several that do not predict, the one whose absence costs least goes first.
                let failing: Vec<usize> = (0..worths.len()).filter(|k| worths[*k] < 0.0).collect();
                let least =
                    failing.into_iter().min_by(|a, b| deviance(&without[*a]).total_cmp(&deviance(&without[*b])));
                best = without.swap_remove(least.unwrap_or(k));
                without = (0..best.effects().len()).map(|k| best.without(evidence, k, AGAIN)).collect();
            }
            _ => break,
        }
    }
    // Where all of them together do not exceed chance, none is there.
    let measure = Measure::by(evidence, &best);
    let bare = best.keeping(evidence, &[], AGAIN);
    let exceeds = measure.deviance(evidence, &bare) - measure.deviance(evidence, &best) > chance;
    if exceeds { (best, borne_out) } else { (bare, false) }
}
