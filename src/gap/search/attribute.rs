//! Which causes: the joint as given, recalibrated within its beliefs, and with the set of effects that explains most.

use super::explore::one_of_each;
use super::grow::Growth;
use super::judged::Judged;
use super::laws::{Lawful, lawful};
use super::refuted::{predicts_clearly_worse, refuted_by, refutes};
use super::searched::{FAR, Known, LEFT_OVER, Searched, counted};
use crate::gap::hypothesis::compare::difference;
use crate::gap::hypothesis::evidence::{Evidence, counts};
use crate::gap::hypothesis::floor::noise_rad;
use crate::gap::hypothesis::model::BASELINE;
use crate::gap::hypothesis::score::Measure;
use crate::gap::hypothesis::trial::{AGAIN, Trial};
use crate::identify::Experiment;
use crate::joint::EffectId;
use crate::progress::{Cancelled, Progress, Step};
use rayon::prelude::*;

/// All hypotheses that were fitted.
pub(in crate::gap) struct Attribution {
    /// The joint as given.
    pub given: Trial,
    /// Its numbers refitted within their beliefs.
    pub calibrated: Trial,
    /// With the causes that were found, in the order of what they close; the recalibrated joint where there are none.
    pub best: Trial,
    /// The recalibrated joint with the first cause, the first two, and so on; the last is the best.
    pub ladder: Vec<Trial>,
    /// For each cause: the recalibrated joint with it alone.
    pub alone: Vec<Trial>,
    /// For each cause: the best without it.
    pub without: Vec<Trial>,
    /// For each cause: the best with another effect in its place, best first.
    pub rivals: Vec<Vec<Trial>>,
    /// With one effect each, best first.
    pub firsts: Vec<Trial>,
    /// The best with a law beside its causes, where one predicts what the causes leave.
    pub law: Option<Trial>,
    /// A law that parts of logs show, where whole logs bear none out.
    hint: Option<Trial>,
    /// Causes that the fitted logs ask for and the held-out ones refute.
    pub refuted: Vec<EffectId>,
    /// Whether they refute a law that the fitted logs ask for.
    pub law_refuted: bool,
    /// Whether they refute another set of causes that the fitted logs ask for.
    pub set_refuted: bool,
    /// Whether a cause stays for how they are predicted with it.
    borne_out: bool,
    /// Standard deviation of the sensor's own noise \[rad\].
    pub noise_rad: f64,
    /// How many successive residuals of the best hypothesis count as one.
    pub correlation: f64,
}

/// A single effect is carried over to all samples where its criterion is below the best one's times this.
const SERIOUS: f64 = 4.0;
/// At the most so many single effects are carried over.
const MOST: usize = 6;
/// Held-out logs show more where they exceed the noise by this many times as much as the fitted ones, and these hardly
/// do; or by this many times as much anyway.
const SHOWS_MORE: f64 = 6.0;
const SHOWS_MUCH_MORE: f64 = 50.0;
/// Squared residuals that exceed the noise by this share are worth a law.
const WORTH_A_LAW: f64 = 0.3;
/// Rivals within this score of the best are carried over to all samples.
const NEAR: f64 = 60.0;

impl Attribution {
    /// Fits all hypotheses about a study; `effects` is the catalogue that is considered.
    ///
    /// Everything is tried on fewer samples first; only what comes near the best is fitted to all of them.
    pub fn of(evidence: &Evidence, effects: &[EffectId], progress: &dyn Progress) -> Result<Self, Cancelled> {
        Self::of_searched(evidence, effects, Searched::of(evidence, effects, None, progress)?, progress)
    }

    /// The same, where a set of causes is known that predicts the held-out logs, from which the search begins.
    pub fn begun_with(
        evidence: &Evidence,
        effects: &[EffectId],
        set: &Trial,
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let searched = Searched::of(evidence, effects, Some(set), progress)?;
        let this = Self::of_searched(evidence, effects, searched, progress)?;
        Ok(Self { set_refuted: true, ..this })
    }

