//! How good answers about robots are: pure functions of truths and answers.

use super::answer::RobotAnswered;
use super::judge::{RobotJudgement, RobotTrial};
use super::setting::Setting;
use super::truth::RobotTruth;
use crate::blind::score::{ByCause, Rate, Stated, Table, WallTime, taken_for};
use crate::gap::robot::Cause;
use serde::Serialize;
use std::collections::BTreeMap;

/// The score of a group of trials.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobotGroup {
    /// Which.
    pub name: String,
    /// The kind of answer was right.
    pub verdict: Rate,
    /// The whole answer was right.
    pub top: Rate,
    /// The whole answer was right, or what is there was in the set.
    pub set: Rate,
    /// Something was seen where there is nothing.
    pub false_alarms: Rate,
    /// How long diagnoses took.
    pub wall: WallTime,
}

/// The score of single causes that show so much.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RobotBySize {
    /// Change of the joints' angle over the noise: at least this ...
    pub from: f64,
    /// ... and less than this.
    pub to: Option<f64>,
    /// Cause and joints were named.
    pub top: Rate,
    /// Or in the set.
    pub set: Rate,
    /// Nothing was seen.
    pub missed: Rate,
}

/// The score of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobotScore {
    /// Trials.
    pub trials: usize,
    /// Diagnoses that failed.
    pub failed: u32,
    /// The kind of answer was right.
    pub verdict: Rate,
    /// Kind, causes and joints were right.
    pub top: Rate,
    /// The same, or what is there was in the set.
    pub set: Rate,
    /// Single causes: named, and nothing beside them.
    pub single: Rate,
    /// Single causes: in the set.
    pub single_set: Rate,
    /// Causes on joints: exactly these joints.
    pub place: Rate,
    /// Causes on joints: some of these joints.
    pub overlaps: Rate,
    /// Two causes: both named.
    pub both: Rate,
    /// Mean size of the sets of causes, where causes are named.
    pub set_size: Option<f64>,
    /// Mean number of places, where causes are named.
    pub places: Option<f64>,
    /// Something was named or called unexplained where there is nothing.
    pub false_alarms: Rate,
    /// 95 % upper bound of that rate.
    pub false_alarm_bound: f64,
    /// Nothing was seen where there is something.
    pub missed: Rate,
    /// What the catalogue does not have was called unexplained.
    pub unexplained: Rate,
    /// Stated probabilities, for what is there to be in the set.
    pub stated: Stated,
    /// By scenario.
    pub scenarios: Vec<RobotGroup>,
    /// One for each cause that occurs.
    pub causes: Vec<ByCause>,
    /// Single causes by how much they show.
    pub sizes: Vec<RobotBySize>,
    /// What was there against what was answered.
    pub confusion: Table,
    /// How long diagnoses took.
    pub wall: WallTime,
}

/// Bounds of the sizes.
const SIZES: [f64; 5] = [0.0, 2.0, 5.0, 12.0, f64::INFINITY];
/// Two causes at once.
const PAIR: &str = "two causes";
/// Something that the catalogue does not have.
const OUTSIDE: &str = "outside";

/// Scores a run.
pub fn score_robots(trials: &[RobotTrial]) -> RobotScore {
    let judged: Vec<(&RobotTrial, RobotJudgement)> =
        trials.iter().map(|trial| (trial, RobotJudgement::of(trial))).collect();
    let some =
        |is: &dyn Fn(&RobotJudgement) -> Option<bool>| Rate::over(judged.iter().filter_map(|(_, judged)| is(judged)));
    let among = |keep: &dyn Fn(&RobotTruth) -> bool, is: &dyn Fn(&RobotJudgement) -> bool| {
        Rate::over(judged.iter().filter(|(trial, _)| keep(&trial.truth)).map(|(_, judgement)| is(judgement)))
    };
    let single = |truth: &RobotTruth| truth.causes.len() == 1;
    let naming = || {
        let answers = trials.iter().filter_map(|trial| trial.answer.as_ref().ok());
        answers.filter(|answer| answer.first.is_some())
    };
    let mean = |value: &dyn Fn(&RobotAnswered) -> usize| {
        let values: Vec<usize> = naming().map(value).collect();
        (!values.is_empty()).then(|| values.iter().sum::<usize>() as f64 / values.len() as f64)
    };
    let stated: Vec<(f64, bool)> = judged
        .iter()
        .filter_map(|(trial, judgement)| Some((trial.answer.as_ref().ok()?.probability, judgement.set)))
        .collect();
    let false_alarms = some(&|j| j.false_alarm);
    let cells = trials.iter().map(|trial| (row(&trial.truth), column(&trial.answer)));
    let names: Vec<&'static str> = Cause::all().map(Cause::id).chain([PAIR]).collect();
    RobotScore {
        trials: trials.len(),
        failed: trials.iter().filter(|trial| trial.answer.is_err()).count() as u32,
        verdict: among(&|_| true, &|j| j.verdict),
        top: among(&|_| true, &|j| j.top),
        set: among(&|_| true, &|j| j.set),
        single: among(&single, &|j| j.named == Some(true)),
        single_set: among(&single, &|j| j.in_set == Some(true)),
        place: some(&|j| j.place),
        overlaps: some(&|j| j.overlaps),
        both: among(&|truth| truth.causes.len() == 2, &|j| j.named == Some(true)),
        set_size: mean(&|answer| answer.equivalent.len().max(1)),
        places: mean(&|answer| answer.places.len().max(1)),
        false_alarms,
        false_alarm_bound: false_alarms.upper_bound(),
        missed: some(&|j| j.missed),
        unexplained: among(&|truth| truth.outside.is_some(), &|j| j.verdict),
        stated: Stated::of(&stated),
        scenarios: scenarios(&judged),
        causes: by_cause(&judged),
        sizes: by_size(&judged),
        confusion: Table::count(cells.collect(), &names),
        wall: WallTime::of(trials.iter().map(|trial| trial.wall_s)),
    }
}

