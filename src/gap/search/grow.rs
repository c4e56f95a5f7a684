//! Several causes at once: sets of effects are grown, their members exchanged, and needless ones dropped.
//!
//! Each step sees what every effect would change beyond what the hypothesis can take up, refits the best ones in full, by
//! themselves and in pairs (neither of which need help alone), and keeps what explains most. Nothing is judged on frozen
//! numbers.

use super::explore::{explore, explore_rivals, refitted};
use super::kin::is_kin;
use super::pairs::pairs;
use super::sight::Sight;
use crate::fit::Budget;
use crate::gap::hypothesis::evidence::{Evidence, counts};
use crate::gap::hypothesis::folds::Folds;
use crate::gap::hypothesis::held_out::Elsewhere;
use crate::gap::hypothesis::model::COULOMB;
use crate::gap::hypothesis::score::Measure;
use crate::gap::hypothesis::trial::{AGAIN, Trial};
use crate::joint::{EffectForm, EffectId};
use crate::number::math;
use crate::progress::{Progress, Step};
use rayon::prelude::*;

/// Most causes of an answer.
pub(in crate::gap) const MOST: usize = 6;
/// Evaluations of a fit that begins near its end while a set still grows; a grown one is fitted [`AGAIN`].
const GROWING: Budget = Budget { evaluations: 14 };
/// A step has to lower the square sum to this share, and by this deviance if every so many samples count as one.
const STEP: f64 = 0.96;
const STEP_DEVIANCE: f64 = 24.0;
const STEP_SAMPLES: f64 = 10.0;
/// Where the best single effect lowers the square sum to no less than this share, pairs are tried too.
const FEEBLE: f64 = 0.5;
/// Steps that are made once motor side and link move apart.
const APART: usize = 1;
/// Causes that part motor side and link have to lower the square sum by so much more than others.
const IMITATES: f64 = 4.0;
/// Logarithm of the square sum by which others of as many causes may be behind the best to be brought to rest beside it.
const CLOSE_BY: f64 = 0.2;
/// Single effects whose forms contend.
const CONTENDERS: usize = 3;
/// Rivals that are kept for each member.
const RIVALS: usize = 4;

/// Grows sets of effects on a study.
pub(in crate::gap) struct Growth<'a> {
    pub evidence: &'a Evidence,
    /// The catalogue that is considered.
    pub effects: &'a [EffectId],
    /// The numbers as given.
    pub as_given: &'a [f64],
    /// Squares sum to this where nothing but noise is left \[rad^2\].
    pub enough: f64,
    /// Who wants to know how far it is; a growth that is no longer wanted ends with what it has.
    pub progress: &'a dyn Progress,
}

/// What is seen of single effects from a hypothesis.
#[derive(Default)]
pub(in crate::gap) struct Looked {
    /// Each that promises something fitted with it, best first.
    pub singles: Vec<Trial>,
    /// All of them from afar.
    pub sights: Vec<Sight>,
}

/// A set without needless members.
pub(in crate::gap) struct Pruned {
    pub best: Trial,
    /// The same without each of its members, fitted again.
    pub without: Vec<Trial>,
}

