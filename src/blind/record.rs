//! A run as JSON, of joints or of robots: the score, and every trial.

use super::trial::Trial;
use serde::Serialize;

/// A trial as it is written down: what is true (`T`), what was answered (`A`), what is right about it (`J`).
#[derive(Clone, Debug, Serialize)]
pub struct TrialRecord<'a, T, A, J> {
    /// What is true.
    pub truth: &'a T,
    /// What was answered; `None` where the diagnosis failed.
    pub answer: Option<&'a A>,
    /// Why it failed.
    pub failure: Option<&'a str>,
    /// What is right about it.
    pub judgement: J,
    /// How long the diagnosis took \[s\].
    pub wall_s: f64,
}

/// A run as it is written down, with a score `S` and trials `R`.
#[derive(Clone, Debug, Serialize)]
pub struct RunRecord<'a, S, R> {
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
    pub score: &'a S,
    /// The trials in their order.
    pub trials: Vec<R>,
}

impl<'a, T, A, J> TrialRecord<'a, T, A, J> {
    /// Of a trial that was judged so.
    pub fn of(trial: &'a Trial<T, A>, judgement: J) -> Self {
        Self {
            truth: &trial.truth,
            answer: trial.answer.as_ref().ok(),
            failure: trial.answer.as_ref().err().map(String::as_str),
            judgement,
            wall_s: trial.wall_s,
        }
    }
}