    /// The same from what a search found.
    pub fn of_searched(
        evidence: &Evidence,
        effects: &[EffectId],
        searched: Searched,
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let Searched { coarse, as_given, enough, judged, known } = searched;
        let growth = Growth { evidence: &coarse, effects, as_given: &as_given, enough, progress };
        let this = Self::carried(evidence, &growth, &judged, &known, None)?;
        progress.go_on(Step::stage("whether fewer causes predict better"))?;
        let Some(less) = this.fewer_predict(evidence) else { return Ok(this) };
        let gone = this.best.effects().iter().filter(|e| !less.effects().contains(e));
        let refuted = this.refuted.iter().chain(gone).copied().collect();
        let best = less.carried(evidence, &coarse, AGAIN);
        // Without members, what stands in the place of each is looked for again.
        let judged = Judged { best, members: Vec::new(), rivals: Vec::new(), refuted, borne_out: this.borne_out };
        let mut last = Self::carried(evidence, &growth, &judged, &known, Some(&less))?;
        last.law_refuted |= this.law_refuted && last.law.is_none();
        Ok(last)
    }

    /// A set of causes that was judged, with a law beside it where one predicts, carried over to all samples; it may have been
    /// found on these.
    fn carried(
        evidence: &Evidence,
        growth: &Growth<'_>,
        judged: &Judged,
        known: &Known,
        found: Option<&Trial>,
    ) -> Result<Self, Cancelled> {
        let stage = |stage| growth.progress.go_on(Step::stage(stage));
        let coarse = growth.evidence;
        let Known { given, calibrated, mut firsts, noise_rad: noise, set_refuted, law_refuted } = known.clone();
        let Judged { best, members, rivals, mut refuted, borne_out } = judged.clone();
        let samples = counted(coarse);
        refuted.retain(|e| !best.effects().contains(e));
        stage("looking for a law in what is left")?;
        let step_rad = coarse.reach.resolution_rad;
        let leaves_much = best.fit_loss(coarse) > samples * step_rad.max(noise_of_law(noise)).powi(2);
        let worth_a_law = leaves_much && !law_refuted && !evidence.numbers_alone;
        let refutes_it = |law: &Trial| refutes(coarse, evidence, law, &best);
        let Lawful { law, hint, refuted: refutes_one } =
            if worth_a_law && !evidence.deadline.leaves_out("a law in what is left") {
                lawful(coarse, &best, &calibrated, &refutes_it)
            } else {
                Lawful::default()
            };
        let law_refuted = law_refuted || refutes_one;
        let best = match &law {
            Some(law) if law.effects().len() < best.effects().len() => {
                let kept: Vec<usize> =
                    (0..best.effects().len()).filter(|k| law.effects().contains(&best.effects()[*k])).collect();
                best.keeping(coarse, &kept, AGAIN)
            }
            _ => best,
        };
        // What was exchanged is proven, and what is proven is not exchanged again: its rivals are looked at only.
        let without = growth.without_each(&best);
        let rivals = if best.effects() == members { rivals } else { growth.rivals(&best, &without) };
        if best.effects().len() == 1 && !firsts.iter().any(|t| t.effects() == best.effects()) {
            firsts.push(best.clone());
        }
        firsts = one_of_each(firsts);
        let mut this = Self {
            given,
            calibrated,
            ladder: Vec::new(),
            alone: Vec::new(),
            without,
            rivals,
            firsts,
            law,
            hint: hint.map(|hint| hint.law),
            refuted,
            law_refuted,
            set_refuted,
            borne_out,
            noise_rad: noise,
            correlation: 1.0,
            best,
        };
        stage("the serious ones on all samples")?;
        // A law may have taken the place of some of the causes.
        this.on_all_samples(evidence, found.filter(|t| t.effects() == this.best.effects()).cloned());
        // Where it has come to rest on all samples a law may predict worse than on the way there.
        if this.law.as_ref().is_some_and(|law| is_refuted(evidence, coarse, law, &this.best, &judged.best)) {
            let bare = Self::carried(evidence, growth, judged, &Known { law_refuted: true, ..known.clone() }, found)?;
            return Ok(Self { hint: this.law, ..bare });
        }
        Ok(this)
    }