impl Growth<'_> {
    /// The set that explains most, grown from a hypothesis; and what was seen on the way, where the hypothesis had no effects
    /// and a step was made.
    pub fn from(&self, start: &Trial) -> (Trial, Looked) {
        let mut best = start.clone();
        let mut looked = Looked::default();
        let mut apart = 0;
        while best.effects().len() < MOST && best.fit_loss(self.evidence) > self.enough && apart < APART {
            let done = best.effects().len();
            if self.late("further causes") {
                break;
            }
            if self.progress.go_on(Step { stage: "trying causes", done, of: MOST }).is_err() {
                break;
            }
            apart += usize::from(best.model.has_two_bodies());
            let (grown, here) = self.step(&best);
            if best.effects().is_empty() {
                looked = here;
            }
            let Some(grown) = grown else { break };
            best = self.reshaped(self.shaken(grown), done);
        }
        (best, looked)
    }

    /// The best of a fit and of those that begin with other friction: where a joint sticks the criterion has a kink for
    /// every stop that comes or goes, and between two kinks there may be a minimum of its own.
    fn shaken(&self, fitted: Trial) -> Trial {
        if fitted.fit_loss(self.evidence) < SHAKE * self.enough || self.late("fits from other friction") {
            return fitted;
        }
        let again = |factor: &f64| {
            let mut values = fitted.found.values.clone();
            values[COULOMB] = values[COULOMB].max(1e-3 * self.evidence.reach.torque_nm) * factor;
            Trial::solved(self.evidence, fitted.model.clone(), &values, fitted.found.starts.clone(), LOOK)
        };
        let others: Vec<Trial> = FACTORS.par_iter().map(again).collect();
        let best = others.into_iter().min_by(|a, b| a.criterion().total_cmp(&b.criterion()));
        let best =
            best.filter(|t| t.criterion() < NEARLY * fitted.criterion()).map(|t| t.continued(self.evidence, GROWING));
        best.filter(|t| t.criterion() < fitted.criterion()).unwrap_or(fitted)
    }

    /// The best hypothesis with one effect more, or two, that lowers what is left, brought to rest; and what was seen of all
    /// with one more.
    fn step(&self, from: &Trial) -> (Option<Trial>, Looked) {
        let others = self.others(from);
        let sights = self.sights(from, &others);
        let singles = explore(self.evidence, from, &sights);
        let rival = if from.effects().is_empty() { self.contended(&singles) } else { None };
        let loss = |t: &Trial| t.fit_loss(self.evidence);
        let before = loss(from);
        let best = singles.iter().chain(&rival).map(loss).fold(f64::INFINITY, f64::min);
        let feeble = best > FEEBLE * before && best > self.enough;
        // Later on pairs are for where no single one helps.
        let helps = !from.effects().is_empty() && singles.first().is_some_and(|best| self.lowers(from, best));
        let tries_pairs = feeble && !helps && from.effects().len() + 2 <= MOST;
        let together =
            if tries_pairs && !self.late("pairs of causes") { pairs(self.evidence, from, &sights) } else { Vec::new() };
        // Two have to do more than one: their share of the step is weighed as that of two steps. Motor side and link
        // apart can imitate much, and nothing is easily added to them.
        let worth = |t: &Trial| {
            let added = (t.effects().len() - from.effects().len()).max(1) as f64;
            let apart = if t.model.has_two_bodies() { IMITATES } else { 1.0 };
            math::ln((apart * loss(t) / before).max(1e-12)) / added.sqrt()
        };
        let settled_of = |all: &[&Trial]| {
            let mut all = all.to_vec();
            all.sort_by(|a, b| worth(a).total_cmp(&worth(b)));
            let alike = |t: &Trial| {
                (t.effects().len(), t.model.has_two_bodies()) == (all[0].effects().len(), all[0].model.has_two_bodies())
            };
            let near = all.iter().take_while(|t| worth(t) - worth(all[0]) < CLOSE_BY);
            let near = near.filter(|t| alike(t) && self.lowers(from, t)).take(CONTENDERS);
            self.settled(&near.copied().collect::<Vec<_>>())
        };
        let found = settled_of(&singles.iter().chain(&rival).chain(&together).collect::<Vec<_>>());
        let best = found.or_else(|| {
            // Where none helps in its default formula, the right ones may in another.
            let few = singles.iter().take(CONTENDERS).chain(together.iter().take(CONTENDERS));
            let in_form = self.in_best_forms(few, from.effects().len());
            let helps = settled_of(&in_form.iter().collect::<Vec<_>>());
            helps.or_else(|| settled_of(&self.off_centre(from).iter().collect::<Vec<_>>()))
        });
        (best, Looked { singles, sights })
    }

    /// With an encoder that is off its centre: nothing like the gain that it is a form of, and not found from there.
    fn off_centre(&self, from: &Trial) -> Vec<Trial> {
        let form = EffectForm::named_so(EffectId::SensorGain, Some(OFF_CENTRE)).expect("a form of the catalogue");
        if from.model.has_two_bodies() || !self.others(from).contains(&form.id) || self.late(FORMS) {
            return Vec::new();
        }
        let added = |start: Vec<f64>| (vec![form], [&from.found.values[..], &start].concat());
        let starts = form.starts(&self.evidence.reach).into_iter().map(added);
        refitted(self.evidence, from, starts.collect(), f64::INFINITY)
    }

    /// Those that do not part motor side and link, where much is left, with the causes from number `from` on in the forms
    /// that suit them.
    fn in_best_forms<'a>(&self, few: impl Iterator<Item = &'a Trial>, from: usize) -> Vec<Trial> {
        let few: Vec<&Trial> = few.filter(|t| !t.model.has_two_bodies()).collect();
        few.into_par_iter().map(|t| self.reshaped(t.clone(), from)).collect()
    }

    /// The best of those that come near it, each brought to rest with beliefs in the unit of its own residuals: in that of the
    /// hypothesis from which it was grown they weigh too much.
    fn settled(&self, near: &[&Trial]) -> Option<Trial> {
        let settled: Vec<Trial> = near.par_iter().map(|t| (*t).clone().settled(self.evidence, AGAIN)).collect();
        let measure = Measure::by(self.evidence, settled.first()?);
        let score = |t: &Trial| measure.score(self.evidence, t);
        settled.into_iter().min_by(|a, b| score(a).total_cmp(&score(b)))
    }

    /// The effect that explains the logs best once the best few are in the forms that suit them, where that is not the first
    /// of them: in its default formula the right family may be behind a wrong one.
    fn contended(&self, singles: &[Trial]) -> Option<Trial> {
        let in_form = self.in_best_forms(singles.iter().take(CONTENDERS), 0);
        let best =
            in_form.into_iter().min_by(|a, b| a.fit_loss(self.evidence).total_cmp(&b.fit_loss(self.evidence)))?;
        (best.effects() != singles[0].effects()).then_some(best)
    }

    pub(in crate::gap) fn late(&self, for_what: &'static str) -> bool {
        self.evidence.deadline.leaves_out(for_what)
    }

    pub(in crate::gap) fn others(&self, from: &Trial) -> Vec<EffectId> {
        self.effects.iter().copied().filter(|e| !from.effects().contains(e)).collect()
    }

    /// What effects would change, seen from a hypothesis and from the numbers as given.
    pub fn sights(&self, from: &Trial, effects: &[EffectId]) -> Vec<Sight> {
        // What is missing may have bent the numbers; once a cause is found they are near the truth.
        let also = if from.effects().is_empty() { vec![self.as_given.to_vec()] } else { Vec::new() };
        Sight::from_each(self.evidence, from, &also, effects)
    }

    fn lowers(&self, from: &Trial, to: &Trial) -> bool {
        let (before, after) = (from.fit_loss(self.evidence), to.fit_loss(self.evidence));
        let samples: f64 = self.evidence.fit.iter().map(|e| counts(e).sum::<f64>()).sum();
        let explained = samples / STEP_SAMPLES * math::ln(before / after.max(1e-300));
        // Numbers that come back to what is believed of them speak for a cause as well.
        after < STEP * before && explained + (from.strain() - to.strain()).max(0.0) > STEP_DEVIANCE
    }

    /// Without the members that others have made needless; and the same without each of those that stay.
    pub fn pruned(&self, mut best: Trial) -> Pruned {
        let mut without = self.without_each(&best);
        while best.effects().len() > 1 {
            let measure = Measure::by(self.evidence, &best);
            let score = measure.score(self.evidence, &best);
            let scores: Vec<f64> = without.iter().map(|t| measure.score(self.evidence, t)).collect();
            match (0..scores.len()).min_by(|a, b| scores[*a].total_cmp(&scores[*b])) {
                Some(k) if scores[k] <= score => best = without.swap_remove(k),
                _ => break,
            }
            without = self.without_each(&best);
        }
        Pruned { best, without }
    }

    /// A hypothesis without each of its effects in turn, fitted again.
    pub fn without_each(&self, best: &Trial) -> Vec<Trial> {
        (0..best.effects().len()).into_par_iter().map(|k| best.without(self.evidence, k, GROWING)).collect()
    }

    /// For each member, the sets in which another effect stands in its place, best first; `without` are the sets that
    /// lack it.
    pub fn rivals(&self, best: &Trial, without: &[Trial]) -> Vec<Vec<Trial>> {
        let of = |(k, without): (usize, &Trial)| {
            if self.late("other causes in the place of each") {
                return Vec::new();
            }
            let member = best.effects()[k];
            let mut others: Vec<EffectId> = self.others(best);
            if without.model.has_two_bodies() {
                // Each costs many times as much: what is easily taken for the member, and no more.
                others.retain(|other| is_kin(member, *other));
                if others.is_empty() {
                    return Vec::new();
                }
            }
            let sights = self.sights(without, &others);
            let mut found = explore_rivals(self.evidence, without, (&sights, &others), (k, best));
            found.retain(|t| !t.effects().contains(&member));
            // In its default formula what is easily taken for the member may be behind without being wrong, and where
            // something is left so may anything.
            let left = best.fit_loss(self.evidence) / self.enough;
            let all_contend = left > SOMETHING && !without.model.has_two_bodies();
            if !all_contend || left < SHAKE {
                found.truncate(RIVALS);
            }
            let in_form = |t: Trial| {
                let last = t.effects().len() - 1;
                let contends = all_contend || is_kin(member, t.effects()[last]);
                if contends && !self.late(FORMS) { self.in_best_form(t, last) } else { t }
            };
            let mut found: Vec<Trial> = found.into_par_iter().map(in_form).collect();
            found.sort_by(|a, b| a.criterion().total_cmp(&b.criterion()));
            found.truncate(RIVALS);
            found
        };
        without.iter().enumerate().map(of).collect()
    }

    /// The same with members exchanged where something simpler explains the logs as well, or anything better.
    pub fn exchanged(&self, pruned: Pruned) -> (Pruned, Vec<Vec<Trial>>) {
        let Pruned { mut best, mut without } = pruned;
        let mut rivals = self.rivals(&best, &without);
        for round in 0..=EXCHANGES {
            let measure = Measure::by(self.evidence, &best);
            let score = |t: &Trial| measure.score(self.evidence, t);
            let allowed = |t: &&Trial| {
                let behind = score(t) - score(&best);
                if round == 0 { is_simpler(t, &best) && behind < AS_WELL } else { behind < -EXCHANGE }
            };
            let others = rivals.iter().flatten().filter(allowed);
            match others.min_by(|a, b| score(a).total_cmp(&score(b))) {
                Some(other) => {
                    Pruned { best, without } = self.pruned(other.clone().settled(self.evidence, AGAIN));
                    rivals = self.rivals(&best, &without);
                }
                None if round > 0 => break,
                None => {}
            }
        }
        (Pruned { best, without }, rivals)
    }

    /// The same causes in the forms that explain the logs best: the formula is a detail that the evidence picks.
    pub fn formed(&self, mut best: Trial) -> Trial {
        for k in 0..best.effects().len() {
            if self.late(FORMS) {
                break;
            }
            if let Some(other) = self.in_other_form(&best, k)
                && self.predicts(&other, &best)
            {
                best = other;
            }
            if !best.model.forms()[k].is_default() {
                let plain = best.in_form(self.evidence, k, best.effects()[k].into(), FORMING);
                if !self.predicts(&best, &plain) {
                    best = plain;
                }
            }
        }
        best
    }

    /// The causes from number `from` on in the forms that explain the logs best, where much is left: what the wrong
    /// formula leaves would be taken for further causes.
    pub(in crate::gap) fn reshaped(&self, mut best: Trial, from: usize) -> Trial {
        for k in from..best.effects().len() {
            if best.fit_loss(self.evidence) > SHAKE * self.enough && !self.late(FORMS) {
                best = self.in_best_form(best, k);
            }
        }
        best
    }

    fn in_best_form(&self, trial: Trial, k: usize) -> Trial {
        self.in_other_form(&trial, k).unwrap_or(trial)
    }

    /// Cause number `k` in the form that explains the logs clearly better than its own, if there is one.
    fn in_other_form(&self, best: &Trial, k: usize) -> Option<Trial> {
        let measure = Measure::by(self.evidence, best);
        let own = best.model.forms()[k];
        let others: Vec<EffectForm> = best.effects()[k].forms().filter(|form| *form != own).collect();
        let tried: Vec<Trial> =
            others.into_par_iter().map(|form| best.in_form(self.evidence, k, form, FORMING)).collect();
        let score = |t: &Trial| measure.score(self.evidence, t);
        let other = tried.into_iter().min_by(|a, b| score(a).total_cmp(&score(b)))?;
        (score(&other) < score(best) - FORM).then_some(other)
    }

    /// Whether one form predicts parts of the logs, and whole logs, better than another.
    fn predicts(&self, other: &Trial, best: &Trial) -> bool {
        let folds = Folds::of(self.evidence);
        let better = folds.difference(&folds.residuals(best), &folds.residuals(other));
        let effective = Measure::by(self.evidence, other).effective;
        better.sum > 0.0
            && (self.evidence.fit.len() == 1
                || !self.evidence.held.is_empty()
                || Elsewhere::of(self.evidence, best, other, effective).no_worse(better.z()))
    }

    /// Sets carried over from other samples or parts of the same logs, fitted again here.
    pub fn carried(&self, base: &Trial, found: &[Trial]) -> Vec<Trial> {
        let candidates = found.iter().map(|t| (t.model.forms().to_vec(), t.found.values.clone())).collect();
        refitted(self.evidence, base, candidates, f64::INFINITY)
    }
}

