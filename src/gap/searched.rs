//! Which causes a search finds on fewer samples of the logs: grown, exchanged, and proven.

use super::calibrate::calibrate;
use super::chance;
use super::evidence::{Evidence, counts};
use super::explore::explore;
use super::floor::noise_rad;
use super::grow::{Growth, Looked, Pruned};
use super::judged::{Judged, judged};
use super::refuted::refutes;
use super::score::{Measure, is_better};
use super::trial::Trial;
use crate::fit::Budget;
use crate::joint::EffectId;
use crate::progress::{Cancelled, Progress, Step};

/// Sets that are carried over from short parts of the logs.
const CARRIED: usize = 2;
/// Evaluations of a fit that begins near its end.
const AGAIN: Budget = Budget { evaluations: 24 };
/// A share above the noise from which on the search may have ended in a wrong place, and one from which on whole logs are
/// too long for it to begin with.
pub(super) const FAR: f64 = 0.5;
const VERY_FAR: f64 = 4.0;
/// A hypothesis whose squared residuals exceed the noise by this share leaves something to explain.
pub(super) const LEFT_OVER: f64 = 0.02;

/// What a search found.
pub(super) struct Searched {
    /// The samples on which it searched.
    pub coarse: Evidence,
    /// The numbers as given.
    pub as_given: Vec<f64>,
    /// Squares sum to this there where nothing but noise is left \[rad^2\].
    pub enough: f64,
    /// The causes.
    pub judged: Judged,
    /// What else.
    pub known: Known,
}

/// What is known before causes are carried over to all samples.
#[derive(Clone)]
pub(super) struct Known {
    pub given: Trial,
    pub calibrated: Trial,
    pub firsts: Vec<Trial>,
    pub noise_rad: f64,
    pub set_refuted: bool,
    /// Whether held-out logs have refuted a law, so that none is looked for.
    pub law_refuted: bool,
}

/// How many samples count.
pub(super) fn counted(evidence: &Evidence) -> f64 {
    evidence.fit.iter().map(|e| counts(e).sum::<f64>()).sum()
}

