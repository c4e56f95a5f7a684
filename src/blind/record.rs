//! A run as JSON: the score, and every trial.

use super::answer::Answered;
use super::score::{Judgement, Score, Trial};
use super::truth::Truth;
use serde::Serialize;

/// A trial as it is written down.
#[derive(Clone, Debug, Serialize)]
pub struct TrialRecord<'a> {
    /// What is true.
    pub truth: &'a Truth,
    /// What was answered; `None` where the diagnosis failed.
    pub answer: Option<&'a Answered>,
    /// Why it failed.
    pub failure: Option<&'a str>,
    /// What is right about it.
    pub judgement: Judgement,
    /// How long the diagnosis took \[s\].
    pub wall_s: f64,
}

/// A run as it is written down.
#[derive(Clone, Debug, Serialize)]
pub struct RunRecord<'a> {
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
    pub score: &'a Score,
    /// The trials in their order.
    pub trials: Vec<TrialRecord<'a>>,
}

impl<'a> TrialRecord<'a> {
    /// Of a trial.
    pub fn of(trial: &'a Trial) -> Self {
        Self {
            truth: &trial.truth,
            answer: trial.answer.as_ref().ok(),
            failure: trial.answer.as_ref().err().map(String::as_str),
            judgement: Judgement::of(trial),
            wall_s: trial.wall_s,
        }
    }
}
