//! Scores by cause and by size.

use super::Trial;
use super::judge::Judgement;
use super::rate::Rate;
use crate::gap::Verdict;
use serde::Serialize;
use std::collections::BTreeMap;

/// The score of one cause.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ByCause {
    /// Id of the effect, of both joined by `+`, of the mechanism outside the catalogue; `none` or `calibration`.
    pub cause: String,
    /// The kind of answer was right.
    pub verdict: Rate,
    /// The whole answer was right.
    pub top: Rate,
    /// In the set.
    pub set: Rate,
    /// The stage was right.
    pub stage: Rate,
    /// The most frequent wrong answer, and how often it was given.
    pub taken_for: Option<(String, u32)>,
}

/// The score of single effects that show so much.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BySize {
    /// What recalibration leaves of the effect, over the noise: at least this ...
    pub from: f64,
    /// ... and less than this.
    pub to: Option<f64>,
    /// The whole answer was right.
    pub top: Rate,
    /// In the set.
    pub set: Rate,
    /// It was taken for nothing or for wrong numbers.
    pub missed: Rate,
}

/// Bounds of the sizes.
const SIZES: [f64; 6] = [0.0, 1.0, 3.0, 10.0, 30.0, f64::INFINITY];

/// One for each cause that occurs: single effects, pairs, causes outside the catalogue, wrong numbers, nothing.
pub(super) fn by_cause(judged: &[(&Trial, Judgement)]) -> Vec<ByCause> {
    let mut groups: BTreeMap<(u8, String), Vec<&(&Trial, Judgement)>> = BTreeMap::new();
    for item in judged {
        groups.entry(cause(item.0)).or_default().push(item);
    }
    let group = |((_, cause), items): ((u8, String), Vec<&(&Trial, Judgement)>)| {
        let rate = |is: &dyn Fn(&Judgement) -> bool| Rate::over(items.iter().map(|(_, judgement)| is(judgement)));
        let wrong = items.iter().filter(|(_, judgement)| !judgement.top);
        ByCause {
            verdict: rate(&|j| j.verdict),
            top: rate(&|j| j.top),
            set: rate(&|j| j.set),
            stage: Rate::over(items.iter().filter_map(|(_, judgement)| judgement.stage)),
            taken_for: taken_for(wrong.map(|(trial, _)| answer(trial))),
            cause,
        }
    };
    groups.into_iter().map(group).collect()
}

/// The most frequent of wrong answers, and how often it was given; of equally frequent ones the first by name.
pub(in crate::blind) fn taken_for(wrong: impl Iterator<Item = String>) -> Option<(String, u32)> {
    let mut counts: BTreeMap<String, u32> = BTreeMap::new();
    for answer in wrong {
        *counts.entry(answer).or_default() += 1;
    }
    counts.into_iter().rev().max_by_key(|(_, count)| *count)
}

/// Single effects, by what recalibration leaves of them.
pub(super) fn by_size(judged: &[(&Trial, Judgement)]) -> Vec<BySize> {
    let single = |trial: &Trial| trial.truth.causes.len() == 1;
    let group = |edge: &[f64]| {
        let items = || judged.iter().filter(|(t, _)| single(t) && edge[0] <= t.truth.left && t.truth.left < edge[1]);
        BySize {
            from: edge[0],
            to: edge[1].is_finite().then_some(edge[1]),
            top: Rate::over(items().map(|(_, j)| j.top)),
            set: Rate::over(items().map(|(_, j)| j.set)),
            missed: Rate::over(items().filter_map(|(_, j)| j.missed)),
        }
    };
    SIZES.windows(2).map(group).filter(|group| group.top.of > 0).collect()
}

fn cause(trial: &Trial) -> (u8, String) {
    let truth = &trial.truth;
    match truth.verdict {
        Verdict::Effect => (u8::from(truth.causes.len() > 1), truth.effects().join("+")),
        Verdict::Unexplained => (2, truth.outside.map_or_else(String::new, |id| id.to_string())),
        Verdict::Calibration | Verdict::None => (3, truth.verdict.name().to_owned()),
    }
}

fn answer(trial: &Trial) -> String {
    match &trial.answer {
        Err(_) => "failed".to_owned(),
        Ok(answer) if answer.verdict == Verdict::Effect => answer.named().join("+"),
        Ok(answer) => answer.verdict.name().to_owned(),
    }
}
