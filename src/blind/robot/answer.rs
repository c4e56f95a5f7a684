//! What a diagnosis of a robot answered, as plain data to be scored.

use crate::blind::answer::StatedNumber;
use crate::gap::clamped::ClampedDiagnosis;
use crate::gap::robot::{Cause, Found, RobotDiagnosis};
use crate::gap::{Diagnosis, Verdict};
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
    /// Of an arm: all further ones.
    pub more: Vec<StatedCause>,
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
            more: Vec::new(),
            equivalent: answer.equivalent.clone(),
            places: answer.places.clone(),
            // Exams search to the end.
            probability: answer.probability.unwrap_or_default(),
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

    /// The same from the diagnosis of an arm. A body that is not as described is the exam's payload, whichever of its
    /// numbers is said to be another.
    pub fn of_arm(diagnosis: &ClampedDiagnosis) -> Self {
        let found = || diagnosis.found();
        let bodies = diagnosis.bodies.iter().map(|body| StatedCause {
            cause: Cause::Payload,
            joints: Vec::new(),
            parameters: body.parameters.iter().map(StatedNumber::of).collect(),
        });
        let causes = diagnosis.causes.iter().map(|cause| StatedCause {
            cause: Cause::Effect(cause.effect),
            joints: cause.joints.clone(),
            parameters: cause.size.iter().map(StatedNumber::of).collect(),
        });
        let verdict = diagnosis.answer.verdict;
        let frictions = [Cause::Coulomb, Cause::Viscous].into_iter().filter(|_| verdict == Verdict::Calibration);
        let frictions = frictions.map(|cause| {
            let is_off = |d: &&Diagnosis| {
                d.answer.verdict == Verdict::Calibration && d.answer.effect.as_deref() == Some(cause.id())
            };
            let joints = found().filter(is_off).map(|d| d.joint.clone()).collect();
            StatedCause { cause, joints, parameters: Vec::new() }
        });
        let frictions = frictions.filter(|stated| !stated.joints.is_empty());
        let mut named = bodies.chain(causes).chain(frictions);
        let (first, second) = (named.next(), named.next());
        let more: Vec<StatedCause> = named.collect();
        let leads = |d: &&Diagnosis| first.as_ref().is_some_and(|first| first.joints.contains(&d.joint));
        let others = found().filter(leads).flat_map(|d| &d.answer.equivalent).map(|effect| Cause::Effect(*effect));
        let mut equivalent: Vec<Cause> = first.iter().map(|first| first.cause).chain(others).collect();
        equivalent.dedup();
        let count = match (&first, &second) {
            (None, _) => "plain",
            (Some(_), None) => "one cause",
            (Some(_), Some(_)) => "several causes",
        };
        Self {
            verdict,
            equivalent,
            places: first.iter().map(|first| first.joints.clone()).collect(),
            probability: diagnosis.answer.probability.unwrap_or_default(),
            standing: format!("{}, arm, {count}", verdict.name()),
            partial: None,
            joints: first.iter().flat_map(|first| first.joints.clone()).collect(),
            before: diagnosis.gap.before,
            after: diagnosis.gap.after,
            floor: diagnosis.gap.floor,
            ranking: Vec::new(),
            sentence: diagnosis.answer.sentence.clone(),
            first,
            second,
            more,
        }
    }

    /// The causes named, in their order.
    pub fn named(&self) -> impl Iterator<Item = &StatedCause> {
        self.first.iter().chain(&self.second).chain(&self.more)
    }
}
