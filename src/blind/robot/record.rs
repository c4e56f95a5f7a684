//! A run as JSON: the score, and every trial.

use super::answer::RobotAnswered;
use super::judge::{RobotJudgement, RobotTrial};
use super::score::RobotScore;
use super::truth::RobotTruth;
use serde::Serialize;

/// A trial as it is written down.
#[derive(Clone, Debug, Serialize)]
pub struct RobotTrialRecord<'a> {
    /// What is true.
    pub truth: &'a RobotTruth,
    /// What was answered; `None` where the diagnosis failed.
    pub answer: Option<&'a RobotAnswered>,
    /// Why it failed.
    pub failure: Option<&'a str>,
    /// What is right about it.
    pub judgement: RobotJudgement,
    /// How long the diagnosis took \[s\].
    pub wall_s: f64,
}

/// A run as it is written down.
#[derive(Clone, Debug, Serialize)]
pub struct RobotRunRecord<'a> {
    /// Always 1.
    pub schema: u32,
    /// Version of the program.
    pub version: &'a str,
    /// The command line.
    pub command: &'a str,
    /// Seed of all that was drawn.
    pub seed: u64,
    /// SHA-256 of the answers, stated before the first diagnosis.
    pub sha256: &'a str,
    /// The answers as they were opened have that hash.
    pub seal_holds: bool,
    /// The score.
    pub score: &'a RobotScore,
    /// The trials in their order.
    pub trials: Vec<RobotTrialRecord<'a>>,
}

impl<'a> RobotTrialRecord<'a> {
    /// Of a trial.
    pub fn of(trial: &'a RobotTrial) -> Self {
        Self {
            truth: &trial.truth,
            answer: trial.answer.as_ref().ok(),
            failure: trial.answer.as_ref().err().map(String::as_str),
            judgement: RobotJudgement::of(trial),
            wall_s: trial.wall_s,
        }
    }
}
