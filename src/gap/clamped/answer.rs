//! What was found of each joint of a robot.

use crate::gap::Diagnosis;
use serde::Serialize;

/// A joint's own answer.
#[derive(Clone, Debug, Serialize)]
pub struct JointAnswer {
    /// Its name.
    pub joint: String,
    /// What was found; `None` where it never moved in a log.
    pub diagnosis: Option<Diagnosis>,
}

/// Answers of the joints that move.
pub(super) fn found_of(joints: &[JointAnswer]) -> impl Iterator<Item = &Diagnosis> {
    joints.iter().filter_map(|joint| joint.diagnosis.as_ref())
}
