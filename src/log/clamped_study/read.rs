//! From the TOML to a checked study.

use std::collections::BTreeMap;
use std::path::Path;

use toml::Spanned;

use super::raw::{RawBeliefs, RawBelieved, RawClampedLog, RawClampedStudy};
use super::{ClampedStudy, ClampedStudyLog, JointBeliefs, Predict};
use crate::log::about::about;
use crate::log::beliefs::{ANY_NAME, uncertain};
use crate::log::columns::Columns;
use crate::log::document::{Document, NOT_NEGATIVE, PERIOD, POSITIVE, Range64, range};
use crate::log::error::LogError;
use crate::log::motor::{DERIVATIVES, ENCODERS, HOLDS, each_key, model, tau_is};
use crate::log::motor_types::{Derivative, Hold};
use crate::log::raw_columns::columns;
use crate::log::read_log::read_robot_logs;
use crate::log::robot_log::RobotLog;
use crate::log::schema::{RawLog, RawMotor};
use crate::log::study::{DRIVES, Named, ROLES, Seen, check_schema, named_log, sensor};
use crate::log::types::{DriveMode, Role};

/// The table of beliefs that holds for all joints.
const ALL: &str = "default";

const GRAVITY: Range64 = range(|x| x.abs() <= 100.0, "components of at most 100 m/s^2");

/// Reads a study of a robot with a clamped base; its logs have to exist but are not read yet.
///
/// # Errors
/// [`LogError`] naming the file and the key: unknown keys, missing keys, values out of range, logs that are not there.
pub fn read_clamped_study(path: &Path) -> Result<ClampedStudy, LogError> {
    clamped_study_of(&Document::open(path)?)
}

/// The study that a document is.
pub(in crate::log) fn clamped_study_of(document: &Document<'_>) -> Result<ClampedStudy, LogError> {
    let raw: RawClampedStudy = document.parse_any()?;
    check_schema(document, &raw.schema)?;
    about(document, &raw.about)?;
    if raw.log.is_empty() {
        return Err(document.missing("[[log]]", "at least one log"));
    }
    let mut seen = Seen::new();
    let logs = raw.log.iter().enumerate().map(|(i, entry)| log(document, i, entry, &mut seen));
    let logs: Vec<ClampedStudyLog> = logs.collect::<Result<_, _>>()?;
    if !logs.iter().any(|log| log.role == Role::Fit) {
        return Err(document
            .missing("[[log]] role = \"fit\"", "at least one log with role = \"fit\", to which numbers are fitted"));
    }
    let predict = predict(document, &raw.log, &logs)?;
    tau_is_of_setpoints(document, &raw.joints, &logs)?;
    let columns = columns(document, &raw.columns)?;
    let RawClampedStudy { robot, joints, groups, control, sensor, uncertain, .. } = raw;
    let believed = believed(document, RawBelieved { robot, joints, groups, control, sensor, uncertain })?;
    Ok(ClampedStudy { logs, predict, columns, ..believed })
}

/// What a document believes of a robot with a clamped base; it has no logs.
///
/// # Errors
/// As [`read_clamped_study`].
pub(crate) fn believed(document: &Document<'_>, raw: RawBelieved) -> Result<ClampedStudy, LogError> {
    let scenario = [("fixed", ())];
    document.needed_word("[robot] scenario", &raw.robot.scenario, &scenario)?;
    let expected = "the path of a robot's description: URDF, MJCF or TOML";
    let model = raw.robot.model.as_ref().ok_or_else(|| document.missing("[robot] model", expected))?;
    if model.get_ref().trim().is_empty() {
        return Err(document.wrong("[robot] model", model.span(), "an empty name", expected));
    }
    let folder = document.file.parent().unwrap_or(Path::new(""));
    let gravity_m_s2 = raw.robot.gravity.as_ref().map(|gravity| self::gravity(document, gravity)).transpose()?;
    let JointTables { all, all_lacks, by_joint } = joint_tables(document, &raw.joints)?;
    let hold = document.word("[control] hold", &raw.control.hold, &HOLDS)?.unwrap_or(Hold::Step);
    let derivative = document.word("[control] derivative", &raw.control.derivative, &DERIVATIVES)?;
    let derivative = derivative.unwrap_or(Derivative::Measurement);
    if derivative == Derivative::Error && hold == Hold::Step {
        let span = raw.control.derivative.as_ref().map_or(0..0, Spanned::span);
        let expected = "hold = \"linear\" beside it: a setpoint held in steps has no derivative";
        return Err(document.wrong("[control] derivative", span, "\"error\" with hold = \"step\"", expected));
    }
    Ok(ClampedStudy {
        file: document.file.to_path_buf(),
        model_path: folder.join(model.get_ref()),
        without: raw.robot.without,
        tip: raw.robot.tip.map(Spanned::into_inner),
        gravity_m_s2,
        all,
        all_lacks,
        by_joint,
        groups: raw.groups.into_iter().map(|(name, joints)| (name, joints.into_inner())).collect(),
        hold,
        derivative,
        sample_period_s: document.number("[control] sample_period", &raw.control.sample_period, PERIOD)?,
        sensor: sensor(document, &raw.sensor)?,
        uncertain: uncertain(document, &raw.uncertain, ANY_NAME)?,
        columns: Columns::default(),
        predict: Predict::default(),
        logs: Vec::new(),
    })
}

