//! Reads a log of several joints: `t`, then `<joint>.q` and, where present, `<joint>.q_ref`, `<joint>.tau`,
//! `<joint>.drive`; trunk and accelerometer columns.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::error::LogError;
use super::plausible;
use super::source::{Columns, Want, read_wanted, robot_log};
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

    /// A joint by name.
    pub fn joint(&self, name: &str) -> Option<&JointColumns> {
        self.joints.iter().find(|joint| joint.name == name)
    }
}

/// Reads a log of several joints.
///
/// # Errors
/// As [`read_log`](super::read_log); a joint without a `q` column, or with a reading or setpoint missing in a row, is
/// named with line and column.
pub fn read_robot_log(path: &Path) -> Result<RobotLog, LogError> {
    robot_log(read_wanted(path, Want::Robot, &Columns::default())?)
}

/// Reads the logs of a study, whose period is known where the study says it.
///
/// # Errors
/// The error of the first log, in their order, that cannot be read, or whose period is about 1000 times off the study's.
pub(super) fn read_robot_logs(
    paths: &[&Path],
    columns: &Columns,
    period_s: Option<f64>,
) -> Result<Vec<RobotLog>, LogError> {
    let read = |path: &&Path| {
        let log = robot_log(read_wanted(path, Want::Robot, columns)?)?;
        period_s.map_or(Ok(()), |period_s| plausible::check_stamps(&log.file, &log.t_s, period_s))?;
        Ok(log)
    };
    let logs: Vec<Result<RobotLog, LogError>> = paths.par_iter().map(read).collect();
    logs.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<RobotLog, LogError> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("log.csv");
        std::fs::write(&path, text).unwrap();
        read_robot_log(&path)
    }

    #[test]
    fn columns_are_found_in_any_order() {
        let log = read(
            "lf1.q_ref,t,volts,lf1.q,base.z,rr3.q,rr3.drive,acc.x,acc.y,acc.z\n\
             0.1,0,7.4,0.11,-1,0.2,1,0,9.81,0\n0.1,0.008,7.4,0.12,-1.5,0.3,0,0,9.8,0.1\n",
        )
        .unwrap();
        assert_eq!((log.len(), log.joints.len(), log.joints[1].name.as_str()), (2, 2, "rr3"));
        assert_eq!(log.joint("lf1").unwrap().q_ref_rad.as_deref(), Some(&[0.1, 0.1][..]));
        assert_eq!(log.joint("rr3").unwrap().drive.as_deref(), Some(&[true, false][..]));
        let base = log.base.unwrap();
        assert_eq!((base.z_m.as_deref(), base.x_m), (Some(&[-1.0, -1.5][..]), None));
        assert_eq!(log.acceleration_m_s2.unwrap()[1], [9.81, 9.8]);
        assert_eq!(log.ignored_columns, ["volts"]);
    }

    #[test]
    fn each_fault_is_one_error_that_names_line_and_column() {
        for (text, expected) in [
            ("t,lf1.q,lf1.q_ref\n0,0,0\n0.008,0,\n", "line 3, column `lf1.q_ref`: the cell is empty"),
            ("t,lf1.q,lf1.q_ref\n0,0,0\n0.008,0,nan\n", "line 3, column `lf1.q_ref`: found `nan`"),
            ("t,lf1.q\n0,0\n0,0\n", "line 3, column `t`: time repeats"),
            ("t,lf1.q,lf1.q\n0,0,0\n1,0,0\n", "column `lf1.q`: the column appears twice"),
            ("t,lf1.q,t\n0,0,0\n1,0,0\n", "column `t`: the column appears twice"),
            ("t,q\n0,0\n0.1,0\n", "column `<joint>.q` is missing"),
            ("t,lf1.q,lf2.q_ref\n0,0,0\n0.1,0,0\n", "column `lf2.q` is missing"),
            ("lf1.q\n0\n0\n", "column `t` is missing"),
            ("t;lf1.q\n0;0\n", "semicolons"),
            ("t,lf1.q\n0,0\n0.008\n", "line 3: 1 cells, expected 2"),
            ("t,lf1.q,lf1.drive\n0,0,2\n", "line 2, column `lf1.drive`: found `2`"),
            ("t,lf1.q\n0,0\n", "1 sample after the header"),
            ("t,lf1.q\n0,30\n0.008,31.5\n", "looks like degrees"),
            ("t,lf1.q\n0,0\n8,0\n16,0\n", "looks like milliseconds"),
            ("", "the file is empty"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(expected) && message.contains("log.csv"), "{text:?}: {message}");
        }
    }
}
