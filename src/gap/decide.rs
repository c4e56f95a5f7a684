//! From fitted hypotheses to a verdict.
//!
//! A hypothesis with more in it has to earn its place three times: on the logs it was fitted to, by more than its
//! parameters could buy from correlated noise; on logs it was not fitted to; and by a part of the gap that matters.
//! What then stays above the noise is weighed against what was closed: an effect that leaves most of it is a partial
//! explanation, and the verdict is that none of the catalogue explains these logs.

use super::attribute::Attribution;
use super::diagnosis::Verdict;
use super::evidence::Evidence;
use super::floor::rough_rad;
use super::held_out::{HeldOut, closed};
use super::trial::Trial;
use crate::joint::EffectId;

/// Deviance per added parameter that a richer hypothesis must gain, and on top of it, for having been chosen among
/// seventeen.
const PER_PARAMETER: f64 = 6.0;
const FOR_THE_CHOICE: f64 = 24.0;
/// Standard deviations by which it must predict held-out logs better.
const HELD_OUT_Z: f64 = 1.0;
/// Deviance whose gain on the fitted logs is enough where the held-out ones are not predicted worse.
const OVERWHELMING: f64 = 400.0;
/// A held-out error below the noise times this is hardly a gap: only an overwhelming gain makes something of it.
const HARDLY_A_GAP: f64 = 1.1;
/// Share of the noise's square sum that it must take away.
const MATTERS: f64 = 0.008;
/// Share by which squared residuals may exceed the noise in a joint that is explained: the noise is not known better.
pub(super) const EXPLAINED: f64 = 0.12;
/// The same where no effect improves anything: only a clear rest is worth an alarm.
const NO_ALARM: f64 = 0.3;
/// Share of the recalibrated gap that an effect must close to be called its cause while something is left.
const CLOSES: f64 = 0.8;
/// Share of what the first effect leaves that a second one must close, unless it leaves nothing.
const SECOND_CLOSES: f64 = 0.6;
/// Deviance within which hypotheses count as equally good, and standard deviations of their difference.
const EQUAL_DEVIANCE: f64 = 9.0;
const EQUAL_Z: f64 = 1.7;

/// The verdict with the hypotheses it rests on.
pub(super) struct Decision<'a> {
    pub verdict: Verdict,
    /// The first effect of the answer, or of the best partial explanation.
    pub first: Option<&'a Trial>,
    /// What the answer rests on: as given, recalibrated, with one effect, or with two.
    pub answer: &'a Trial,
    pub effect: Option<EffectId>,
    pub second: Option<EffectId>,
    pub equivalent: Vec<EffectId>,
    /// Share by which the answer's squared residuals exceed the noise.
    pub excess: f64,
    /// What earned the answer its place: deviance over the next simpler hypothesis.
    pub gain: f64,
    /// Deviance by which the best hypothesis outside the set is worse.
    pub margin: f64,
}

/// Judges the hypotheses.
pub(super) fn decide<'a>(evidence: &Evidence, held: &HeldOut, a: &'a Attribution) -> Decision<'a> {
    let judge = Judge { evidence, held, a };
    let calibrated_pays = judge.earns(&a.calibrated, &a.given, 4.0);
    let simple = if calibrated_pays { &a.calibrated } else { &a.given };
    let first = a.firsts.first().filter(|t| judge.earns(t, &a.calibrated, added(t, &a.calibrated)));
    // A pair may earn what neither of its effects does alone, but only by far: it is one of hundreds.
    let pair = a.seconds.first().filter(|pair| match first {
        Some(first) => judge.second_earns(pair, first),
        None => {
            let gained = judge.deviance(&a.calibrated) - judge.deviance(pair);
            gained > OVERWHELMING && judge.second_earns(pair, &a.calibrated)
        }
    });
    let Some(answer) = pair.or(first) else {
        let excess = a.excess(evidence, simple);
        // What has no shape is noise, however large: no model could take it up.
        let shape = (1.0 + excess) * (a.noise_rad / rough_rad(evidence, simple).max(a.noise_rad)).powi(2) - 1.0;
        // A rest that does not show where the joint has to be predicted is no alarm either.
        let alarm = shape >= NO_ALARM && held.rms_rad(&held.residuals(evidence, simple)) > a.noise_rad;
        let verdict = match (calibrated_pays, alarm) {
            (false, false) => Verdict::None,
            (true, false) => Verdict::Calibration,
            (_, true) => Verdict::Unexplained,
        };
        let gain = if calibrated_pays { judge.deviance(&a.given) - judge.deviance(&a.calibrated) } else { 0.0 };
        let margin = a.firsts.first().map_or(f64::INFINITY, |t| a.score(evidence, t) - a.score(evidence, simple));
        return Decision {
            verdict,
            first: None,
            answer: simple,
            effect: None,
            second: None,
            equivalent: Vec::new(),
            excess,
            gain,
            margin,
        };
    };
    let excess = a.excess(evidence, answer);
    let closes = judge.closed(&a.calibrated, answer).unwrap_or(0.0);
    let explained = excess < EXPLAINED || closes > CLOSES;
    // The first of a pair is the one that alone closes more.
    let rank = |effect: &EffectId| a.firsts.iter().position(|t| t.effects() == [*effect]).unwrap_or(usize::MAX);
    let mut effects = answer.effects().to_vec();
    effects.sort_by_key(rank);
    let (effect, second) = (effects.first().copied(), effects.get(1).copied());
    let (mut equivalent, margin) = judge.equivalent(answer, effect, second);
    // Of single effects that stand equally well the one with the fewest parameters is named.
    let simplest = equivalent.iter().copied().min_by_key(|e| e.searched_count());
    let (answer, effect) = match (second, simplest) {
        (None, Some(simplest)) if Some(simplest) != effect => {
            equivalent.sort_by_key(|e| *e != simplest);
            let trial = a.firsts.iter().find(|t| t.effects() == [simplest]);
            (trial.unwrap_or(answer), Some(simplest))
        }
        _ => (answer, effect),
    };
    let simpler = if second.is_some() { first.unwrap_or(&a.calibrated) } else { &a.calibrated };
    Decision {
        verdict: if explained { Verdict::Effect } else { Verdict::Unexplained },
        first: a.firsts.iter().find(|t| Some(t.effects()[0]) == effect).or(first),
        answer,
        effect,
        second,
        equivalent,
        excess,
        gain: judge.deviance(simpler) - judge.deviance(answer),
        margin,
    }
}