/// How an encoder is that reads once a turn too much and too little.
const OFF_CENTRE: &str = "eccentric";
/// What is left out where forms are.
const FORMS: &str = "other forms of causes";
/// Factors on the Coulomb friction that are tried, where a fit leaves more than this many times what is enough.
pub(in crate::gap) const FACTORS: [f64; 4] = [0.4, 0.75, 1.35, 2.5];
const SHAKE: f64 = 3.0;
/// The same from which on something is left.
const SOMETHING: f64 = 1.1;
/// Evaluations with which each of them is looked at, and how near the fit the best has to come to be carried on.
pub(in crate::gap) const LOOK: Budget = Budget { evaluations: 7 };
const NEARLY: f64 = 1.05;
/// Evaluations with which another form is fitted.
const FORMING: Budget = Budget { evaluations: 30 };
/// Score by which another form has to be better to be stated.
const FORM: f64 = 6.0;
/// Score by which an exchange has to be better to be worth another round, and how many of them there are.
const EXCHANGE: f64 = 2.0;
const EXCHANGES: usize = 3;
/// Score by which something simpler may be behind.
const AS_WELL: f64 = 3.0;

/// Whether a set has a late setpoint where another has a late reading, which changes the loop as well.
fn is_simpler(other: &Trial, than: &Trial) -> bool {
    let [delay, sensor] = [EffectId::Delay, EffectId::SensorDelay];
    let has = |t: &Trial, e| t.effects().contains(&e);
    has(other, delay) && has(than, sensor) && !has(other, sensor)
}
