//! The log of one joint, or of all of a robot, of a file of any format that is read.

use std::path::Path;

use rayon::prelude::*;

use super::columns::Columns;
use super::error::LogError;
use super::plausible;
use super::robot_log::RobotLog;
use super::source::{Want, joint_log, read_wanted, robot_log};
use super::types::Log;

/// Reads the log of one joint: columns `t` \[s\], `q` \[rad\] and, where present, `dq`, `tau`, `q_ref`, `drive`, or the
/// only joint of a file of another format.
///
/// Columns are found by name in any order; others are ignored and listed in [`Log::ignored_columns`].
///
/// # Errors
/// [`LogError`] for anything that is not a well-formed log; see its variants. All defects of a table are told at once.
pub fn read_log(path: &Path) -> Result<Log, LogError> {
    read_joint_log(path, None)
}

/// Reads one joint of a log of several (`<joint>.q`, `<joint>.q_ref`, ...); without a joint as [`read_log`].
///
/// # Errors
/// As [`read_log`], and [`LogError::NoSuchJoint`] if the log does not have the joint.
pub fn read_joint_log(path: &Path, joint: Option<&str>) -> Result<Log, LogError> {
    read_joint_log_as(path, &Columns::default(), joint)
}

/// As [`read_joint_log`], of a file whose columns have names and units of its own.
///
/// # Errors
/// As [`read_joint_log`].
pub fn read_joint_log_as(path: &Path, columns: &Columns, joint: Option<&str>) -> Result<Log, LogError> {
    let want = joint.map_or(Want::One, Want::Joint);
    joint_log(read_wanted(path, want, columns)?, joint)
}

/// Reads the log of a study's joint, of a file of one joint or of several, by what `[columns]` says of it.
///
/// # Errors
/// As [`read_joint_log`].
pub(super) fn read_joint_of_study(path: &Path, columns: &Columns, joint: &str) -> Result<Log, LogError> {
    let read = match read_wanted(path, Want::One, columns) {
        Ok(source) if source.joints().contains(&Some(joint)) => joint_log(source, Some(joint)),
        Ok(source) => joint_log(source, None),
        Err(LogError::SeveralJoints { joints, .. }) if joints.iter().any(|other| other == joint) => {
            joint_log(read_wanted(path, Want::Joint(joint), columns)?, Some(joint))
        }
        Err(error) => Err(error),
    };
    read.map_err(|error| match error {
        LogError::SeveralJoints { at, joints } => LogError::NotTheStudysJoint { at, joint: joint.to_owned(), joints },
        other => other,
    })
}

/// Reads a log of several joints: `t`, then `<joint>.q` and, where present, `<joint>.q_ref`, `<joint>.tau`,
/// `<joint>.drive`; trunk and accelerometer columns.
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
