//! Studies of any robot whose base its description fixes: what the engineer believes beyond the description, joint by
//! joint, and the logs.
//!
//! Plain data: the description is not read here, and names of joints are not looked up in it.

mod raw;
mod read;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::columns::Columns;
use super::motor_types::{Derivative, EncoderSide, Hold, MotorModel, TauIs};
use super::types::{DriveMode, Role, SensorSpec};
use super::uncertain::Uncertain;
use super::window::Window;

pub(crate) use raw::{RawBeliefs, RawBelieved, RawDescribed, RawLoop};
pub(crate) use read::believed;
pub(super) use read::{JointTables, clamped_study_of, joint_tables, within};
pub use read::{read_clamped_study, read_clamped_study_logs};

/// A study of a robot with a clamped base.
#[derive(Clone, Debug, PartialEq)]
pub struct ClampedStudy {
    /// The TOML file as the user named it.
    pub file: PathBuf,
    /// The robot's description, resolved against the study's folder.
    pub model_path: PathBuf,
    /// The link that carries a payload; `None`: the end of the longest chain.
    pub tip: Option<String>,
    /// Gravity in the description's axes \[m/s^2\]; `None`: as the description has it.
    pub gravity_m_s2: Option<[f64; 3]>,
    /// Joints of the logs that are not the robot's, or are to be left out.
    pub without: Vec<String>,
    /// What is believed of all joints.
    pub all: JointBeliefs,
    /// What that lacks to be the motor of a joint without beliefs of its own, in words; `None`: nothing.
    pub all_lacks: Option<String>,
    /// What is believed of single joints, by name.
    pub by_joint: BTreeMap<String, JointBeliefs>,
    /// Joints that may share a cause, by the group's name.
    pub groups: BTreeMap<String, Vec<String>>,
    /// How setpoints are read between two samples; in steps unless stated.
    pub hold: Hold,
    /// What the derivative term acts on; the measurement unless stated.
    pub derivative: Derivative,
    /// Period at which the law is evaluated \[s\]; `None`: continuously.
    pub sample_period_s: Option<f64>,
    /// The encoders.
    pub sensor: SensorSpec,
    /// How sure the engineer is of what study and description state; names are those of joints and links.
    pub uncertain: Uncertain,
    /// What the logs call their columns, and in which units they have them.
    pub columns: Columns,
    /// What is predicted of all logs.
    pub predict: Predict,
    /// At least one.
    pub logs: Vec<ClampedStudyLog>,
}

/// What of a log is predicted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Predict {
    /// The motion, from setpoints or torques.
    #[default]
    Motion,
    /// The torques along the measured motion, for arms whose open loop diverges.
    Torque,
}

/// What a study says of a joint beyond the robot's description; `None`: nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointBeliefs {
    /// \[N m\]
    pub coulomb_nm: Option<f64>,
    /// \[N m s/rad\]
    pub viscous_nm_s_rad: Option<f64>,
    /// Inertia of rotor and gears as the joint feels it \[kg m^2\].
    pub armature_kg_m2: Option<f64>,
    /// \[N m/rad\], or duty per radian of a motor fed by voltage.
    pub kp_nm_rad: Option<f64>,
    /// \[N m/(rad s)\]
    pub ki_nm_rad_s: Option<f64>,
    /// \[N m s/rad\]
    pub kd_nm_s_rad: Option<f64>,
    /// \[N m\]
    pub torque_limit_nm: Option<f64>,
    /// \[rad/s\]
    pub speed_limit_rad_s: Option<f64>,
    /// What turns the law's answer into torque.
    pub model: Option<MotorModel>,
    /// The side of the gearing on which the encoder sits.
    pub encoder: Option<EncoderSide>,
    /// What the torques of position-driven logs are.
    pub tau_is: Option<TauIs>,
}

impl JointBeliefs {
    /// What is believed of a joint where these are the beliefs of all.
    #[must_use]
    pub fn of_joint(self, name: &str, by_joint: &BTreeMap<String, Self>) -> Self {
        by_joint.get(name).map_or(self, |own| own.over(self))
    }

    /// These beliefs, with others where they say nothing.
    #[must_use]
    pub fn over(self, base: Self) -> Self {
        Self {
            coulomb_nm: self.coulomb_nm.or(base.coulomb_nm),
            viscous_nm_s_rad: self.viscous_nm_s_rad.or(base.viscous_nm_s_rad),
            armature_kg_m2: self.armature_kg_m2.or(base.armature_kg_m2),
            kp_nm_rad: self.kp_nm_rad.or(base.kp_nm_rad),
            ki_nm_rad_s: self.ki_nm_rad_s.or(base.ki_nm_rad_s),
            kd_nm_s_rad: self.kd_nm_s_rad.or(base.kd_nm_s_rad),
            torque_limit_nm: self.torque_limit_nm.or(base.torque_limit_nm),
            speed_limit_rad_s: self.speed_limit_rad_s.or(base.speed_limit_rad_s),
            model: self.model.or(base.model),
            encoder: self.encoder.or(base.encoder),
            tau_is: self.tau_is.or(base.tau_is),
        }
    }
}

/// One `[[log]]` of the study.
#[derive(Clone, Debug, PartialEq)]
pub struct ClampedStudyLog {
    /// As written in the study; where a part of it is taken, with that.
    pub file: String,
    /// The file resolved against the study's folder.
    pub path: PathBuf,
    /// What the log is used for.
    pub role: Role,
    /// What moves the joints.
    pub drive: DriveMode,
    /// Logs of one session were taken in one go.
    pub session: Option<String>,
    /// The part of the file that is taken; `None`: all of it.
    pub window: Option<Window>,
}

impl ClampedStudy {
    /// What the study says of a joint.
    pub fn of_joint(&self, name: &str) -> JointBeliefs {
        self.all.of_joint(name, &self.by_joint)
    }
}