    /// Some of the causes alone, where held-out logs are predicted clearly better by these than by all of them at the place
    /// in which they came to rest, and no law stands beside them.
    fn fewer_predict(&self, evidence: &Evidence) -> Option<Trial> {
        if self.law.is_some() {
            return None;
        }
        let all = self.best.effects();
        let is_less = |t: &&Trial| {
            (1..all.len()).contains(&t.effects().len()) && t.effects().iter().all(|effect| all.contains(effect))
        };
        // With one cause from the beginning another place, in another form, may predict better.
        let fewer = self
            .alone
            .iter()
            .chain(self.ladder.iter().skip(1))
            .chain(&self.without)
            .chain(&self.firsts)
            .filter(is_less);
        refuted_by(evidence, &self.best, &fewer.collect::<Vec<_>>()).cloned()
    }

    /// Carries what may matter over to all samples, and predicts the held-out logs; the best may be `found` on them already.
    fn on_all_samples(&mut self, evidence: &Evidence, found: Option<Trial>) {
        let line = self.firsts.first().map_or(f64::INFINITY, |best| SERIOUS * best.criterion());
        self.firsts.retain(|t| t.criterion() < line);
        self.firsts.truncate(MOST);
        if evidence.deadline.cuts("other causes on all samples") {
            self.firsts.clear();
            self.rivals.iter_mut().for_each(Vec::clear);
        }
        let coarse = evidence.coarse();
        let measure = Measure::by(&coarse, &self.best);
        let score = measure.score(&coarse, &self.best);
        for rivals in &mut self.rivals {
            rivals.retain(|t| measure.score(&coarse, t) < score + NEAR);
        }
        let these = [&mut self.given, &mut self.calibrated, &mut self.best].into_iter().chain(&mut self.law);
        let others = self.without.iter_mut().chain(&mut self.firsts).chain(self.rivals.iter_mut().flatten());
        these.chain(others).for_each(|t| t.begin_as(&coarse, evidence));
        if let Some(found) = found {
            self.best = found;
        }
        let mut given = self.given.on(evidence, AGAIN);
        given.predict(evidence, None);
        let mut calibrated = self.calibrated.on(evidence, AGAIN);
        calibrated.predict(evidence, Some(&given));
        (self.given, self.calibrated) = (given, calibrated);
        let near = &self.calibrated;
        let there = |t: &mut Trial| {
            *t = t.on(evidence, AGAIN);
            t.predict(evidence, Some(near));
        };
        let there_at_rest = |t: &mut Trial| {
            *t = t.on(evidence, AGAIN).at_rest(evidence, AGAIN);
            t.predict(evidence, Some(near));
        };
        let best = &self.best;
        let by_itself = |k: usize| {
            let alone = best.keeping(evidence, &[k], AGAIN);
            if alone.fit_loss(evidence) < near.fit_loss(evidence) {
                return alone;
            }
            // The numbers that it has beside others may be none from which it finds those that it has without them.
            let values = [&near.found.values[..BASELINE], &best.found.values[best.model.place(k)]].concat();
            let again = Trial::solved(evidence, alone.model.clone(), &values, near.found.starts.clone(), AGAIN);
            if again.fit_loss(evidence) < alone.fit_loss(evidence) { again } else { alone }
        };
        self.alone = (0..best.effects().len()).into_par_iter().map(by_itself).collect();
        there(&mut self.best);
        self.law.iter_mut().for_each(there);
        self.without.par_iter_mut().for_each(there);
        self.firsts.par_iter_mut().for_each(there_at_rest);
        self.rivals.par_iter_mut().for_each(|rivals| rivals.iter_mut().for_each(there));
        self.alone.par_iter_mut().for_each(|t| t.predict(evidence, Some(near)));
        // What was fitted with one cause from the beginning may have found a better place.
        let measure = Measure::by(evidence, &self.best);
        for alone in &mut self.alone {
            let is_less = |t: &Trial| measure.deviance(evidence, t) < measure.deviance(evidence, alone);
            let better = |t: &&Trial| t.effects() == alone.effects() && is_less(t);
            if let Some(first) = self.firsts.iter().find(better) {
                *alone = first.clone();
            }
        }
        // What numbers explain as well without causes, once these have shown them the way, is theirs: along the motion of
        // neighbours the search for them is rugged.
        let bare = self.without.iter().filter(|t| evidence.is_carried() && t.effects().is_empty());
        if let Some(bare) = bare.min_by(|a, b| a.criterion().total_cmp(&b.criterion()))
            && bare.criterion() < self.calibrated.criterion()
        {
            self.calibrated = bare.clone();
        }
        self.in_order(evidence);
        let all: Vec<&Trial> =
            [&self.given, &self.calibrated, &self.best].into_iter().chain(&self.law).chain(&self.firsts).collect();
        self.noise_rad = noise_rad(evidence, &all);
        self.correlation = crate::gap::hypothesis::compare::correlation_length(evidence, &self.best);
        let measure = Measure::by(evidence, &self.best);
        self.firsts.sort_by(|a, b| measure.score(evidence, a).total_cmp(&measure.score(evidence, b)));
        for rivals in &mut self.rivals {
            rivals.sort_by(|a, b| measure.score(evidence, a).total_cmp(&measure.score(evidence, b)));
        }
    }

