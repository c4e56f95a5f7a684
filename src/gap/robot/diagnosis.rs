//! What a diagnosis of a robot says, as plain data: the engine fills it, reports and JSON show it.

use super::cause::{Cause, Change, RobotStage};
use crate::deadline::{Deadline, Spent};
use crate::gap::{BeliefFound, LogGap, Next, Number, Variable, Verdict};
use crate::log::RobotScenario;
use serde::Serialize;

/// How to diagnose.
#[derive(Clone, Debug, Default)]
pub struct RobotOptions {
    /// Causes that are withheld.
    pub without: Vec<Cause>,
    /// The only causes that are considered; empty: all.
    pub only: Vec<Cause>,
    /// Until when causes are looked for.
    pub deadline: Deadline,
}

impl RobotOptions {
    /// Whether a cause is asked for: it is not withheld, and one of the only ones where there are such.
    pub(super) fn considers(&self, cause: Cause) -> bool {
        !self.without.contains(&cause) && (self.only.is_empty() || self.only.contains(&cause))
    }
}

/// What a leg is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum GaitPhase {
    /// Standing, or held before a drop.
    Hold,
    /// The foot goes to the rear, or is about to carry.
    Stance,
    /// The foot goes to the front.
    Swing,
    /// The first moments of a stance.
    TouchDown,
    /// A joint that was let go, or no leg.
    Run,
}

impl GaitPhase {
    /// All of them, in the order in which they are shown.
    pub const ALL: [GaitPhase; 5] =
        [GaitPhase::Hold, GaitPhase::Stance, GaitPhase::Swing, GaitPhase::TouchDown, GaitPhase::Run];

    /// The word in reports and JSON.
    pub fn name(self) -> &'static str {
        match self {
            GaitPhase::Hold => "hold",
            GaitPhase::Stance => "stance",
            GaitPhase::Swing => "swing",
            GaitPhase::TouchDown => "touch_down",
            GaitPhase::Run => "run",
        }
    }
}

/// A cause on joints with its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Which cause.
    pub cause: Cause,
    /// Names of its joints; empty: the whole robot.
    pub joints: Vec<String>,
    /// Its numbers under the catalogue's names.
    pub parameters: Vec<Number>,
}

/// The answer in short.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotAnswer {
    /// Which kind.
    pub verdict: Verdict,
    /// The cause; `None` for [`Verdict::None`] and [`Verdict::Unexplained`].
    pub first: Option<Found>,
    /// A further cause that was found after the first.
    pub second: Option<Found>,
    /// Causes that these logs cannot tell apart from the first, it included, best first.
    pub equivalent: Vec<Cause>,
    /// Places on which the first stands as well, its own included, best first.
    pub places: Vec<Vec<String>>,
    /// The measured rate at which an answer like this was right; `None` where the search was not finished.
    pub probability: Option<f64>,
    /// Where `probability` was measured, or why there is none.
    pub probability_source: String,
    /// The kind of answer and how clearly it stands, in words that are counted.
    pub standing: String,
    /// One sentence a colleague would say.
    pub sentence: String,
    /// For [`Verdict::Unexplained`]: what closes most of the gap.
    pub partial: Option<Found>,
    /// Whether intervals are to be trusted: nothing is left that the model does not explain.
    pub intervals_trusted: bool,
}

/// One cell of the map.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GaitCell {
    /// The joint.
    pub joint: String,
    /// What its leg was doing.
    pub phase: GaitPhase,
    /// Seconds in this phase.
    pub time_s: f64,
    /// RMS of the gap there, above what noise and uncertain numbers leave \[rad\].
    pub excess_rad: f64,
    /// Share of the whole gap's energy \[0 to 1\].
    pub share: f64,
    /// More than chance gives, also when all cells are looked at.
    pub significant: bool,
}

/// Where the gap lies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotWhere {
    /// Joints that are to blame; where no cause is named those that have most of the gap.
    pub joints: Vec<String>,
    /// Where the cause acts; `None` where none is named.
    pub stage: Option<RobotStage>,
    /// What the gap of these joints depends on most.
    pub variable: Option<Variable>,
    /// Between which values of the variable most of it lies.
    pub range: Option<[f64; 2]>,
    /// The phase with most of it.
    pub phase: Option<GaitPhase>,
    /// Logs that have more than their share of it.
    pub logs: Vec<String>,
    /// Share of the gap in these joints \[0 to 1\].
    pub share: f64,
    /// Joint by phase.
    pub cells: Vec<GaitCell>,
}

