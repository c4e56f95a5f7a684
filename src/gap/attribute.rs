//! Which effect: the joint as given, recalibrated, with each effect, and with a second one.

use super::compare::{correlation_length, difference};
use super::evidence::{Evidence, counts};
use super::explore::{explore, one_of_each, refitted};
use super::floor::noise_rad;
use super::model::GapModel;
use super::pairs::pairs;
use super::sight::Sight;
use super::trial::Trial;
use crate::fit::Budget;
use crate::identify::{Experiment, Problem, candidates, ranked};
use crate::joint::EffectId;
use rayon::prelude::*;

/// All hypotheses that were fitted.
pub(super) struct Attribution {
    /// The joint as given.
    pub given: Trial,
    /// Its four numbers refitted.
    pub calibrated: Trial,
    /// With one effect each, best score first.
    pub firsts: Vec<Trial>,
    /// With two effects each, best score first; empty where one leaves nothing to explain.
    pub seconds: Vec<Trial>,
    /// Standard deviation of the sensor's own noise \[rad\].
    pub noise_rad: f64,
    /// How many successive residuals of the best hypothesis count as one.
    pub correlation: f64,
}

/// Firsts from which a second effect is sought.
const FIRSTS: usize = 2;
/// Pairs of each first that are kept.
const PAIRS: usize = 3;
/// A hypothesis is carried over to all samples where its criterion is below the best one's times this.
const SERIOUS: f64 = 4.0;
/// At the most so many single effects are carried over.
const MOST: usize = 6;
/// Evaluations of a fit that begins near its end.
const AGAIN: Budget = Budget { evaluations: 24 };
/// The same share, from which on the search may have ended in a wrong place.
const FAR: f64 = 0.12;
/// Held-out logs show more where they exceed the noise by this many times as much as the fitted ones.
const SHOWS_MORE: f64 = 6.0;
/// A hypothesis whose squared residuals exceed the noise by this share leaves something to explain.
pub(super) const LEFT_OVER: f64 = 0.04;

impl Attribution {
    /// Fits all hypotheses about a study; `effects` is the catalogue that is considered.
    ///
    /// Everything is tried on fewer samples first; only what comes near the best is fitted to all of them.
    pub fn of(evidence: &Evidence, effects: &[EffectId], progress: &(dyn Fn(&str) + Sync)) -> Self {
        let coarse = evidence.coarse();
        let baseline = GapModel::baseline(&evidence.nominal, evidence.rest_rad, &evidence.reach);
        progress("the joint as given");
        let given = Trial::as_given(&coarse, &baseline);
        progress("recalibrating");
        let calibrated = calibrate(&coarse, &baseline, &given);
        progress("trying one effect");
        let mut this =
            Self { given, calibrated, firsts: Vec::new(), seconds: Vec::new(), noise_rad: 0.0, correlation: 1.0 };
        let as_given = this.given.found.values.clone();
        let sights = Sight::from_each(&coarse, &this.calibrated, std::slice::from_ref(&as_given), effects);
        this.firsts = explore(&coarse, &this.calibrated, &sights);
        // A baseline that has been in the wrong place shows when an effect that found the right one is dropped.
        let dropped = |t: &Trial, k: usize| t.without(&coarse, &baseline, k, AGAIN);
        let again: Vec<Trial> = this.firsts.par_iter().take(PAIRS).map(|t| dropped(t, 0)).collect();
        for trial in again {
            if trial.criterion() < 0.999 * this.calibrated.criterion() {
                this.calibrated = trial;
            }
        }
        this.measure(&coarse);
        if this.leaves(&coarse, LEFT_OVER) {
            progress("trying a second effect");
            let together = pairs(&coarse, &this.calibrated, &sights);
            let seconds = this.firsts.iter().take(FIRSTS).flat_map(|first| {
                let others: Vec<EffectId> = effects.iter().copied().filter(|e| !first.effects().contains(e)).collect();
                let mut also = as_given.clone();
                also.extend(&first.found.values[first.model.place(0)]);
                let sights = Sight::from_each(&coarse, first, &[also], &others);
                let mut found = explore(&coarse, first, &sights);
                found.truncate(PAIRS);
                found
            });
            this.seconds = one_of_each(seconds.chain(together).collect());
            this.seconds.truncate(2 * PAIRS);
            if this.leaves(&coarse, FAR) {
                progress("looking at short parts of the logs");
                this.seek_in_short_parts(&coarse, &baseline, effects);
            }
            let singles: Vec<Trial> =
                this.seconds.par_iter().take(PAIRS).flat_map(|t| [dropped(t, 0), dropped(t, 1)]).collect();
            this.firsts.extend(singles);
            this.firsts = one_of_each(std::mem::take(&mut this.firsts));
        }
        progress("the serious ones on all samples");
        this.on_all_samples(evidence);
        this
    }