fn added(rich: &Trial, simple: &Trial) -> f64 {
    rich.model.free().saturating_sub(simple.model.free()) as f64
}

struct Judge<'a> {
    evidence: &'a Evidence,
    held: &'a HeldOut,
    a: &'a Attribution,
}

impl Judge<'_> {
    /// Deviance on the fitted logs.
    fn deviance(&self, trial: &Trial) -> f64 {
        trial.fit_loss(self.evidence) / (self.a.noise_rad.powi(2) * self.a.correlation)
    }

    /// Whether `rich` earns its place over `simple`.
    fn earns(&self, rich: &Trial, simple: &Trial, parameters: f64) -> bool {
        let gained = self.deviance(simple) - self.deviance(rich);
        let matters = self.a.excess(self.evidence, simple) - self.a.excess(self.evidence, rich) > MATTERS;
        if !matters || !(gained > PER_PARAMETER * parameters + FOR_THE_CHOICE) {
            return false;
        }
        let of = |t: &Trial| self.held.residuals(self.evidence, t);
        let before_rad = self.held.rms_rad(&of(&self.a.given));
        if before_rad < HARDLY_A_GAP * self.a.noise_rad && gained < OVERWHELMING {
            return false;
        }
        let lost = self.held.difference(&of(simple), &of(rich));
        // Where the held-out logs do not show it, an overwhelming gain on the others must do.
        lost.sum > HELD_OUT_Z * lost.sd || (gained > OVERWHELMING && lost.sum > -HELD_OUT_Z * lost.sd)
    }

    fn second_earns(&self, pair: &Trial, first: &Trial) -> bool {
        let (left, then) = (self.a.excess(self.evidence, first), self.a.excess(self.evidence, pair));
        let enough = then < 0.25 * EXPLAINED && left - then > 0.03 || (left - then) / left > SECOND_CLOSES;
        left > 0.25 * EXPLAINED && enough && self.earns(pair, first, added(pair, first))
    }

    /// Share of the gap that `simple` leaves above the noise and `rich` closes, over all logs.
    fn closed(&self, simple: &Trial, rich: &Trial) -> Option<f64> {
        let rms = |t: &Trial| (1.0 + self.a.excess(self.evidence, t)).max(0.0).sqrt();
        closed(rms(simple), rms(rich).max(1.0), 1.0)
    }

    /// Effects that stand as well as the answer's first, the answer included, best first; and how far the next one is
    /// behind.
    fn equivalent(&self, answer: &Trial, effect: Option<EffectId>, second: Option<EffectId>) -> (Vec<EffectId>, f64) {
        let mut set: Vec<EffectId> = effect.into_iter().collect();
        let best = self.a.score(self.evidence, answer);
        let mut margin = f64::INFINITY;
        let rivals = if second.is_some() { &self.a.seconds } else { &self.a.firsts };
        for rival in rivals {
            let Some(&other) = rival.effects().iter().find(|e| Some(**e) != second && Some(**e) != effect) else {
                continue;
            };
            if second.is_some_and(|s| !rival.effects().contains(&s)) {
                continue;
            }
            let behind = self.a.score(self.evidence, rival) - best;
            let z = self.a.behind(self.evidence, rival, answer);
            let near = self.a.excess(self.evidence, rival) - self.a.excess(self.evidence, answer);
            let share = near / self.a.excess(self.evidence, &self.a.calibrated).max(1e-9);
            if behind < EQUAL_DEVIANCE || (z < EQUAL_Z && share < 0.02) {
                set.push(other);
            } else {
                margin = margin.min(behind);
            }
        }
        (set, margin)
    }
}
