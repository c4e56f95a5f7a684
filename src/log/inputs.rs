//! Reads the logs that a study names and checks that they fit what the study says of them.

use rayon::prelude::*;

use super::csv::{read_joint_log, read_log};
use super::error::LogError;
use super::header::{Column, hint};
use super::plausible::check_period;
use super::types::{DriveMode, Log, Study, StudyLog};

/// Reads all logs of a study, in the study's order.
///
/// A log of several joints is read as the log of the study's joint, if it has a joint of that name.
///
/// # Errors
/// The error of the first log, in the study's order, that cannot be read, whose period is about 1000 times off
/// `[sensor] period`, or that lacks the column its `drive` needs (`q_ref` for "position", `tau` for "torque").
pub fn read_study_logs(study: &Study) -> Result<Vec<Log>, LogError> {
    let logs: Vec<Result<Log, LogError>> =
        study.logs.par_iter().enumerate().map(|(i, entry)| read_one(study, i, entry)).collect();
    logs.into_iter().collect()
}

fn read_one(study: &Study, i: usize, entry: &StudyLog) -> Result<Log, LogError> {
    let log = match read_log(&entry.path) {
        Err(LogError::SeveralJoints { joints, .. }) if joints.contains(&study.joint.name) => {
            read_joint_log(&entry.path, Some(&study.joint.name))
        }
        read => read,
    }?;
    check_period(&log, &study.sensor)?;
    let (needed, word) = match entry.drive {
        DriveMode::Position if log.q_ref_rad.is_none() => (Column::Setpoint, "position"),
        DriveMode::Torque if log.tau_nm.is_none() => (Column::Torque, "torque"),
        _ => return Ok(log),
    };
    Err(LogError::MissingInput {
        file: entry.path.clone().into_boxed_path(),
        study: study.file.clone().into_boxed_path(),
        entry: i + 1,
        drive: word,
        column: needed.name(),
        hint: hint(&entry.path, needed, &log.ignored_columns),
        found: columns(log),
    })
}

fn columns(log: Log) -> Vec<String> {
    let optional = [
        ("dq", log.dq_rad_s.is_some()),
        ("tau", log.tau_nm.is_some()),
        ("q_ref", log.q_ref_rad.is_some()),
        ("drive", log.drive.is_some()),
    ];
    let known = [("t", true), ("q", true)].into_iter().chain(optional).filter(|(_, there)| *there);
    known.map(|(name, _)| name.to_owned()).chain(log.ignored_columns).collect()
}
