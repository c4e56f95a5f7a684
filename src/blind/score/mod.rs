//! How good answers are: pure functions of truths and answers.

mod causes;
mod confusion;
mod coverage;
mod judge;
mod rate;
mod sets;
mod stated;
#[cfg(test)]
mod tests;

pub(super) use causes::taken_for;
pub use causes::{ByCause, BySize};
pub use confusion::Table;
pub use coverage::{Coverage, Covered};
pub use judge::Judgement;
pub use rate::Rate;
pub use sets::{ByNoise, BySet};
pub use stated::{Bin, Stated};

use super::answer::Answered;
use super::trial::Trial;
use super::truth::Truth;
use crate::gap::Verdict;
use serde::Serialize;

/// How long diagnoses took \[s\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct WallTime {
    /// Half took less.
    pub median_s: f64,
    /// The longest.
    pub max_s: f64,
}

/// The score of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    /// Trials.
    pub trials: usize,
    /// Diagnoses that failed.
    pub failed: u32,
    /// The kind of answer was right.
    pub verdict: Rate,
    /// The whole answer was right.
    pub top: Rate,
    /// The whole answer was right, or what is there was in the set.
    pub set: Rate,
    /// Single effects: named, and nothing beside them.
    pub single: Rate,
    /// Single effects: in the set.
    pub single_set: Rate,
    /// Several effects: all named, and nothing beside them.
    pub several: Rate,
    /// Several effects: all named, whatever else was.
    pub all: Rate,
    /// Several effects: at least half of them named.
    pub half: Rate,
    /// An effect was named that is not there, where effects are named.
    pub needless: Rate,
    /// Wrong numbers only: the one that accounts for most was named, where the kind of answer was right.
    pub number: Rate,
    /// The same, and any of the wrong numbers was named.
    pub number_any: Rate,
    /// Mean size of the sets, where an effect is named.
    pub set_size: Option<f64>,
    /// The stage was right, where there is one.
    pub stage: Rate,
    /// An effect or something unexplained was seen where there is nothing.
    pub false_alarms: Rate,
    /// 95 % upper bound of that rate.
    pub false_alarm_bound: f64,
    /// Wrong numbers were seen where there is nothing at all.
    pub needless_calibration: Rate,
    /// Something was taken for nothing or for wrong numbers.
    pub missed: Rate,
    /// What the catalogue does not have was called unexplained.
    pub unexplained: Rate,
    /// Where that sits was right: stage, variable, range.
    pub located: Rate,
    /// Stated probabilities, for the whole answer to be right.
    pub stated: Stated,
    /// Stated probabilities, for what is there to be in the set.
    pub stated_set: Stated,
    /// Coverage of 95 % intervals, where the answer is right and says that they are to be trusted.
    pub coverage: Vec<Coverage>,
    /// The same of all numbers and of all parameters together, and of all right answers.
    pub covered: Covered,
    /// By how many effects are there at once.
    pub sets: Vec<BySet>,
    /// By the noise of the logs.
    pub noises: Vec<ByNoise>,
    /// One for each cause that occurs.
    pub causes: Vec<ByCause>,
    /// Single effects by how much they show.
    pub sizes: Vec<BySize>,
    /// What was there against what was answered.
    pub confusion: Table,
    /// How long diagnoses took.
    pub wall: WallTime,
}

/// Scores a run.
pub fn score(trials: &[Trial]) -> Score {
    let judged: Vec<(&Trial, Judgement)> = trials.iter().map(|trial| (trial, Judgement::of(trial))).collect();
    let rate = |keep: &dyn Fn(&Truth) -> bool, is: &dyn Fn(&Judgement) -> bool| {
        Rate::over(judged.iter().filter(|(trial, _)| keep(&trial.truth)).map(|(_, judgement)| is(judgement)))
    };
    let some = |is: &dyn Fn(&Judgement) -> Option<bool>| Rate::over(judged.iter().filter_map(|(_, j)| is(j)));
    let single = |truth: &Truth| truth.causes.len() == 1;
    let several = |truth: &Truth| truth.causes.len() > 1;
    let stated = |right: &dyn Fn(&Judgement) -> bool| {
        let answers: Vec<(f64, bool)> = judged
            .iter()
            .filter_map(|(trial, judgement)| Some((trial.answer.as_ref().ok()?.probability, right(judgement))))
            .collect();
        Stated::of(&answers)
    };
    let [number, number_any] = sets::numbers(&judged);
    let sizes: Vec<usize> = trials
        .iter()
        .filter_map(|trial| trial.answer.as_ref().ok())
        .filter(|answer| answer.verdict == Verdict::Effect)
        .map(|answer| answer.equivalent.len().max(1))
        .collect();
    let nothing = |trial: &Trial| trial.truth.verdict == Verdict::None && !trial.truth.within;
    let calibrated = |trial: &Trial| trial.answer.as_ref().is_ok_and(|a| a.verdict == Verdict::Calibration);
    let names = |answer: &Answered| !answer.causes.is_empty();
    let false_alarms = some(&|j| j.false_alarm);
    Score {
        trials: trials.len(),
        failed: trials.iter().filter(|trial| trial.answer.is_err()).count() as u32,
        verdict: rate(&|_| true, &|j| j.verdict),
        top: rate(&|_| true, &|j| j.top),
        set: rate(&|_| true, &|j| j.set),
        single: rate(&single, &|j| j.top),
        single_set: rate(&single, &|j| j.set),
        several: rate(&several, &|j| j.top),
        all: rate(&several, &|j| j.all == Some(true)),
        half: rate(&several, &|j| j.half == Some(true)),
        needless: Rate::over(
            judged.iter().filter(|(trial, _)| trial.answer.as_ref().is_ok_and(names)).map(|(_, j)| j.needless > 0),
        ),
        number,
        number_any,
        set_size: (!sizes.is_empty()).then(|| sizes.iter().sum::<usize>() as f64 / sizes.len() as f64),
        stage: some(&|j| j.stage),
        false_alarms,
        false_alarm_bound: false_alarms.upper_bound(),
        needless_calibration: Rate::over(trials.iter().filter(|t| nothing(t)).map(calibrated)),
        missed: some(&|j| j.missed),
        unexplained: rate(&|truth| truth.verdict == Verdict::Unexplained, &|j| j.verdict),
        located: some(&|j| j.located),
        stated: stated(&|j| j.top),
        stated_set: stated(&|j| j.set),
        coverage: coverage::coverage(trials),
        covered: coverage::covered(trials),
        sets: sets::by_set(&judged),
        noises: sets::by_noise(&judged),
        causes: causes::by_cause(&judged),
        sizes: causes::by_size(&judged),
        confusion: Table::of(trials),
        wall: WallTime::of(trials.iter().map(|trial| trial.wall_s)),
    }
}

impl WallTime {
    /// Of diagnoses that took so many seconds.
    pub(super) fn of(seconds: impl Iterator<Item = f64>) -> Self {
        let mut seconds: Vec<f64> = seconds.collect();
        seconds.sort_unstable_by(f64::total_cmp);
        Self {
            median_s: seconds.get(seconds.len() / 2).copied().unwrap_or(0.0),
            max_s: seconds.last().copied().unwrap_or(0.0),
        }
    }
}
