//! What a diagnosis of a robot answered, as plain data to be scored.

use crate::blind::answer::StatedNumber;
use crate::gap::Verdict;
use crate::gap::robot::{Cause, Found, RobotDiagnosis};
use serde::Serialize;

/// A cause that is named, with its joints and numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StatedCause {
    /// Which.
    pub cause: Cause,
    /// Names of its joints; empty: the whole robot.
    pub joints: Vec<String>,
    /// Its numbers.
    pub parameters: Vec<StatedNumber>,
}

impl StatedCause {
    fn of(found: &Found) -> Self {
        Self {
            cause: found.cause,
            joints: found.joints.clone(),
            parameters: found.parameters.iter().map(StatedNumber::of).collect(),
        }
    }
}

/// A place in the ranking.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobotRanked {
    /// Which cause.
    pub cause: Cause,
    /// On which joints.
    pub joints: Vec<String>,
    /// How much worse than the best it explains the logs, in units of a noise variance.
    pub behind: f64,
}

/// What a diagnosis answered.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobotAnswered {
    /// Which kind.
    pub verdict: Verdict,
    /// The cause.
    pub first: Option<StatedCause>,
    /// A further cause.
    pub second: Option<StatedCause>,
    /// Causes that cannot be told apart from the first, it included.
    pub equivalent: Vec<Cause>,
    /// Places on which the first stands as well, its own included.
    pub places: Vec<Vec<String>>,
    /// The stated probability that the answer is right.
    pub probability: f64,
    /// How clearly the answer stands, in the words under which rates are counted.
    pub standing: String,
    /// What closes most of an unexplained gap.
    pub partial: Option<StatedCause>,
    /// Where the gap is.
    pub joints: Vec<String>,
    /// RMS over the held-out samples as given, with the answer, and of the sensor's own noise \[rad\].
    pub before: f64,
    /// See `before`.
    pub after: f64,
    /// See `before`.
    pub floor: f64,
    /// The best candidates.
    pub ranking: Vec<RobotRanked>,
    /// What is said.
    pub sentence: String,
}

/// Candidates of a ranking that are kept.
const KEPT: usize = 5;

impl RobotAnswered {
    /// Takes from a diagnosis what is scored.
    pub fn of(diagnosis: &RobotDiagnosis) -> Self {
        let answer = &diagnosis.answer;
        let ranked = |candidate: &crate::gap::robot::RobotCandidate| RobotRanked {
            cause: candidate.found.cause,
            joints: candidate.found.joints.clone(),
            behind: candidate.behind,
        };
        Self {
            verdict: answer.verdict,
            first: answer.first.as_ref().map(StatedCause::of),
            second: answer.second.as_ref().map(StatedCause::of),
            equivalent: answer.equivalent.clone(),
            places: answer.places.clone(),
            probability: answer.probability,
            standing: answer.standing.clone(),
            partial: answer.partial.as_ref().map(StatedCause::of),
            joints: diagnosis.location.joints.clone(),
            before: diagnosis.gap.before,
            after: diagnosis.gap.after,
            floor: diagnosis.gap.floor,
            ranking: diagnosis.ranking.iter().take(KEPT).map(ranked).collect(),
            sentence: answer.sentence.clone(),
        }
    }

    /// The causes named, in their order.
    pub fn named(&self) -> impl Iterator<Item = &StatedCause> {
        self.first.iter().chain(&self.second)
    }
}
