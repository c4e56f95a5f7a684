//! From fitted hypotheses to a verdict.
//!
//! The causes have earned their place before: each gains more than chance would, and each predicts logs that were not
//! fitted. What is decided here is what kind of answer that makes: whether the numbers alone have moved, whether what
//! stays above the noise is small beside what was closed, and which other effects would do as well.

use super::numbers::{UNNAMED, includes_none, numbers, numbers_beside};
use crate::gap::diagnosis::Verdict;
use crate::gap::hypothesis::evidence::{Evidence, WholeLeft};
use crate::gap::hypothesis::floor::rough_rad;
use crate::gap::hypothesis::held_out::{HeldOut, closed};
use crate::gap::hypothesis::model::{BASELINE, COULOMB, DERIVATIVE, GAIN, INTEGRAL};
use crate::gap::hypothesis::score::{EQUAL_DEVIANCE, Measure};
use crate::gap::hypothesis::trial::{AGAIN, Trial};
use crate::gap::search::attribute::Attribution;
use crate::identify::JointModel;
use crate::joint::EffectId;

/// Deviance that recalibration must gain, beside what its numbers cost under the beliefs.
const RECALIBRATES: f64 = 24.0;
/// Share of the noise's square sum that it must take away.
const MATTERS: f64 = 0.008;
/// A held-out error below the noise times this is hardly a gap: shares of it would be numbers without meaning.
pub(crate) const HARDLY_A_GAP: f64 = 1.1;
/// Deviance that makes something even of that.
const OVERWHELMING: f64 = 400.0;
/// Share by which squared residuals may exceed the noise in a joint that is explained: the noise is not known better.
pub(in crate::gap) const EXPLAINED: f64 = 0.12;
/// The same where no effect improves anything: only a clear rest is worth an alarm.
const NO_ALARM: f64 = 0.3;
/// Share of the recalibrated gap that the causes must close to be called its causes while something is left.
const CLOSES: f64 = 0.75;
/// Standard deviations of their difference within which hypotheses count as equally good, beside [`EQUAL_DEVIANCE`].
const EQUAL_Z: f64 = 1.7;
/// The same from which on they can be told apart, whatever their deviance.
const TOLD_APART_Z: f64 = 2.0;
/// Share of what recalibration leaves below which their difference counts for nothing.
const EQUAL_SHARE: f64 = 0.02;
/// Standard deviations from which on the drive's gain has clearly moved.
const GAIN_SD: f64 = 1.5;
/// Numbers that moved by less have not where the joint as given is no more than an encoder's step off.
const MOVED_SD: f64 = 1.0;

/// Whether an RMS is more than noise of this size, where no cause improves anything.
pub fn leaves_something(rms_rad: f64, noise_rad: f64) -> bool {
    (rms_rad / noise_rad).powi(2) - 1.0 > NO_ALARM
}

/// The verdict with the hypotheses it rests on.
pub(in crate::gap) struct Decision<'a> {
    pub verdict: Verdict,
    /// The first effect of the answer, or of the best partial explanation.
    pub first: Option<&'a Trial>,
    /// What the answer rests on: as given, recalibrated, or with causes.
    pub answer: &'a Trial,
    /// Causes in the order of what they close; last a gain of the drive beyond belief, which the answer has as a number.
    pub effects: Vec<EffectId>,
    /// Effects that would do as well in the place of the first, which is included.
    pub equivalent: Vec<EffectId>,
    /// Share by which the answer's squared residuals exceed the noise.
    pub excess: f64,
    /// What earned the answer its place: deviance over the next simpler hypothesis.
    pub gain: f64,
    /// Score by which the best hypothesis outside the set is worse.
    pub margin: f64,
    /// The number that was moved by most of its standard deviations.
    pub finding: Option<usize>,
}

impl Decision<'_> {
    pub fn effect(&self) -> Option<EffectId> {
        self.effects.first().copied()
    }

    pub fn second(&self) -> Option<EffectId> {
        self.effects.get(1).copied()
    }

    /// Causes that fitted logs ask for and that the answer does without, as held-out logs need none.
    pub fn dropped<'b>(&self, a: &'b Attribution) -> &'b [EffectId] {
        if self.answer.effects().is_empty() { a.best.effects() } else { &[] }
    }

    /// The same of a law.
    pub fn drops_law(&self, a: &Attribution) -> bool {
        self.verdict == Verdict::Unexplained && a.law.is_some() && self.answer.model.law().is_none()
    }
}

