//! One answer about a robot against one truth.

use super::answer::RobotAnswered;
use super::truth::RobotTruth;
use crate::blind::Trial;
use crate::gap::Verdict;
use crate::gap::robot::Cause;
use serde::Serialize;

/// A robot's trial after it was opened.
pub type RobotTrial = Trial<RobotTruth, RobotAnswered>;

/// What is right about an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct RobotJudgement {
    /// The kind of answer is right.
    pub verdict: bool,
    /// The causes named are exactly those that are there; `None` where the catalogue has none that is there.
    pub named: Option<bool>,
    /// Every cause that is there is named or among those that cannot be told apart, and no more are named than are there.
    pub in_set: Option<bool>,
    /// The joints named are exactly those of the causes that are there, cause by cause in any order; `None` where no
    /// joint has a fault.
    pub place: Option<bool>,
    /// Some joint is rightly named.
    pub overlaps: Option<bool>,
    /// Kind, causes and joints are right.
    pub top: bool,
    /// As `top`, or causes and joints are among those that cannot be told apart.
    pub set: bool,
    /// Something was named or called unexplained where there is nothing; `None` where there is something.
    pub false_alarm: Option<bool>,
    /// Nothing was seen where there is something.
    pub missed: Option<bool>,
}

impl RobotJudgement {
    /// Judges a trial; a diagnosis that failed is wrong in everything, but no false alarm.
    pub fn of(trial: &RobotTrial) -> Self {
        let truth = &trial.truth;
        let is_nothing = truth.verdict == Verdict::None;
        let has_cause = !truth.causes.is_empty();
        let has_joint = truth.places().any(|(_, joints)| !joints.is_empty());
        let Ok(answer) = &trial.answer else {
            return Self {
                verdict: false,
                named: has_cause.then_some(false),
                in_set: has_cause.then_some(false),
                place: has_joint.then_some(false),
                overlaps: has_joint.then_some(false),
                top: false,
                set: false,
                false_alarm: is_nothing.then_some(false),
                missed: (!is_nothing).then_some(true),
            };
        };
        let is_within = truth.is_within() && answer.verdict == Verdict::Calibration;
        let verdict = is_within || answer.verdict == truth.verdict;
        let mut there: Vec<Cause> = truth.causes.clone();
        let mut named: Vec<Cause> = answer.named().map(|stated| stated.cause).collect();
        let few = named.len() <= there.len();
        let in_set = few && there.iter().all(|cause| named.contains(cause) || answer.equivalent.contains(cause));
        there.sort_unstable();
        named.sort_unstable();
        let is_named = named == there;
        let places = |list: Vec<&[String]>| {
            let mut list: Vec<Vec<String>> = list.into_iter().map(sorted).collect();
            list.sort_unstable();
            list
        };
        let there = places(truth.places().map(|(_, joints)| joints).collect());
        let said = places(answer.named().map(|stated| stated.joints.as_slice()).collect());
        let is_placed = there == said;
        let may_be = |joints: &[String]| {
            said.contains(&sorted(joints)) || answer.places.iter().any(|place| sorted(place) == sorted(joints))
        };
        let placed_in_set = few && there.iter().all(|joints| may_be(joints));
        let overlaps = there.iter().flatten().any(|joint| said.iter().flatten().any(|said| said == joint));
        let in_catalogue = has_cause || is_nothing;
        Self {
            verdict,
            named: has_cause.then_some(is_named),
            in_set: has_cause.then_some(is_named || in_set),
            place: has_joint.then_some(is_placed),
            overlaps: has_joint.then_some(overlaps),
            top: verdict && (is_within || !in_catalogue || is_named && is_placed),
            set: verdict && (is_within || !in_catalogue || (is_named || in_set) && placed_in_set),
            false_alarm: is_nothing.then_some(!verdict),
            missed: (!is_nothing).then_some(answer.verdict == Verdict::None),
        }
    }
}

fn sorted(joints: &[String]) -> Vec<String> {
    let mut joints = joints.to_vec();
    joints.sort_unstable();
    joints
}
