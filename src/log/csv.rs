//! The log of one joint, of a file of any format that is read.

use std::path::Path;

use super::error::LogError;
use super::source::{Columns, Want, joint_log, read_wanted};
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
    match read_wanted(path, Want::One, columns) {
        Ok(source) if source.joints().contains(&Some(joint)) => joint_log(source, Some(joint)),
        Ok(source) => joint_log(source, None),
        Err(LogError::SeveralJoints { joints, .. }) if joints.iter().any(|other| other == joint) => {
            joint_log(read_wanted(path, Want::Joint(joint), columns)?, Some(joint))
        }
        Err(error) => Err(error),
    }
}