/// Judges the hypotheses; `considered` are the effects that may be named.
pub(in crate::gap) fn decide<'a>(
    evidence: &Evidence,
    held: &HeldOut,
    a: &'a Attribution,
    considered: &[EffectId],
) -> Decision<'a> {
    let judge = Judge { evidence, held, a, considered };
    if a.best.effects().is_empty() || judge.has_hardly_a_cause() {
        return judge.without_effects();
    }
    let decision = judge.with_effects();
    // What explains the gap in part only, and predicts no better than numbers do, explains nothing.
    if decision.verdict == Verdict::Unexplained && judge.held_rad(decision.answer) >= judge.held_rad(&a.calibrated) {
        return judge.without_effects();
    }
    decision
}

struct Judge<'a, 'e> {
    evidence: &'e Evidence,
    held: &'e HeldOut,
    a: &'a Attribution,
    considered: &'e [EffectId],
}

impl<'a> Judge<'a, '_> {
    fn without_effects(&self) -> Decision<'a> {
        let (a, evidence) = (self.a, self.evidence);
        let pays = self.recalibration_pays();
        let simple = if pays { &a.calibrated } else { &a.given };
        let excess = a.excess(evidence, simple);
        let alarm = self.is_alarming(simple);
        let verdict = match (pays, alarm) {
            (false, false) => Verdict::None,
            (true, false) => Verdict::Calibration,
            (_, true) => Verdict::Unexplained,
        };
        let finding = if pays { moved_most(simple) } else { None };
        // The gain of the drive as a number is the effect of a motor that delivers more or less than commanded.
        let is_gain = verdict == Verdict::Calibration
            && (finding == Some(GAIN) || self.needs_another_gain())
            && self.names_gain_of(simple);
        let finding = if is_gain { Some(GAIN) } else { finding };
        let effects = if is_gain { vec![EffectId::MotorGain] } else { Vec::new() };
        let predicts = |law: &&Trial| law.effects().is_empty() && self.held_rad(law) < self.held_rad(simple);
        let answer = a.law.as_ref().filter(|_| alarm).filter(predicts).unwrap_or(simple);
        Decision {
            verdict: if is_gain { Verdict::Effect } else { verdict },
            first: None,
            answer,
            equivalent: effects.clone(),
            effects,
            excess,
            gain: if pays { self.deviance(&a.given) - self.deviance(&a.calibrated) } else { 0.0 },
            margin: a.firsts.first().map_or(f64::INFINITY, |t| self.score(t) - self.score(simple)),
            finding,
        }
    }

    /// Root of the mean square that a hypothesis leaves of the held-out logs.
    fn held_rad(&self, trial: &Trial) -> f64 {
        self.held.rms_rad(&self.held.residuals(self.evidence, trial))
    }

    /// Whether a hypothesis leaves what is worth an alarm.
    fn is_alarming(&self, trial: &Trial) -> bool {
        let noise_rad = self.a.noise_rad;
        // What has no shape is noise, however large: no model could take it up.
        let rough_rad = rough_rad(self.evidence, trial).max(noise_rad);
        let shape = (1.0 + self.a.excess(self.evidence, trial)) * (noise_rad / rough_rad).powi(2) - 1.0;
        // A rest that does not show where the joint has to be predicted is no alarm either.
        shape >= NO_ALARM && self.held_rad(trial) > noise_rad && self.exceeds_a_step(trial) && !self.whole_explains()
    }

    /// Whether the whole robot, simulated at its best with what was found so far, leaves no more of the joint than noise: what is
    /// left along the measured motion is how that motion was followed.
    fn whole_explains(&self) -> bool {
        self.evidence.whole.is_some_and(|whole| !leaves_something(whole.found_rad, self.a.noise_rad))
    }

    /// Whether the numbers of the joint cannot do what a refitted gain of the drive does: with the gain as stated they leave
    /// what is worth an alarm. A gain within what is believed of it is one only where it is that of the whole law: with
    /// damping and integral shares as stated it leaves no alarm.
    fn needs_another_gain(&self) -> bool {
        let calibrated = &self.a.calibrated;
        let (gain, value) = (&calibrated.model.parameters()[GAIN], calibrated.found.values[GAIN]);
        !gain.fixed
            && self.is_alarming(&self.as_stated(&[GAIN]))
            && (gain.moved(value).abs() > GAIN_SD || !self.is_alarming(&self.as_stated(&[DERIVATIVE, INTEGRAL])))
    }

    /// Whether the gain of the drive in a hypothesis may be called an effect: it has an interval which, with what is not named
    /// allowed for, leaves out the stated gain.
    fn names_gain_of(&self, trial: &Trial) -> bool {
        let leaves_out = |beside: &[EffectId]| {
            let (parameters, _) = numbers_beside(self.evidence, trial, beside);
            parameters[GAIN].interval.is_some_and(|[low, high]| !(low..=high).contains(&1.0))
        };
        let may_be_named = self.considered.contains(&EffectId::MotorGain) && leaves_out(&[]);
        may_be_named && (self.evidence.deadline.leaves_out(UNNAMED) || leaves_out(self.considered))
    }

    /// The recalibrated joint, fitted again with these shares of its drive's law as stated.
    fn as_stated(&self, shares: &[usize]) -> Trial {
        let calibrated = &self.a.calibrated;
        let mut values = calibrated.found.values.clone();
        shares.iter().for_each(|&share| values[share] = 1.0);
        let model = calibrated.model.clone().holding(shares, &values);
        let mut as_stated = Trial::solved(self.evidence, model, &values, calibrated.found.starts.clone(), AGAIN);
        as_stated.predict(self.evidence, Some(calibrated));
        as_stated
    }

    /// Whether the joint as given is no more than an encoder's step off, and predicts held-out logs as well as the best.
    ///
    /// Where other joints push it, whose motion is read in such steps, the recalibrated joint will do as well, also where it
    /// leaves what would be no alarm: it may predict hardly worse. It may predict any worse where no cause has a size that logs
    /// agree on, for such a cause may only have led the numbers to their place. The whole robot says the same where it needs no
    /// cause to predict the joint as well.
    fn has_hardly_a_cause(&self) -> bool {
        let stands = |t: &Trial, times: f64| self.held_rad(t) <= times * self.held_rad(&self.a.best);
        let is_small = |t: &Trial| !self.exceeds_a_step(t) || self.a.excess(self.evidence, t) < NO_ALARM;
        let numbers_do = || {
            let times = if self.has_causes_of_no_certain_size() { f64::INFINITY } else { HARDLY_A_GAP };
            is_small(&self.a.calibrated) && stands(&self.a.calibrated, times)
        };
        // The whole robot needs no cause to predict the joint as well.
        let whole_does = |whole: WholeLeft| {
            !leaves_something(whole.bare_rad, self.a.noise_rad) && whole.bare_rad <= self.held_rad(&self.a.best)
        };
        !self.exceeds_a_step(&self.a.given) && stands(&self.a.given, 1.0)
            || self.evidence.is_carried() && numbers_do()
            || self.evidence.whole.is_some_and(whole_does)
    }

    /// Whether no interval of a cause's size leaves out that there is none of it.
    fn has_causes_of_no_certain_size(&self) -> bool {
        let (joint, causes) = numbers(self.evidence, &self.a.best);
        causes.iter().all(|(effect, own)| includes_none(*effect, own, joint[COULOMB].value))
    }

    fn with_effects(&self) -> Decision<'a> {
        let a = self.a;
        let answer = &a.best;
        let excess = a.excess(self.evidence, answer);
        let closes = self.closed(&a.calibrated, answer).unwrap_or(0.0);
        // Where something is left the causes have to predict better than the joint as it was given.
        let predicts = || self.held_rad(answer) < self.held_rad(&a.given);
        let closes_most = closes > CLOSES && predicts();
        let explained = excess < EXPLAINED || closes_most || !self.exceeds_a_step(answer) || self.whole_explains();
        let mut effects = answer.effects().to_vec();
        let (mut equivalent, margin) = equivalent_of(self.evidence, a, 0);
        let mut chosen = answer;
        // Of single effects that stand equally well, with what they ask of the beliefs, the simplest is named.
        let as_well = |t: &&Trial| {
            matches!(t.effects(), [e] if equivalent.contains(e)) && self.score(t) - self.score(answer) < EQUAL_DEVIANCE
        };
        let complexity = |t: &Trial| complexity(t.effects()[0]);
        let simplest = a.rivals.first().into_iter().flatten().filter(as_well).min_by_key(|t| complexity(t));
        if let ([_], Some(trial)) = (&effects[..], simplest)
            && answer.model.only()[0].is_none()
            && complexity(trial) < complexity(answer)
        {
            let simplest = trial.effects()[0];
            equivalent.sort_by_key(|e| *e != simplest);
            (effects, chosen) = (vec![simplest], trial);
        }
        let simpler = a.without.last().unwrap_or(&a.calibrated);
        let first = if effects.len() == 1 { Some(chosen) } else { a.ladder.first() };
        // A law takes what it explains out of the numbers, where held-out logs bear it out as they are told.
        let predicts = |law: &&Trial| self.held_rad(law) < self.held_rad(chosen);
        let beside = a.law.as_ref().filter(|law| law.effects() == chosen.effects());
        let answer = beside.filter(predicts).unwrap_or(chosen);
        if explained && is_beyond_belief(answer, GAIN) && self.names_gain_of(answer) {
            effects.push(EffectId::MotorGain);
        }
        Decision {
            verdict: if explained { Verdict::Effect } else { Verdict::Unexplained },
            first,
            answer,
            effects,
            equivalent,
            excess,
            gain: self.deviance(simpler) - self.deviance(&a.best),
            margin,
            finding: moved_most(chosen),
        }
    }

    /// Whether what a hypothesis leaves is more than one step of the encoder: less may be noise of any colour.
    fn exceeds_a_step(&self, trial: &Trial) -> bool {
        let rms_rad = (1.0 + self.a.excess(self.evidence, trial)).max(0.0).sqrt() * self.a.noise_rad;
        rms_rad > self.evidence.reach.resolution_rad
    }

    /// Deviance on the fitted logs, with what the beliefs ask.
    fn deviance(&self, trial: &Trial) -> f64 {
        Measure::by(self.evidence, &self.a.best).deviance(self.evidence, trial)
    }

    fn score(&self, trial: &Trial) -> f64 {
        self.a.score(self.evidence, trial)
    }

    /// Whether refitting the numbers within their beliefs earns its place over the joint as given.
    fn recalibration_pays(&self) -> bool {
        let (rich, simple) = (&self.a.calibrated, &self.a.given);
        let gained = self.deviance(simple) - self.deviance(rich);
        let matters = self.a.excess(self.evidence, simple) - self.a.excess(self.evidence, rich) > MATTERS;
        if !matters || !(gained > RECALIBRATES) || !self.exceeds_a_step(simple) && !has_moved(rich) {
            return false;
        }
        let of = |t: &Trial| self.held.residuals(self.evidence, t);
        let before = of(simple);
        if self.held.rms_rad(&before) < HARDLY_A_GAP * self.a.noise_rad && gained < OVERWHELMING {
            return false;
        }
        let lost = self.held.difference(&before, &of(rich));
        // Where the held-out logs do not show it, an overwhelming gain on the others must do.
        lost.sum > lost.sd || (gained > OVERWHELMING && lost.sum > -lost.sd)
    }

    /// Share of the gap that `simple` leaves above the noise and `rich` closes, over all logs.
    fn closed(&self, simple: &Trial, rich: &Trial) -> Option<f64> {
        let rms = |t: &Trial| (1.0 + self.a.excess(self.evidence, t)).max(0.0).sqrt();
        closed(rms(simple), rms(rich).max(1.0), 1.0)
    }
}