/// The gap of one joint over the held-out samples \[rad RMS\].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointGap {
    /// The joint.
    pub joint: String,
    /// As given.
    pub before: f64,
    /// With masses and friction adapted within what is uncertain anyway.
    pub calibrated: f64,
    /// With the answer's leading cause alone.
    pub after_first: f64,
    /// With the causes of the answer.
    pub after: f64,
}

/// How far the trunk went \[m\].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Displacement {
    /// The log.
    pub file: String,
    /// As measured.
    pub measured: f64,
    /// As given.
    pub before: f64,
    /// With the causes of the answer.
    pub after: f64,
}

/// How far the gap closes \[rad RMS over the held-out samples of all joints\].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RobotGap {
    /// Always `rad`.
    pub unit: &'static str,
    /// As given.
    pub before: f64,
    /// With masses and friction adapted within what is uncertain anyway.
    pub calibrated: f64,
    /// With the first cause.
    pub after_first: f64,
    /// With every cause of the answer.
    pub after: f64,
    /// The sensor's own noise.
    pub floor: f64,
    /// `1 - (after - floor) / (before - floor)`; `None` where `before <= floor`.
    pub closed: Option<f64>,
    /// 95 % interval of `closed`.
    pub closed_interval: Option<[f64; 2]>,
    /// How samples were held out, in words.
    pub held_out: String,
    /// By log.
    pub per_log: Vec<LogGap>,
    /// By joint.
    pub per_joint: Vec<JointGap>,
    /// By log with a measured displacement.
    pub displacement: Vec<Displacement>,
}

/// One candidate of the ranking.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotCandidate {
    /// Cause, joints, numbers.
    pub found: Found,
    /// Measured rate at which a candidate that stood like this one was the cause.
    pub probability: f64,
    /// RMS over the held-out samples with it \[rad\].
    pub after: f64,
    /// Share of the gap that it closes.
    pub closed: Option<f64>,
    /// How much worse than the best it explains the fitted samples, in units of a noise variance.
    pub behind: f64,
}

/// The smallest size of a cause that these logs would have shown, on the joint where it shows best.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotDetectable {
    /// Which cause.
    pub cause: Cause,
    /// Its size, of the parameter `name`; `None`: these logs cannot show it.
    pub value: Option<f64>,
    /// Which parameter measures it.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
}

/// Curves of one joint in one log.
#[derive(Clone, Debug, PartialEq)]
pub struct JointTrace {
    /// The log.
    pub file: String,
    /// The joint.
    pub joint: String,
    /// \[s\]
    pub t_s: Vec<f64>,
    /// \[rad\]
    pub measured_rad: Vec<f64>,
    /// \[rad\]; NaN where the motor is off.
    pub setpoint_rad: Vec<f64>,
    /// As given \[rad\].
    pub before_rad: Vec<f64>,
    /// With the causes of the answer \[rad\].
    pub after_rad: Vec<f64>,
    /// The torque that the joint as given lacks, by inverse dynamics of the measured motion \[N m\]; empty where the
    /// trunk is free.
    pub residual_torque_nm: Vec<f64>,
    /// What its leg was doing.
    pub phase: Vec<GaitPhase>,
    /// Samples that no fit saw.
    pub held: Vec<bool>,
}

/// A diagnosis of a robot.
#[derive(Clone, Debug)]
pub struct RobotDiagnosis {
    /// Name of the robot.
    pub robot: String,
    /// How its trunk was held.
    pub scenario: RobotScenario,
    /// The answer in short.
    pub answer: RobotAnswer,
    /// Where the gap lies.
    pub location: RobotWhere,
    /// How far it closes.
    pub gap: RobotGap,
    /// Candidates, best first.
    pub ranking: Vec<RobotCandidate>,
    /// One for each cause that was considered.
    pub detectable: Vec<RobotDetectable>,
    /// What to do next where causes cannot be told apart.
    pub next: Option<Next>,
    /// Of a clamped robot the masses and frictions that are uncertain, the one that moved farthest first.
    pub beliefs: Vec<BeliefFound>,
    /// The robot's changes by the answer (for an unexplained gap: by what comes nearest), friction that moved among them.
    pub changes: Vec<Change>,
    /// Curves, log after log, joint after joint.
    pub traces: Vec<JointTrace>,
    /// Honest remarks, most important first.
    pub notes: Vec<String>,
    /// Causes that were withheld.
    pub withheld: Vec<Cause>,
    /// What became of its time, where that was limited.
    pub budget: Option<Spent>,
}