/// Tables `[joints.NAME]`, checked.
pub(in crate::log) struct JointTables {
    pub all: JointBeliefs,
    /// What that lacks to be a motor, in words.
    pub all_lacks: Option<String>,
    pub by_joint: BTreeMap<String, JointBeliefs>,
}

/// Checks tables `[joints.NAME]`.
pub(in crate::log) fn joint_tables(
    document: &Document<'_>,
    joints: &BTreeMap<String, RawBeliefs>,
) -> Result<JointTables, LogError> {
    let of_all = joints.get(ALL);
    let (all, all_lacks) = of_all.map(|of_all| beliefs_of_all(document, of_all)).transpose()?.unwrap_or_default();
    let motor_of_all = of_all.map(RawBeliefs::as_motor);
    let mut by_joint = BTreeMap::new();
    for (name, joint) in joints.iter().filter(|(name, _)| *name != ALL) {
        by_joint.insert(name.clone(), beliefs(document, name, joint, motor_of_all.as_ref())?);
    }
    Ok(JointTables { all, all_lacks, by_joint })
}

/// Reads the logs of a study, in the study's order.
///
/// # Errors
/// The error of the first log, in the study's order, that cannot be read, or whose period is about 1000 times off
/// `[sensor] period`, or of which a part is asked for that has no two samples.
pub fn read_clamped_study_logs(study: &ClampedStudy) -> Result<Vec<RobotLog>, LogError> {
    let paths: Vec<&Path> = study.logs.iter().map(|log| log.path.as_path()).collect();
    within(study, read_robot_logs(&paths, &study.columns, study.sensor.period_s)?)
}

/// The parts of its logs that a study takes.
pub(in crate::log) fn within(study: &ClampedStudy, logs: Vec<RobotLog>) -> Result<Vec<RobotLog>, LogError> {
    let entries = study.logs.iter().enumerate();
    logs.into_iter().zip(entries).map(|(log, (i, entry))| log.within(entry.window.as_ref(), (&study.file, i))).collect()
}

fn gravity(document: &Document<'_>, raw: &Spanned<Vec<f64>>) -> Result<[f64; 3], LogError> {
    let key = "[robot] gravity";
    let Ok(numbers) = <[f64; 3]>::try_from(raw.get_ref().as_slice()) else {
        let found = format!("{} numbers", raw.get_ref().len());
        return Err(document.wrong(key, raw.span(), found, "3 numbers [m/s^2], in the description's axes"));
    };
    for number in numbers {
        document.within(key, raw.span(), number, GRAVITY)?;
    }
    Ok(numbers)
}

/// What is believed of a joint; its motor has the keys of that of all joints where it has none itself.
fn beliefs(
    document: &Document<'_>,
    joint: &str,
    raw: &RawBeliefs,
    of_all: Option<&RawMotor>,
) -> Result<JointBeliefs, LogError> {
    let table = table(joint);
    // Beside a torque that is logged, constants of currents that all joints have mean nothing.
    let is_torque = raw.tau_is.as_ref().is_some_and(|said| said.get_ref() != "current");
    let of_all = of_all.cloned().map(|of_all| if is_torque { of_all.without_current() } else { of_all });
    let motor = raw.as_motor().over(of_all.unwrap_or_default());
    with_motor(document, &table, raw, &motor, numbers(document, &table, raw)?)
}

/// What is believed of all joints, and what it lacks to be a motor, which the table of each joint may say; keys and values are
/// checked here, for no joint may need them.
fn beliefs_of_all(document: &Document<'_>, raw: &RawBeliefs) -> Result<(JointBeliefs, Option<String>), LogError> {
    let (table, motor) = (table(ALL), raw.as_motor());
    each_key(document, &table, &motor)?;
    let said = numbers(document, &table, raw)?;
    Ok(match with_motor(document, &table, raw, &motor, said) {
        Ok(whole) => (whole, None),
        Err(lacks) => (said, Some(lacks.to_string())),
    })
}