/// Effects that stand as well as cause number `k` of the best hypothesis in the presence of the others, that cause
/// included, best first; and how far the next one is behind.
pub(in crate::gap) fn equivalent_of(evidence: &Evidence, a: &Attribution, k: usize) -> (Vec<EffectId>, f64) {
    let answer = &a.best;
    let mut set = vec![answer.effects()[k]];
    let best = a.score(evidence, answer);
    let mut margin = f64::INFINITY;
    for rival in a.rivals.get(k).into_iter().flatten() {
        let Some(&other) = rival.effects().iter().find(|e| !answer.effects().contains(e)) else { continue };
        let behind = a.score(evidence, rival) - best;
        let z = a.behind(evidence, rival, answer);
        let near = a.excess(evidence, rival) - a.excess(evidence, answer);
        let share = near / a.excess(evidence, &a.calibrated).max(1e-9);
        let is_simpler = complexity(other) < complexity(answer.effects()[k]);
        if stands_as_well(behind, z, share, is_simpler) {
            if !set.contains(&other) {
                set.push(other);
            }
        } else {
            margin = margin.min(behind);
        }
    }
    (set, margin)
}

/// Whether what explains the logs worse stands as well: by its score `behind`, or by standard deviations `z` of the difference
/// where that is a small `share` of what recalibration leaves. What has more in it explains more by nature: that a simpler
/// one does a little less tells nothing, and its score allows for it. Else what is clearly worse can be told apart.
fn stands_as_well(behind: f64, z: f64, share: f64, is_simpler: bool) -> bool {
    let is_as_good = behind < EQUAL_DEVIANCE && (is_simpler || z < TOLD_APART_Z);
    is_as_good || (z < EQUAL_Z && share < EQUAL_SHARE)
}

