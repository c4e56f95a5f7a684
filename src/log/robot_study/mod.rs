//! Robot studies: what the engineer believes about a whole robot, and the logs that speak about it.
//!
//! Plain data: names of joints are not looked up and numbers are not put together here, that is the robot layer's.

mod described;
mod raw;
mod read;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::columns::Columns;
use super::motor_types::{Derivative, Hold};
use super::types::{ExtraMass, Role};
use super::uncertain::Uncertain;

pub use described::DescribedBeliefs;
pub(crate) use raw::{RawControl, RawFloor, RawFriction, RawRobot, RawRobotSensor};
pub(crate) use read::{Sections, floor, robot_sections};
pub use read::{StudyKind, read_robot_study, read_robot_study_logs, study_kind};
pub(super) use read::{kind_of, robot_study_of};

/// A robot study.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotStudy {
    /// The TOML file as the user named it.
    pub file: PathBuf,
    /// The robot, as the study names it: `ers7` is the embedded one.
    pub model: String,
    /// The robot's file, resolved against the study's folder; `None`: the embedded robot.
    pub model_path: Option<PathBuf>,
    /// What is believed of a robot that somebody else described; `None`: it is one of our own.
    pub described: Option<DescribedBeliefs>,
    /// How the trunk is held.
    pub scenario: RobotScenario,
    /// Height of the lowest foot above the floor at the start \[m\]; in [`RobotScenario::Floor`] only.
    pub drop_height_m: f64,
    /// Friction of the legs.
    pub friction: LegFrictionSpec,
    /// The controllers.
    pub control: ControlSpec,
    /// The floor; in [`RobotScenario::Floor`] only.
    pub floor: FloorSpec,
    /// The encoders.
    pub sensor: RobotSensorSpec,
    /// How sure the engineer is of what the study states; names are those of the robot's description.
    pub uncertain: Uncertain,
    /// What the logs call their columns, and in which units they have them.
    pub columns: Columns,
    /// At least one.
    pub logs: Vec<RobotStudyLog>,
}

/// What a robot study's logs are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotScenario {
    /// The trunk is clamped, all joints are driven.
    Air,
    /// The robot is dropped onto the floor and then free.
    Floor,
    /// The trunk is clamped and one joint's motor is switched off.
    Drop,
}

impl RobotScenario {
    pub(super) const WORDS: [(&'static str, Self); 3] =
        [("air", Self::Air), ("floor", Self::Floor), ("drop", Self::Drop)];

    /// The word in a study.
    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, scenario)| *scenario == self).map_or("", |(word, _)| word)
    }
}

/// Friction of the legs by joint 1, 2, 3; `None`: as the robot's file has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LegFrictionSpec {
    /// \[N m\]
    pub coulomb_nm: Option<[f64; 3]>,
    /// \[N m s/rad\]
    pub viscous_nm_s_rad: Option<[f64; 3]>,
}

/// Table `[control]`.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlSpec {
    /// How setpoints are read between two samples; linear unless stated, of described robots in steps.
    pub hold: Hold,
    /// What the derivative acts on; the error unless stated, of described robots the measurement.
    pub derivative: Derivative,
    /// Period at which the law is evaluated \[s\]; `None`: continuously.
    pub sample_period_s: Option<f64>,
    /// Gains P, I, D \[N m/rad, N m/(rad s), N m s/rad\] that differ from the robot's file, by joint or kind of joint.
    pub gains: BTreeMap<String, [f64; 3]>,
}

impl Default for ControlSpec {
    fn default() -> Self {
        Self { hold: Hold::Linear, derivative: Derivative::Error, sample_period_s: None, gains: BTreeMap::new() }
    }
}

/// Table `[floor]` (eqs 2.3-2.6); `None`: as in the reference walk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FloorSpec {
    /// `K_p` \[N/m^n\]
    pub stiffness_n_m: Option<f64>,
    /// `K_d` \[N s/m^(n+1)\]
    pub damping_n_s_m2: Option<f64>,
    /// `n`
    pub exponent: Option<f64>,
    /// `mu_st`
    pub static_friction: Option<f64>,
    /// `mu_c`
    pub coulomb: Option<f64>,
    /// `mu_v` \[s/m\]
    pub viscous_s_m: Option<f64>,
    /// `s` \[s/m\]
    pub steepness_s_m: Option<f64>,
    /// `v_st` \[m/s\]
    pub stribeck_speed_m_s: Option<f64>,
    /// Radius of torsional friction \[m\]
    pub torsion_radius_m: Option<f64>,
}

/// Table `[sensor]` of a robot study.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RobotSensorSpec {
    /// Quantisation step \[rad\]; `None`: unknown (0 or absent in the file).
    pub resolution_rad: Option<f64>,
    /// Sampling period \[s\].
    pub period_s: Option<f64>,
    /// Standard deviation of a reading before quantisation \[rad\].
    pub noise_rad: Option<f64>,
}

/// One `[[log]]` of a robot study.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotStudyLog {
    /// As written in the study.
    pub file: String,
    /// The file resolved against the study's folder.
    pub path: PathBuf,
    /// What the log is used for.
    pub role: Role,
    /// The joint that is let go; in [`RobotScenario::Drop`], and only there.
    pub release: Option<RobotRelease>,
    /// A known mass on the lower leg of the joint that is let go.
    pub extra: Option<ExtraMass>,
    /// How far the trunk was measured to go; in [`RobotScenario::Floor`] only.
    pub forward: Option<Forward>,
}

/// The joint whose motor is switched off.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotRelease {
    /// `lf2` for instance.
    pub joint: String,
    /// When, on the log's clock \[s\].
    pub time_s: f64,
}

/// A measured displacement of the trunk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forward {
    /// Forward is positive \[m\].
    pub distance_m: f64,
    /// From when, on the log's clock \[s\].
    pub from_s: f64,
    /// Until when \[s\]
    pub to_s: f64,
}
