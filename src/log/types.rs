//! What a log and a study are once they have been read: plain data, SI units, radians.

use super::columns::Columns;
use super::motor_types::{MotorSpec, TauIs};
use super::uncertain::Uncertain;
use super::window::Window;
use std::path::PathBuf;

/// One logged joint: samples in columns, all of the same length.
///
/// Invariants that the reader has checked: at least two samples, `t_s` strictly increasing, every number finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Log {
    /// The file as the user named it; used in messages only.
    pub file: PathBuf,
    /// Sample times \[s\], strictly increasing, not necessarily uniform.
    pub t_s: Vec<f64>,
    /// Joint angle as the encoder reads it \[rad\].
    pub q_rad: Vec<f64>,
    /// Joint speed as the drive reports it \[rad/s\]; never fitted, drawn only.
    pub dq_rad_s: Option<Vec<f64>>,
    /// Torque column \[N m\]: the input of a torque-driven log, information otherwise.
    pub tau_nm: Option<Vec<f64>>,
    /// Position setpoint \[rad\]: the one in force at each sample.
    pub q_ref_rad: Option<Vec<f64>>,
    /// The setpoints at stamps of their own \[rad\], where they do not come with the readings.
    pub setpoints: Option<Stamped>,
    /// Column `drive`: 1 is `true` (motor on, or joint held in a log with `drive = "off"`).
    pub drive: Option<Vec<bool>>,
    /// Columns that were present and are not used, in file order.
    pub ignored_columns: Vec<String>,
    /// What the reader of the file decided, in sentences.
    pub notes: Vec<String>,
}

/// Values at stamps of their own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stamped {
    /// \[s\], strictly increasing, in the time of the log that they belong to.
    pub t_s: Vec<f64>,
    /// As many.
    pub values: Vec<f64>,
}

impl Log {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.t_s.len()
    }

    /// Always false for a log that the reader has accepted.
    pub fn is_empty(&self) -> bool {
        self.t_s.is_empty()
    }
}

/// A joint study: what the engineer believes about one joint, and the logs that speak about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// The TOML file as the user named it.
    pub file: PathBuf,
    /// The joint and its nominal model.
    pub joint: JointSpec,
    /// Its encoder.
    pub sensor: SensorSpec,
    /// The controller of driven logs; `None` where no log is driven by position.
    pub motor: Option<MotorSpec>,
    /// How sure the engineer is of what the study states.
    pub uncertain: Uncertain,
    /// What the logs call their columns, and in which units they have them.
    pub columns: Columns,
    /// At least one.
    pub logs: Vec<StudyLog>,
    /// Only in the sidecar of a single log.
    pub release: Option<Release>,
}

/// Table `[joint]` of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct JointSpec {
    /// As the robot calls it, e.g. `q1`.
    pub name: String,
    /// The nominal model; absent in the sidecar of a single log.
    pub nominal: Option<Nominal>,
    /// Acceleration of gravity \[m/s^2\].
    pub gravity_m_s2: f64,
    /// Logged angle at which the bare joint hangs \[rad\]; `None`: to be estimated.
    pub rest_rad: Option<f64>,
}

/// The baseline joint's four numbers: `I* q'' + mu_c sign(q') + mu_v q' + g M* sin(q - rest) = tau` (3.12, 3.14).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nominal {
    /// `I*` of the bare link about the joint axis \[kg m^2\], above zero.
    pub inertia_kg_m2: f64,
    /// `M* = sum(M D)` of the bare link \[kg m\], zero or above.
    pub moment_kg_m: f64,
    /// Coulomb friction `mu_c` \[N m\], zero or above.
    pub coulomb_nm: f64,
    /// Viscous friction `mu_v` \[N m s/rad\], zero or above.
    pub viscous_nm_s_rad: f64,
}

/// Table `[sensor]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SensorSpec {
    /// Quantisation step \[rad\]; `None`: unknown (0 or absent in the file).
    pub resolution_rad: Option<f64>,
    /// Nominal sampling period \[s\].
    pub period_s: Option<f64>,
}

/// What a log of a study is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Parameters are fitted to it.
    Fit,
    /// Held back: predicted only.
    Validate,
}

/// What moves the joint in a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveMode {
    /// Free swing; a sample with `drive = 1` is held.
    Off,
    /// `q_ref` through the motor's controller.
    Position,
    /// Column `tau`, held from its sample to the next.
    Torque,
}

/// A known mass hung on the link: a thin-walled hollow cylinder (3.8-3.10).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtraMass {
    /// \[kg\]
    pub mass_kg: f64,
    /// Joint axis to its centre of mass \[m\].
    pub distance_m: f64,
    /// \[m\]
    pub radius_m: f64,
    /// \[m\]
    pub length_m: f64,
}

/// One `[[log]]` entry, with the motor that is in force for it.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyLog {
    /// As written in the study; where a part of it is taken, with that.
    pub file: String,
    /// The file resolved against the study's folder.
    pub path: PathBuf,
    /// What the log is used for.
    pub role: Role,
    /// What moves the joint.
    pub drive: DriveMode,
    /// `[motor]` with this log's overrides applied.
    pub motor: Option<MotorSpec>,
    /// A known mass on the link.
    pub extra: Option<ExtraMass>,
    /// Logs of one session were taken in one go; `None`: this log stands alone.
    pub session: Option<String>,
    /// What the column `tau` of a position-driven log is; `None`: information only.
    pub tau_is: Option<TauIs>,
    /// The part of the file that is taken; `None`: all of it.
    pub window: Option<Window>,
}

/// Table `[release]` of a sidecar: what the person at the bench noted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Release {
    /// The motor is off from here on \[s\].
    pub time_s: Option<f64>,
    /// Setpoint of the held joint \[rad\].
    pub setpoint_rad: Option<f64>,
    /// Mean reading while held \[rad\].
    pub angle_rad: Option<f64>,
}