    /// Puts the causes in the order of what they close, the one that alone closes most first, and fits the sets between.
    fn in_order(&mut self, evidence: &Evidence) {
        let causes = self.best.effects().len();
        let loss = |t: &Trial| t.fit_loss(evidence) + t.held_loss(evidence);
        let mut order: Vec<usize> = (0..causes).collect();
        order.sort_by(|a, b| loss(&self.without[*b]).total_cmp(&loss(&self.without[*a])));
        if let Some(first) = (0..causes).min_by(|a, b| loss(&self.alone[*a]).total_cmp(&loss(&self.alone[*b]))) {
            order.retain(|k| *k != first);
            order.insert(0, first);
        }
        let sorted = self.best.keeping(evidence, &order, AGAIN).settled(evidence, AGAIN);
        let pick = |all: &[Trial]| order.iter().map(|&k| all[k].clone()).collect::<Vec<_>>();
        (self.alone, self.without) = (pick(&self.alone), pick(&self.without));
        self.rivals = order.iter().map(|&k| self.rivals[k].clone()).collect();
        self.best = sorted;
        self.best.predict(evidence, Some(&self.calibrated));
        if let Some(law) = &mut self.law {
            let place = |e: &EffectId| self.best.effects().iter().position(|own| own == e);
            let mut kept: Vec<usize> = (0..law.effects().len()).collect();
            kept.sort_by_key(|k| place(&law.effects()[*k]));
            *law = law.keeping(evidence, &kept, AGAIN);
            law.predict(evidence, Some(&self.calibrated));
        }
        let between: Vec<usize> = (1..causes).collect();
        self.ladder = between
            .into_par_iter()
            .map(|n| {
                if n == 1 {
                    return self.alone[0].clone();
                }
                let kept: Vec<usize> = (0..n).collect();
                let mut t = self.best.keeping(evidence, &kept, AGAIN);
                t.predict(evidence, Some(&self.calibrated));
                t
            })
            .collect();
        if causes > 0 {
            self.ladder.push(self.best.clone());
        }
    }

