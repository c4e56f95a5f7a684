//! A log of several joints: what was read and asked of each, and of the trunk.

use std::path::PathBuf;

use super::types::Stamped;

/// A log of a whole robot: samples in columns, all of the same length.
///
/// Invariants that the reader has checked: at least two samples, `t_s` strictly increasing, every number finite, at least
/// one joint, no joint twice.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotLog {
    /// The file as the user named it; used in messages only.
    pub file: PathBuf,
    /// Sample times \[s\], strictly increasing, not necessarily uniform.
    pub t_s: Vec<f64>,
    /// At least one, in the order of their `q` columns.
    pub joints: Vec<JointColumns>,
    /// The trunk, where the log has any column of it.
    pub base: Option<BaseColumns>,
    /// Accelerometer readings along the trunk's x, y, z \[m/s^2\], where the log has all three.
    pub acceleration_m_s2: Option<[Vec<f64>; 3]>,
    /// Columns that were present and are not used, in file order.
    pub ignored_columns: Vec<String>,
    /// What the reader of the file decided, in sentences.
    pub notes: Vec<String>,
}

/// One joint of a [`RobotLog`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointColumns {
    /// `lf1` for instance.
    pub name: String,
    /// Angle as the encoder reads it \[rad\].
    pub q_rad: Vec<f64>,
    /// Setpoint \[rad\]: the one in force at each sample.
    pub q_ref_rad: Option<Vec<f64>>,
    /// The setpoints at stamps of their own \[rad\], where they do not come with the readings.
    pub setpoints: Option<Stamped>,
    /// Torque \[N m\].
    pub tau_nm: Option<Vec<f64>>,
    /// Whether the motor is on, from each sample to the next; `None`: as the study says.
    pub drive: Option<Vec<bool>>,
}

/// The trunk along a [`RobotLog`]; `R = Ry(yaw) Rx(pitch) Rz(roll)`.
#[derive(Clone, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "the fields are the columns base.x to base.yaw, in m and rad")]
pub struct BaseColumns {
    pub x_m: Option<Vec<f64>>,
    pub y_m: Option<Vec<f64>>,
    pub z_m: Option<Vec<f64>>,
    pub roll_rad: Option<Vec<f64>>,
    pub pitch_rad: Option<Vec<f64>>,
    pub yaw_rad: Option<Vec<f64>>,
}

impl RobotLog {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.t_s.len()
    }

    /// Always false for a log that the reader has accepted.
    pub fn is_empty(&self) -> bool {
        self.t_s.is_empty()
    }

    /// What its reader decided, in a sentence; `None` where that was nothing.
    pub(crate) fn remark(&self) -> Option<String> {
        (!self.notes.is_empty()).then(|| format!("{}: {}.", self.file.display(), self.notes.join("; ")))
    }

    /// A joint by name.
    pub fn joint(&self, name: &str) -> Option<&JointColumns> {
        self.joints.iter().find(|joint| joint.name == name)
    }
}
