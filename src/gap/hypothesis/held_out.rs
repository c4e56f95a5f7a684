//! What hypotheses leave of logs that they were not fitted to.

use super::compare::{Difference, block_samples, blocks};
use super::evidence::Evidence;
use super::folds::Folds;
use super::trial::{Trial, loss, predicted};
use crate::fit::Budget;
use crate::gap::{LOGS_IN_TURN, NOT_HELD_OUT, PARTS_IN_TURN};
use crate::identify::Experiment;
use crate::number::math;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::slice::from_ref as one;

/// Logs, or parts of one, that were held out, in the order of the residuals below.
pub(in crate::gap) struct HeldOut {
    pub experiments: Vec<Experiment>,
    /// How they were held out, in words.
    pub how: &'static str,
    from: From,
}

/// What logs are held out from.
enum From {
    /// From the fit: the study says so.
    Study,
    /// From one another, in turn.
    InTurn,
    /// From nothing: they were fitted with the others, after these so many.
    Pooled(usize),
}

/// Up to so many logs each is also predicted whole by the others, and a cause may not do that worse.
pub(in crate::gap) const FEW_LOGS: usize = 4;

/// Evaluations of a fit without the held-out log; it begins where the fit with it ended.
const WITHOUT_A_LOG: Budget = Budget { evaluations: 10 };

impl HeldOut {
    pub fn of(evidence: &Evidence) -> Self {
        if !evidence.held.is_empty() {
            let how = "predicted by fits to the other logs, as the study says";
            return Self { experiments: evidence.held.clone(), how, from: From::Study };
        }
        let all = &evidence.fit;
        if let Some(from) = evidence.pooled_from {
            return Self { experiments: all[from..].to_vec(), how: NOT_HELD_OUT, from: From::Pooled(from) };
        }
        let how = if all.len() == 1 { PARTS_IN_TURN } else { LOGS_IN_TURN };
        Self { experiments: all.clone(), how, from: From::InTurn }
    }

    /// The fitted logs, each predicted by the others, or the parts of the only one.
    pub fn in_turn(evidence: &Evidence) -> Self {
        Self { experiments: evidence.fit.clone(), how: LOGS_IN_TURN, from: From::InTurn }
    }

    /// Whether no choice was made on these logs.
    pub fn is_outer(&self) -> bool {
        matches!(self.from, From::Study)
    }

    /// Model less reading on every held-out log.
    pub fn residuals(&self, evidence: &Evidence, trial: &Trial) -> Vec<Vec<f64>> {
        match self.from {
            From::Study => return trial.held.clone(),
            From::Pooled(from) => return trial.fit[from..].to_vec(),
            From::InTurn => {}
        }
        let all = &evidence.fit;
        if all.len() == 1 {
            return Folds::of(evidence).residuals(trial);
        }
        (0..all.len()).into_par_iter().map(|k| without_log(evidence, trial, k).1).collect()
    }

    /// Root of the mean squared residual over all held-out samples \[rad\].
    pub fn rms_rad(&self, residuals: &[Vec<f64>]) -> f64 {
        rms(residuals.iter().flatten())
    }

    /// The same of each log; parts of one log are put together again.
    pub fn rms_by_file(&self, residuals: &[Vec<f64>]) -> Vec<(String, f64)> {
        let mut files: Vec<&str> = Vec::new();
        for e in &self.experiments {
            if !files.contains(&e.file.as_str()) {
                files.push(&e.file);
            }
        }
        let of = |file: &str| {
            let own = self.experiments.iter().zip(residuals).filter(|(e, _)| e.file == file);
            (file.to_owned(), rms(own.flat_map(|(_, r)| r)))
        };
        files.into_iter().map(of).collect()
    }

    /// How much worse `a` predicts than `b`.
    pub fn difference(&self, a: &[Vec<f64>], b: &[Vec<f64>]) -> Difference {
        Difference::of(&blocks(&self.experiments, a, b).collect::<Vec<f64>>())
    }

    /// 95 % interval of the share that closes, by blocks of 0.25 s.
    pub fn closed_interval(&self, before: &[Vec<f64>], after: &[Vec<f64>], floor_rad: f64) -> Option<[f64; 2]> {
        let mut blocks: Vec<(f64, f64, f64)> = Vec::new();
        for ((e, before), after) in self.experiments.iter().zip(before).zip(after) {
            for (b, a) in before.chunks(block_samples(e)).zip(after.chunks(block_samples(e))) {
                blocks.push((squares(b), squares(a), b.len() as f64));
            }
        }
        closed_interval(&blocks, floor_rad)
    }
}

/// How much better `rich` predicts fitted logs than `poor`, each log by fits to the others.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::gap) struct Elsewhere {
    /// Standard deviations by which it predicts them better; 0 where that says nothing.
    pub z: f64,
    /// Share of the squares that it leaves.
    pub left: f64,
    /// What it predicts a single log worse at the most, as a share of the squares of all of them.
    pub worst: f64,
}