    /// Seeks effects and pairs of them on short parts of the logs, and carries what is found there over to whole ones.
    fn seek_in_short_parts(&mut self, coarse: &Evidence, baseline: &GapModel, effects: &[EffectId]) {
        let short = coarse.in_parts();
        let given = Trial::as_given(&short, baseline);
        let mut calibrated = calibrate(&short, baseline, &given);
        // Fitted starts hide what is missing; those that the readings show do not.
        calibrated.found.starts = short.fit.iter().map(|e| e.start_coordinates(&e.start)).collect();
        let sights = Sight::from_each(&short, &calibrated, std::slice::from_ref(&given.found.values), effects);
        let found = [explore(&short, &calibrated, &sights), pairs(&short, &calibrated, &sights)];
        for (found, known) in found.into_iter().zip([&mut self.firsts, &mut self.seconds]) {
            let line = found.first().map_or(0.0, |best| SERIOUS * best.criterion());
            let serious = found.into_iter().take(PAIRS).filter(|t| t.criterion() < line);
            let candidates = serious.map(|t| (t.effects().to_vec(), t.found.values)).collect();
            known.extend(refitted(coarse, &self.calibrated, candidates));
            *known = one_of_each(std::mem::take(known));
        }
        self.seconds.truncate(2 * PAIRS);
        self.measure(coarse);
    }

    /// Carries what may matter over to all samples, and predicts the held-out logs.
    fn on_all_samples(&mut self, evidence: &Evidence) {
        let near = |best: f64, t: &Trial| t.criterion() < SERIOUS * best;
        let best = self.firsts.first().map_or(f64::INFINITY, Trial::criterion);
        let seconds_best = self.seconds.first().map_or(f64::INFINITY, Trial::criterion);
        self.firsts.truncate(self.firsts.iter().position(|t| !near(best, t)).unwrap_or(usize::MAX).clamp(2, MOST));
        self.seconds.truncate(self.seconds.iter().position(|t| !near(seconds_best, t)).unwrap_or(usize::MAX).min(3));
        let mut given = self.given.on(evidence, AGAIN);
        given.predict(evidence, None);
        let mut calibrated = self.calibrated.on(evidence, AGAIN);
        calibrated.predict(evidence, Some(&given));
        for trials in [&mut self.firsts, &mut self.seconds] {
            trials.par_iter_mut().for_each(|t| {
                *t = t.on(evidence, AGAIN);
                t.predict(evidence, Some(&calibrated));
            });
        }
        (self.given, self.calibrated) = (given, calibrated);
        self.measure(evidence);
    }

    /// Noise and correlation as the hypotheses so far show them; then the best come first.
    fn measure(&mut self, evidence: &Evidence) {
        let all: Vec<&Trial> =
            [&self.given, &self.calibrated].into_iter().chain(&self.firsts).chain(&self.seconds).collect();
        self.noise_rad = noise_rad(evidence, &all);
        self.rank(evidence);
    }

    /// Whether the best hypothesis leaves more than this share above the noise.
    fn leaves(&self, evidence: &Evidence, share: f64) -> bool {
        let all = [&self.calibrated].into_iter().chain(&self.firsts).chain(&self.seconds);
        let best = all.map(|t| self.excess(evidence, t));
        best.fold(f64::INFINITY, f64::min) > share
    }

    fn rank(&mut self, evidence: &Evidence) {
        let best = self.firsts.iter().chain(&self.seconds).min_by(|a, b| a.criterion().total_cmp(&b.criterion()));
        self.correlation = best.map_or(1.0, |t| correlation_length(evidence, t));
        let (mut firsts, mut seconds) = (std::mem::take(&mut self.firsts), std::mem::take(&mut self.seconds));
        firsts.sort_by(|a, b| self.score(evidence, a).total_cmp(&self.score(evidence, b)));
        seconds.sort_by(|a, b| self.score(evidence, a).total_cmp(&self.score(evidence, b)));
        (self.firsts, self.seconds) = (firsts, seconds);
    }

    /// Deviance of a hypothesis over fitted and held-out logs, with a charge for its parameters; less is better.
    pub fn score(&self, evidence: &Evidence, trial: &Trial) -> f64 {
        let unit = self.noise_rad.powi(2) * self.correlation;
        let samples: f64 = evidence.fit.iter().map(|e| counts(e).sum::<f64>()).sum::<f64>() / self.correlation;
        let charge = trial.model.free() as f64 * samples.max(2.0).ln();
        (trial.fit_loss(evidence) + trial.held_loss(evidence)) / unit + charge
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
        let all = [&self.calibrated].into_iter().chain(&self.firsts).chain(&self.seconds);
        let best = all.min_by(|a, b| self.score(evidence, a).total_cmp(&self.score(evidence, b)));
        let [held, fitted] = best.map_or([0.0; 2], |t| self.excess_apart(evidence, t));
        held > SHOWS_MORE * (fitted.max(0.0) + LEFT_OVER)
    }

    /// How many standard deviations `a` explains all logs worse than `b`.
    pub fn behind(&self, evidence: &Evidence, a: &Trial, b: &Trial) -> f64 {
        difference(evidence, a, b).z()
    }
}

/// The four numbers refitted, from several starts: as given, from smoothed accelerations and short parts of the logs,
/// and with friction and inertia changed by factors.
fn calibrate(evidence: &Evidence, baseline: &GapModel, given: &Trial) -> Trial {
    let problem = Problem::new(baseline, &evidence.fit);
    let starts: Vec<Vec<f64>> = ranked(&problem, candidates(baseline, &evidence.fit)).into_iter().take(4).collect();
    let from_given = given.found.values.clone();
    let brief: Vec<Trial> = starts
        .par_iter()
        .map(|x| problem.values(x))
        .chain([from_given])
        .map(|values| Trial::solved(evidence, baseline.clone(), &values, given.found.starts.clone(), AGAIN))
        .collect();
    let best = brief.into_iter().min_by(|a, b| a.criterion().total_cmp(&b.criterion()));
    best.unwrap_or_else(|| given.clone())
}
