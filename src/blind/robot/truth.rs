//! The sealed answer of a made robot study.

use super::cause::RobotOutside;
use super::setting::Setting;
use crate::blind::truth::TrueNumber;
use crate::gap::Verdict;
use crate::gap::robot::Cause;
use serde::Serialize;

/// What is the matter with some joints, or with the robot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrueFault {
    /// Id of a cause of the catalogue or of a fault outside it.
    pub id: &'static str,
    /// Names of its joints; empty: the whole robot.
    pub joints: Vec<String>,
    /// Its numbers; a cause's under the catalogue's names.
    pub parameters: Vec<TrueNumber>,
    /// RMS angle that it changes in its joints (all that move, where it has none), over a reading's standard deviation.
    pub ratio: f64,
}

/// What is true of a study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobotTruth {
    /// Seed of the run.
    pub seed: u64,
    /// Which study of the run.
    pub trial: u64,
    /// `air`, `floor`, `drop` or `arm`.
    pub scenario: &'static str,
    /// Which robot: `ers7`, or one that was drawn, in words.
    pub robot: String,
    /// The kind of answer that is right.
    pub verdict: Verdict,
    /// Causes of the catalogue that are there, at most two.
    pub causes: Vec<Cause>,
    /// A fault that the catalogue does not have.
    pub outside: Option<RobotOutside>,
    /// All that is the matter, with numbers.
    pub faults: Vec<TrueFault>,
    /// RMS angle that all of it changes in the joints of the first, over a reading's standard deviation.
    pub ratio: f64,
    /// Standard deviation of a reading \[rad\].
    pub noise_rad: f64,
    /// Relative standard deviation of masses and floor.
    pub scatter: f64,
    /// Of friction.
    pub friction_scatter: f64,
    /// How the maker integrated.
    pub method: String,
    /// What was asked in each log: a gait with its frequency, or the joint that was let go.
    pub motions: Vec<String>,
}

impl RobotTruth {
    /// Whether nothing is the matter but numbers that were drawn off within what is believed of them: of an arm, all of whose
    /// numbers are fitted joint by joint, `calibration` is as right as `none` then.
    pub fn is_within(&self) -> bool {
        let is_off = self.scatter.max(self.friction_scatter) > 0.0;
        self.verdict == Verdict::None && self.scenario == Setting::Arm.word() && is_off
    }

    /// Joints of the catalogue's causes, one list for each.
    pub fn places(&self) -> impl Iterator<Item = (Cause, &[String])> {
        self.causes.iter().copied().zip(self.faults.iter().map(|fault| fault.joints.as_slice()))
    }
}