impl Elsewhere {
    /// Where the other logs do not show what `rich` has more, they cannot tell its size either: such a log is left out.
    pub fn of(evidence: &Evidence, poor: &Trial, rich: &Trial, effective: f64) -> Self {
        let logs = evidence.fit.len();
        let share = (logs - 1) as f64 / logs as f64;
        let of_log = |k: usize| {
            let [(poor_left, poor), (rich_left, rich)] = [poor, rich].map(|t| without_log(evidence, t, k));
            let shown = effective * share * math::ln(poor_left / rich_left.max(1e-300)) > SHOWN;
            shown.then(|| {
                let e = &evidence.fit[k];
                let lost: Vec<f64> = blocks(one(e), one(&poor), one(&rich)).collect();
                (lost, loss(e, &poor), loss(e, &rich))
            })
        };
        let shown: Vec<(Vec<f64>, f64, f64)> = (0..logs).into_par_iter().filter_map(of_log).collect();
        if shown.is_empty() {
            return Self { z: 0.0, left: 1.0, worst: 0.0 };
        }
        let lost: Vec<f64> = shown.iter().flat_map(|(lost, ..)| lost.iter().copied()).collect();
        let sum = |of: fn(&(Vec<f64>, f64, f64)) -> f64| shown.iter().map(of).sum::<f64>();
        Self {
            z: Difference::of(&lost).z(),
            left: sum(|s| s.2) / sum(|s| s.1),
            worst: shown.iter().map(|(_, poor, rich)| rich - poor).fold(0.0, f64::max) / sum(|s| s.1),
        }
    }

    /// Whether whole logs are predicted no worse: not by themselves, or not together with parts of logs, which are better
    /// by so many standard deviations.
    pub fn no_worse(self, parts_z: f64) -> bool {
        self.z > -WORSE_BY || parts_z + self.z > WORSE_BY
    }
}

/// Standard deviations by which whole logs may be predicted worse.
const WORSE_BY: f64 = 1.0;

/// Deviance from which on logs show something.
const SHOWN: f64 = 8.0;

/// What a fit to the other logs leaves of them \[rad^2\], and its residuals on log number `k` \[rad\].
fn without_log(evidence: &Evidence, trial: &Trial, k: usize) -> (f64, Vec<f64>) {
    let all = &evidence.fit;
    let others = (0..all.len()).filter(|i| *i != k);
    let starts = others.clone().map(|i| trial.found.starts[i]).collect();
    let without = evidence.with_logs(others.map(|i| all[i].clone()).collect(), Vec::new());
    let fitted = Trial::solved(&without, trial.model.clone(), &trial.found.values, starts, WITHOUT_A_LOG);
    let residual = predicted(&trial.model, &all[k], &fitted.found.values, Some(trial.found.starts[k])).1;
    (fitted.fit_loss(&without), residual)
}

/// Draws of the bootstrap, and the seed of its random numbers.
const DRAWS: usize = 400;
const SEED: u64 = 1;

/// 95 % interval of the share of the gap above the floor that is closed, by blocks of samples drawn with replacement: of each
/// the squares before and after, and the number of samples.
pub(in crate::gap) fn closed_interval(blocks: &[(f64, f64, f64)], floor_rad: f64) -> Option<[f64; 2]> {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut drawn: Vec<f64> = (0..DRAWS)
        .filter_map(|_| {
            let mut sum = (0.0, 0.0, 0.0);
            for _ in 0..blocks.len() {
                let (b, a, n) = blocks[random.random_range(0..blocks.len())];
                sum = (sum.0 + b, sum.1 + a, sum.2 + n);
            }
            closed((sum.0 / sum.2).sqrt(), (sum.1 / sum.2).sqrt(), floor_rad)
        })
        .filter(|share| share.is_finite())
        .collect();
    if drawn.len() < DRAWS / 2 {
        return None;
    }
    drawn.sort_by(f64::total_cmp);
    let at = |share: f64| drawn[((drawn.len() - 1) as f64 * share).round() as usize];
    Some([at(0.025), at(0.975)])
}

/// Share of the gap above the floor that is closed; `None` where there is no gap.
pub(in crate::gap) fn closed(before_rad: f64, after_rad: f64, floor_rad: f64) -> Option<f64> {
    (before_rad > floor_rad).then(|| 1.0 - (after_rad - floor_rad) / (before_rad - floor_rad))
}

fn squares(r: &[f64]) -> f64 {
    r.iter().map(|r| r * r).sum()
}

/// Root of the mean square.
pub(in crate::gap) fn rms<'a>(residuals: impl Iterator<Item = &'a f64>) -> f64 {
    let (mut sum, mut n) = (0.0, 0usize);
    for r in residuals {
        sum += r * r;
        n += 1;
    }
    (sum / n.max(1) as f64).sqrt()
}