/// What stands before a key of a joint.
fn table(joint: &str) -> String {
    format!("[joints.{joint}] ")
}

/// What a joint's table says of numbers and of the encoder, each by itself.
fn numbers(document: &Document<'_>, table: &str, raw: &RawBeliefs) -> Result<JointBeliefs, LogError> {
    let number = |name: &str, value, of| document.number(&format!("{table}{name}"), value, of);
    Ok(JointBeliefs {
        coulomb_nm: number("coulomb", &raw.coulomb, NOT_NEGATIVE)?,
        viscous_nm_s_rad: number("viscous", &raw.viscous, NOT_NEGATIVE)?,
        armature_kg_m2: number("armature", &raw.armature, NOT_NEGATIVE)?,
        kp_nm_rad: number("kp", &raw.kp, NOT_NEGATIVE)?,
        ki_nm_rad_s: number("ki", &raw.ki, NOT_NEGATIVE)?,
        kd_nm_s_rad: number("kd", &raw.kd, NOT_NEGATIVE)?,
        torque_limit_nm: number("torque_limit", &raw.torque_limit, POSITIVE)?,
        speed_limit_rad_s: number("speed_limit", &raw.speed_limit, POSITIVE)?,
        encoder: document.word(&format!("{table}encoder"), &raw.encoder, &ENCODERS)?,
        ..JointBeliefs::default()
    })
}

/// These beliefs with what turns the law's answer into torque, where the table says it, and with what logged torques are.
fn with_motor(
    document: &Document<'_>,
    table: &str,
    raw: &RawBeliefs,
    motor: &RawMotor,
    said: JointBeliefs,
) -> Result<JointBeliefs, LogError> {
    let model = model(document, table, motor)?;
    let tau_is = tau_is(document, table, &RawLog::default(), Some((table, motor)), DriveMode::Position)?;
    Ok(JointBeliefs { model: raw.says_of_motor().then_some(model), tau_is, ..said })
}

/// What logged torques are is said of logs that setpoints drive: in the others they are what is applied.
fn tau_is_of_setpoints(
    document: &Document<'_>,
    joints: &BTreeMap<String, RawBeliefs>,
    logs: &[ClampedStudyLog],
) -> Result<(), LogError> {
    if logs.iter().any(|log| log.drive == DriveMode::Position) {
        return Ok(());
    }
    let Some((joint, said)) = joints.iter().find_map(|(joint, raw)| Some((joint, raw.tau_is.as_ref()?))) else {
        return Ok(());
    };
    let found = format!("\"{}\" in a study without a log that is driven by position", said.get_ref());
    let expected = "tau_is beside drive = \"position\" only: with drive = \"torque\" the column is applied, in N m";
    Err(document.wrong(&format!("{}tau_is", table(joint)), said.span(), found, expected))
}

fn log(document: &Document<'_>, i: usize, raw: &RawClampedLog, seen: &mut Seen) -> Result<ClampedStudyLog, LogError> {
    let key = |name: &str| format!("[[log]] {} {name}", i + 1);
    let Named { file, path, window } = named_log(document, i, &raw.file, [&raw.from, &raw.to], seen)?;
    Ok(ClampedStudyLog {
        file,
        path,
        role: document.needed_word(&key("role"), &raw.role, &ROLES)?,
        drive: document.word(&key("drive"), &raw.drive, &DRIVES)?.unwrap_or(DriveMode::Position),
        session: raw.session.as_ref().map(|session| session.get_ref().clone()),
        window,
    })
}

/// What is predicted, the same of all logs: torques along a motion are another question than the motion that torques make.
fn predict(document: &Document<'_>, raw: &[RawClampedLog], logs: &[ClampedStudyLog]) -> Result<Predict, LogError> {
    const WORDS: [(&str, Predict); 2] = [("motion", Predict::Motion), ("torque", Predict::Torque)];
    let mut of_first = None;
    for (i, (raw, log)) in raw.iter().zip(logs).enumerate() {
        let key = format!("[[log]] {} predict", i + 1);
        let own = document.word(&key, &raw.predict, &WORDS)?.unwrap_or_default();
        let span = || raw.predict.as_ref().map_or(0..0, Spanned::span);
        if own == Predict::Torque && log.drive != DriveMode::Torque {
            let expected = "drive = \"torque\" beside it, and the torque in `<joint>.tau`";
            return Err(document.wrong(&key, span(), "\"torque\"", expected));
        }
        if *of_first.get_or_insert(own) != own {
            let found = "another prediction than that of the logs before it";
            return Err(document.wrong(&key, span(), found, "the same in all logs of a study"));
        }
    }
    Ok(of_first.unwrap_or_default())
}