impl Searched {
    /// Searches the catalogue `effects`, from the joint as given on or from a set of causes with which it has begun.
    pub fn of(
        evidence: &Evidence,
        effects: &[EffectId],
        begun: Option<&Trial>,
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let stage = |stage| progress.go_on(Step::stage(stage));
        let coarse = evidence.coarse();
        let baseline = evidence.baseline();
        stage("the joint as given")?;
        let given = Trial::as_given(&coarse, &baseline);
        stage("recalibrating")?;
        let mut calibrated = calibrate(&coarse, &baseline, &given);
        stage("trying causes")?;
        let samples = counted(&coarse);
        let enough = |noise_rad: f64| samples * noise_rad.powi(2) * (1.0 + LEFT_OVER);
        let as_given = given.found.values.clone();
        let rough = noise_rad(&coarse, &[&given, &calibrated]);
        let growth = Growth { evidence: &coarse, effects, as_given: &as_given, enough: enough(rough), progress };
        let beyond =
            |t: &Trial, share: f64, noise_rad: f64| t.fit_loss(&coarse) > samples * noise_rad.powi(2) * (1.0 + share);
        // What is less than a step of the encoder may be noise of any colour.
        let step_rad = coarse.reach.resolution_rad;
        let exceeds_a_step = |t: &Trial| t.fit_loss(&coarse) > samples * step_rad.powi(2);
        let leaves_much = |t: &Trial, noise_rad: f64| beyond(t, FAR, noise_rad) && exceeds_a_step(t);
        let (mut best, mut looked, mut set_refuted) = (calibrated.clone(), Looked::default(), false);
        let begins_afresh = begun.is_none();
        if let Some(set) = begun {
            let mut set = set.clone();
            set.begin_as(evidence, &coarse);
            best = set.on(&coarse, AGAIN);
        } else if beyond(&calibrated, VERY_FAR, rough) {
            stage("looking at short parts of the logs")?;
            let carried = in_short_parts(&coarse, &growth, &calibrated);
            if let Some(t) = carried.first() {
                best = t.clone();
            }
        }
        let noise = noise_rad(&coarse, &[&given, &calibrated, &best]);
        let growth = Growth { enough: enough(noise), ..growth };
        if !best.effects().is_empty() && beyond(&best, FAR, noise) {
            best = growth.from(&best).0;
        }
        if begins_afresh && (best.effects().is_empty() || beyond(&best, FAR, noise)) {
            stage("looking at whole logs")?;
            let (other, here) = growth.from(&calibrated);
            looked = here;
            if is_better(&coarse, &other, &best) {
                best = other;
            }
        }
        let noise = noise_rad(&coarse, &[&given, &calibrated, &best]);
        if begins_afresh && leaves_much(&best, noise) {
            stage("beginning with other causes")?;
            let growth = Growth { enough: enough(noise), ..growth };
            let suffices = |t: &Trial| !leaves_much(t, noise);
            (best, set_refuted) = growth.begun_elsewhere(evidence, (&calibrated, &looked), best, &suffices);
        }
        let noise = noise_rad(&coarse, &[&given, &calibrated, &best]);
        let growth = Growth { enough: enough(noise), ..growth };
        // A baseline that has been in the wrong place shows when the effects that found the right one are dropped.
        if !best.effects().is_empty() {
            let bare = best.keeping(&coarse, &[], AGAIN);
            if bare.criterion() < 0.999 * calibrated.criterion() {
                calibrated = bare;
                looked.sights.clear();
            }
        }
        stage("exchanging causes")?;
        let grown = best.effects().to_vec();
        let pruned = growth.pruned(best);
        let Looked { singles: mut firsts, mut sights } = looked;
        if sights.is_empty() {
            sights = growth.sights(&calibrated, effects);
        }
        let chance = chance::threshold(&coarse, &sights, &pruned.best);
        if firsts.is_empty() {
            firsts = explore(&coarse, &calibrated, &sights);
        }
        let judge = |pruned: Pruned| judged(&growth, evidence, pruned, chance, &firsts);
        let mut judged = judge(pruned);
        // What others had stood in for shows once they are gone.
        let went = grown.iter().any(|e| !judged.best.effects().contains(e));
        let looks_again = went && !judged.best.effects().is_empty() && leaves_much(&judged.best, noise);
        if looks_again && !evidence.deadline.leaves_out("further causes") {
            stage("looking again")?;
            let (again, _) = growth.from(&judged.best);
            if again.effects().len() > judged.best.effects().len() {
                let mut again = judge(growth.pruned(again));
                let score = |t: &Trial| Measure::by(&coarse, &again.best).score(&coarse, t);
                if score(&again.best) < score(&judged.best) {
                    if refutes(&coarse, evidence, &again.best, &judged.best) {
                        set_refuted = true;
                    } else {
                        again.refuted.extend(judged.refuted);
                        judged = again;
                    }
                }
            }
        }
        let known = Known { given, calibrated, firsts, noise_rad: noise, set_refuted, law_refuted: false };
        let enough = growth.enough;
        Ok(Self { coarse, as_given, enough, judged, known })
    }
}

/// Sets of effects found on short parts of the logs, on which no hypothesis runs far from its log, carried over.
fn in_short_parts(coarse: &Evidence, growth: &Growth<'_>, calibrated: &Trial) -> Vec<Trial> {
    let short = coarse.in_parts();
    let baseline = coarse.baseline();
    let given = Trial::as_given(&short, &baseline);
    let mut base = calibrate(&short, &baseline, &given);
    // Fitted starts hide what is missing; those that the readings show do not.
    base.found.starts = short.fit.iter().map(|e| e.start_coordinates(&e.start)).collect();
    let inside = Growth { evidence: &short, ..*growth };
    let (best, Looked { singles: mut found, .. }) = inside.from(&base);
    found.truncate(CARRIED - 1);
    found.insert(0, best);
    found.retain(|t| !t.effects().is_empty());
    growth.carried(calibrated, &found)
}