fn scenarios(judged: &[(&RobotTrial, RobotJudgement)]) -> Vec<RobotGroup> {
    let group = |name: &str| {
        let here = || judged.iter().filter(|(trial, _)| trial.truth.scenario == name);
        (here().count() > 0).then(|| RobotGroup {
            name: name.to_owned(),
            verdict: Rate::over(here().map(|(_, j)| j.verdict)),
            top: Rate::over(here().map(|(_, j)| j.top)),
            set: Rate::over(here().map(|(_, j)| j.set)),
            false_alarms: Rate::over(here().filter_map(|(_, j)| j.false_alarm)),
            wall: WallTime::of(here().map(|(trial, _)| trial.wall_s)),
        })
    };
    Setting::ALL.map(Setting::word).into_iter().filter_map(group).collect()
}

fn by_cause(judged: &[(&RobotTrial, RobotJudgement)]) -> Vec<ByCause> {
    let mut groups: BTreeMap<(u8, String), Vec<&(&RobotTrial, RobotJudgement)>> = BTreeMap::new();
    for item in judged {
        let truth = &item.0.truth;
        let ids: Vec<&str> = truth.causes.iter().map(|cause| cause.id()).collect();
        let key = match (truth.outside, ids.len()) {
            (Some(outside), _) => (2, outside.to_string()),
            (None, 0) => (3, truth.verdict.name().to_owned()),
            (None, count) => (count as u8 - 1, ids.join("+")),
        };
        groups.entry(key).or_default().push(item);
    }
    let group = |((_, cause), items): ((u8, String), Vec<&(&RobotTrial, RobotJudgement)>)| {
        let rate = |is: &dyn Fn(&RobotJudgement) -> bool| Rate::over(items.iter().map(|(_, judgement)| is(judgement)));
        let wrong = items.iter().filter(|(_, judgement)| !judgement.top);
        ByCause {
            verdict: rate(&|j| j.verdict),
            top: rate(&|j| j.top),
            set: rate(&|j| j.set),
            stage: Rate::over(items.iter().filter_map(|(_, judgement)| judgement.place)),
            taken_for: taken_for(wrong.map(|(trial, _)| said(&trial.answer))),
            cause,
        }
    };
    groups.into_iter().map(group).collect()
}

fn by_size(judged: &[(&RobotTrial, RobotJudgement)]) -> Vec<RobotBySize> {
    let group = |edge: &[f64]| {
        let items = || {
            let single = judged.iter().filter(|(trial, _)| trial.truth.causes.len() == 1);
            single.filter(|(trial, _)| edge[0] <= trial.truth.ratio && trial.truth.ratio < edge[1])
        };
        RobotBySize {
            from: edge[0],
            to: edge[1].is_finite().then_some(edge[1]),
            top: Rate::over(items().map(|(_, j)| j.top)),
            set: Rate::over(items().map(|(_, j)| j.set)),
            missed: Rate::over(items().filter_map(|(_, j)| j.missed)),
        }
    };
    SIZES.windows(2).map(group).filter(|group| group.top.of > 0).collect()
}

fn row(truth: &RobotTruth) -> &'static str {
    match (truth.outside, truth.causes.as_slice()) {
        (Some(_), _) => OUTSIDE,
        (None, []) => truth.verdict.name(),
        (None, [one]) => one.id(),
        (None, _) => PAIR,
    }
}

fn column(answer: &Result<RobotAnswered, String>) -> &'static str {
    match answer {
        Err(_) => "failed",
        Ok(answer) => match (&answer.first, &answer.second) {
            (Some(first), None) => first.cause.id(),
            (Some(_), Some(_)) => PAIR,
            (None, _) => answer.verdict.name(),
        },
    }
}

/// The answer in words.
fn said(answer: &Result<RobotAnswered, String>) -> String {
    match answer {
        Ok(answer) if answer.first.is_some() => {
            let ids: Vec<&str> = answer.named().map(|stated| stated.cause.id()).collect();
            ids.join("+")
        }
        other => column(other).to_owned(),
    }
}
