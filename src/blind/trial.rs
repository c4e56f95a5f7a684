//! One sealed trial, of a joint or of a robot.

use super::answer::Answered;
use super::truth::Truth;

/// A trial after it was opened.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial<T = Truth, A = Answered> {
    /// What is true.
    pub truth: T,
    /// What was answered, or why there was no answer.
    pub answer: Result<A, String>,
    /// How long the diagnosis took \[s\].
    pub wall_s: f64,
}
