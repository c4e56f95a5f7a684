//! Scores by how many effects are there, and by the noise of the logs.

use super::Trial;
use super::judge::Judgement;
use super::rate::Rate;
use crate::blind::truth::{Gains, Truth};
use crate::gap::Verdict;
use crate::joint::EffectId;
use serde::Serialize;

/// The score of studies with so many effects at once.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BySet {
    /// How many, in words.
    pub what: &'static str,
    /// All of them were named, and nothing else.
    pub exact: Rate,
    /// All of them were named, whatever else was.
    pub all: Rate,
    /// At least half of them were named.
    pub half: Rate,
    /// Nothing was named that is not there.
    pub clean: Rate,
    /// The stage was that of any of them.
    pub stage: Rate,
    /// Mean number of effects that were named and are not there.
    pub needless: f64,
}

/// The score of studies whose logs have a kind of noise.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ByNoise {
    /// What kind.
    pub what: &'static str,
    /// An effect or something unexplained was seen where there is nothing.
    pub false_alarms: Rate,
    /// The whole answer was right.
    pub top: Rate,
}

/// A group of studies: what it is called, and which are in it.
type Group = (&'static str, fn(&Truth) -> bool);

/// One for each number of effects that occurs, and one for servos.
pub(super) fn by_set(judged: &[(&Trial, Judgement)]) -> Vec<BySet> {
    let groups: [Group; 5] = [
        ("one effect", |truth| truth.causes.len() == 1 && !truth.servo),
        ("two effects", |truth| truth.causes.len() == 2 && !truth.servo),
        ("three effects", |truth| truth.causes.len() == 3 && !truth.servo),
        ("four effects", |truth| truth.causes.len() == 4 && !truth.servo),
        ("a servo", |truth| truth.servo),
    ];
    let group = |(what, keep): Group| {
        let items: Vec<&Judgement> = judged.iter().filter(|(trial, _)| keep(&trial.truth)).map(|(_, j)| j).collect();
        let rate = |is: &dyn Fn(&Judgement) -> bool| Rate::over(items.iter().map(|j| is(j)));
        let needless: u32 = items.iter().map(|j| j.needless).sum();
        BySet {
            what,
            exact: rate(&|j| j.top),
            all: rate(&|j| j.all == Some(true)),
            half: rate(&|j| j.half == Some(true)),
            clean: rate(&|j| j.needless == 0),
            stage: rate(&|j| j.stage == Some(true)),
            needless: f64::from(needless) / items.len().max(1) as f64,
        }
    };
    groups.into_iter().map(group).filter(|group| group.exact.of > 0).collect()
}

/// One for each kind of noise, of stamps and of loss that occurs; a study is in one of each.
pub(super) fn by_noise(judged: &[(&Trial, Judgement)]) -> Vec<ByNoise> {
    let kinds = |truth: &Truth| {
        let holes = if truth.holes > 0 { "holes" } else { "no holes" };
        [truth.noise.name(), truth.stamps.name(), holes]
    };
    let group = |axis: usize, what: &'static str| {
        let items = || judged.iter().filter(move |(trial, _)| kinds(&trial.truth)[axis] == what);
        ByNoise {
            what,
            false_alarms: Rate::over(items().filter_map(|(_, j)| j.false_alarm)),
            top: Rate::over(items().map(|(_, j)| j.top)),
        }
    };
    let mut found: Vec<ByNoise> = Vec::new();
    for axis in 0..3 {
        let mut names: Vec<&'static str> = judged.iter().map(|(trial, _)| kinds(&trial.truth)[axis]).collect();
        names.sort_unstable();
        names.dedup();
        found.extend(names.into_iter().map(|name| group(axis, name)));
    }
    found
}

/// Numbers that are wrong were named where nothing else is the matter: the one that accounts for most, and any of them.
pub(super) fn numbers(judged: &[(&Trial, Judgement)]) -> [Rate; 2] {
    let named = || {
        let wrong = judged.iter().filter(|(trial, j)| trial.truth.verdict == Verdict::Calibration && j.verdict);
        wrong.map(|(trial, _)| {
            let name = trial.answer.as_ref().ok().and_then(|answer| answer.effect.as_deref());
            let is_gain = name == Some(EffectId::MotorGain.id());
            let name = if is_gain { Some(Gains::NAMES[0]) } else { name };
            trial.truth.numbers.iter().position(|number| Some(*number) == name)
        })
    };
    [Rate::over(named().map(|at| at == Some(0))), Rate::over(named().map(|at| at.is_some()))]
}
