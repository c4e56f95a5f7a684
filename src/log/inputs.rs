//! Reads the logs that a study names and checks that they fit what the study says of them.

use std::path::Path;

use rayon::prelude::*;

use super::column::Column;
use super::error::LogError;
use super::header::hint;
use super::plausible::check_period;
use super::read_log::read_joint_of_study;
use super::robot_log::{JointColumns, RobotLog};
use super::types::{DriveMode, Log, Study, StudyLog};

/// Reads all logs of a study, in the study's order.
///
/// A log of several joints is read as the log of the study's joint, if it has a joint of that name.
///
/// # Errors
/// The error of the first log, in the study's order, that cannot be read, whose period is about 1000 times off
/// `[sensor] period`, that lacks the column its `drive` needs (`q_ref` for "position", `tau` for "torque"), or whose `tau`
/// has lost its sign although the study says what it is.
pub fn read_study_logs(study: &Study) -> Result<Vec<Log>, LogError> {
    read_each_log(study, |_, log| log)
}

/// What is made of each log of a study, in the study's order: a log is not kept while the next is read.
///
/// # Errors
/// As [`read_study_logs`].
pub(crate) fn read_each_log<T: Send>(
    study: &Study,
    make: impl Fn(&StudyLog, Log) -> T + Sync,
) -> Result<Vec<T>, LogError> {
    let one = |(i, entry)| read_one(study, i, entry).map(|log| make(entry, log));
    let made: Vec<Result<T, LogError>> = study.logs.par_iter().enumerate().map(one).collect();
    made.into_iter().collect()
}

fn read_one(study: &Study, i: usize, entry: &StudyLog) -> Result<Log, LogError> {
    let log = read_joint_of_study(&entry.path, &study.columns, &study.joint.name)?;
    check_period(&log, &study.sensor)?;
    // What is wrong with the file is said of it, and not of a part.
    check_inputs(&study.file, i, entry, log)?.within(entry.window.as_ref(), (&study.file, i))
}

/// A log has the columns that its `drive` needs, and a torque has its sign; `i` counts the study's logs from 0.
pub(crate) fn check_inputs(study: &Path, i: usize, entry: &StudyLog, log: Log) -> Result<Log, LogError> {
    let (needed, word) = match entry.drive {
        DriveMode::Position if log.q_ref_rad.is_none() => (Column::Setpoint, "position"),
        DriveMode::Torque if log.tau_nm.is_none() => (Column::Torque, "torque"),
        _ => return check_torque_sign(&log, entry).map(|()| log),
    };
    Err(LogError::MissingInput {
        file: log.file.clone().into_boxed_path(),
        study: study.into(),
        entry: i + 1,
        drive: word,
        column: needed.name().into(),
        hint: hint(&log.file, needed, &log.ignored_columns),
        found: columns(log),
    })
}

/// The same of a joint of a robot's log, which `[[log]]` number `i`, from 0, drives.
pub(crate) fn check_joint_inputs(
    study: &Path,
    i: usize,
    drive: DriveMode,
    (log, joint): (&RobotLog, &JointColumns),
) -> Result<(), LogError> {
    let is_asked = joint.q_ref_rad.is_some() || joint.setpoints.is_some();
    let (needed, word) = match drive {
        DriveMode::Position if !is_asked => (Column::Setpoint, "position"),
        DriveMode::Torque if joint.tau_nm.is_none() => (Column::Torque, "torque"),
        _ => return Ok(()),
    };
    let names = log.joints.iter().map(|joint| format!("{}.{}", joint.name, Column::Angle.name()));
    Err(LogError::MissingInput {
        file: log.file.clone().into_boxed_path(),
        study: study.into(),
        entry: i + 1,
        drive: word,
        column: format!("{}.{}", joint.name, needed.name()).into(),
        found: names.chain(log.ignored_columns.iter().cloned()).collect(),
        hint: Some(format!("without = [\"{}\"] in [robot] leaves the joint out", joint.name)),
    })
}

/// A log of which nothing says how it is driven is a free swing, unless what it was asked varies.
pub(crate) fn check_drive_stated(log: &Log) -> Result<(), LogError> {
    let varies = |values: &Option<Vec<f64>>| values.as_ref().is_some_and(|v| v.iter().any(|value| *value != v[0]));
    let column = match log {
        Log { drive: Some(_), .. } => return Ok(()),
        log if varies(&log.q_ref_rad) => Column::Setpoint,
        log if varies(&log.tau_nm) => Column::Torque,
        _ => return Ok(()),
    };
    Err(LogError::DriveUnknown { file: log.file.clone(), column: column.name() })
}

/// Share of the larger pull of the setpoint that the smaller one has to reach in a joint that is pulled both ways.
const BOTH_WAYS: f64 = 0.2;
/// Share of the samples at either end that do not count in that.
const TAILS: usize = 20;

/// Refuses a `tau` that is said to be a torque or a current of a position-driven log and has no sign: no negative value,
/// although the joint moves both ways and its setpoint pulls it both ways. A joint that only ever has to be held up may
/// well see one sign, its setpoint is then always on one side.
pub(crate) fn check_torque_sign(log: &Log, entry: &StudyLog) -> Result<(), LogError> {
    let (Some(_), Some(tau), Some(q_ref)) = (entry.tau_is, &log.tau_nm, &log.q_ref_rad) else { return Ok(()) };
    let has_sign = tau.iter().any(|tau| *tau < 0.0) || tau.iter().all(|tau| *tau == 0.0);
    let pull = q_ref.iter().zip(&log.q_rad).map(|(q_ref, q)| q_ref - q).collect();
    let moves = log.q_rad.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if has_sign || !both_ways(pull) || !both_ways(moves) {
        return Ok(());
    }
    Err(LogError::UnsignedTorque { file: log.file.clone() })
}

fn both_ways(mut values: Vec<f64>) -> bool {
    values.sort_unstable_by(f64::total_cmp);
    let tail = values.len() / TAILS;
    let (Some(low), Some(high)) = (values.get(tail), values.iter().rev().nth(tail)) else { return false };
    *low < 0.0 && *high > 0.0 && low.abs().min(*high) >= BOTH_WAYS * low.abs().max(*high)
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