    /// Score of a hypothesis on the fitted logs; less is better.
    pub fn score(&self, evidence: &Evidence, trial: &Trial) -> f64 {
        Measure::by(evidence, &self.best).score(evidence, trial)
    }

    /// Share by which the squared residuals over all logs exceed the noise.
    pub fn excess(&self, evidence: &Evidence, trial: &Trial) -> f64 {
        let held = if trial.held.is_empty() { &[][..] } else { &evidence.held[..] };
        let samples: f64 = evidence.fit.iter().chain(held).map(|e| counts(e).sum::<f64>()).sum();
        (trial.fit_loss(evidence) + trial.held_loss(evidence)) / (samples * self.noise_rad.powi(2)) - 1.0
    }

    /// Share by which the squared residuals exceed the noise where a hypothesis has to predict, and where it is fitted.
    fn excess_apart(&self, evidence: &Evidence, trial: &Trial) -> [f64; 2] {
        let excess = |experiments: &[Experiment], sum: f64| {
            let samples: f64 = experiments.iter().map(|e| counts(e).sum::<f64>()).sum();
            sum / (samples * self.noise_rad.powi(2)) - 1.0
        };
        [excess(&evidence.held, trial.held_loss(evidence)), excess(&evidence.fit, trial.fit_loss(evidence))]
    }

    /// Whether the held-out logs show something that the best hypothesis was not fitted to, because the logs to be
    /// fitted hardly show it.
    pub fn held_out_shows_more(&self, evidence: &Evidence) -> bool {
        if evidence.held.is_empty() {
            return false;
        }
        let [held, fitted] = self.excess_apart(evidence, self.told());
        // Noise alone may do as much.
        if held < WORTH_A_LAW {
            return false;
        }
        let more = held / (fitted.max(0.0) + LEFT_OVER);
        (fitted < FAR && more > SHOWS_MORE) || more > SHOWS_MUCH_MORE
    }

    /// Share by which the squares of held-out logs exceed the noise.
    pub fn excess_held_out(&self, evidence: &Evidence) -> f64 {
        self.excess_apart(evidence, self.told())[0]
    }

    /// The causes, with a law where one stands beside them.
    pub fn told(&self) -> &Trial {
        self.law.as_ref().unwrap_or(&self.best)
    }

    /// The law that says where to look where the answer has none: it was dropped, or only parts of logs show it.
    pub fn hint(&self) -> Option<&Trial> {
        self.law.as_ref().or(self.hint.as_ref())
    }

    /// Whether held-out logs refute anything that the fitted ones ask for.
    pub fn held_out_refuted(&self) -> bool {
        !self.refuted.is_empty() || self.law_refuted || self.set_refuted
    }

    /// Whether the held-out logs had a say: in the beliefs, in the causes, in the law.
    pub fn held_out_chose(&self, evidence: &Evidence) -> bool {
        evidence.normal_beliefs || self.held_out_refuted() || self.borne_out
    }

    /// How many standard deviations `a` explains all logs worse than `b`.
    pub fn behind(&self, evidence: &Evidence, a: &Trial, b: &Trial) -> f64 {
        difference(evidence, a, b).z()
    }
}

/// Whether a law at rest on all samples predicts held-out logs no better than the causes beside it, or clearly worse than all
/// that there were before it took the place of some.
fn is_refuted(evidence: &Evidence, coarse: &Evidence, law: &Trial, beside: &Trial, before: &Trial) -> bool {
    if !evidence.held.is_empty() && law.held_loss(evidence) >= beside.held_loss(evidence) {
        return true;
    }
    if beside.effects().len() == before.effects().len() {
        return false;
    }
    let mut before = before.carried(coarse, evidence, AGAIN);
    before.predict(evidence, Some(beside));
    predicts_clearly_worse(evidence, law, &before)
}

/// Where residuals stay below this no law is looked for \[rad\].
fn noise_of_law(noise_rad: f64) -> f64 {
    noise_rad * (1.0 + WORTH_A_LAW).sqrt()
}