/// What an effect has in it. A late setpoint is simpler than a late reading, which changes the loop as well.
fn complexity(effect: EffectId) -> (usize, bool) {
    (effect.searched_count(), effect == EffectId::SensorDelay)
}

/// Whether a number was moved further than belief allows.
fn is_beyond_belief(trial: &Trial, number: usize) -> bool {
    let name = &trial.model.parameters()[number].name;
    trial.beliefs().iter().any(|belief| belief.name == *name && belief.is_finding())
}

/// Whether any number was moved at all, as far as that is believed of it.
fn has_moved(trial: &Trial) -> bool {
    let numbers = trial.model.parameters().iter().zip(&trial.found.values).take(BASELINE);
    numbers.filter(|(number, _)| !number.fixed).any(|(number, value)| number.moved(*value).abs() > MOVED_SD)
}

/// The number that was moved by most of its standard deviations. The drive's gain is one only from a clear move on: that
/// is a statement about the motor.
fn moved_most(trial: &Trial) -> Option<usize> {
    let parameters = trial.model.parameters();
    let moved = |i: &usize| {
        let p = &parameters[*i];
        if p.fixed { 0.0 } else { p.moved(trial.found.values[*i]).abs() }
    };
    let candidates = (0..BASELINE).filter(|i| moved(i) > if *i == GAIN { GAIN_SD } else { 0.0 });
    candidates.max_by(|a, b| moved(a).total_cmp(&moved(b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A limit of speed that was 3.5 standard deviations worse than one of torque was said to be none that logs can tell from it.
    #[test]
    fn what_is_clearly_worse_is_told_apart_unless_it_is_simpler() {
        let near = 0.5 * EQUAL_DEVIANCE;
        assert!(stands_as_well(near, 0.3, 0.5, false) && stands_as_well(near, 1.9, 0.5, false));
        assert!(!stands_as_well(near, 3.5, 0.5, false));
        // Its score has what the other one has more in it.
        assert!(stands_as_well(near, 3.5, 0.5, true));
        assert!(stands_as_well(40.0, 1.0, 0.01, false) && !stands_as_well(40.0, 1.0, 0.1, false));
        assert!(!stands_as_well(40.0, 3.5, 0.01, true));
        assert!(complexity(EffectId::Delay) < complexity(EffectId::SensorDelay));
        assert!(complexity(EffectId::TorqueLimit) < complexity(EffectId::SpeedLimit));
    }
}
