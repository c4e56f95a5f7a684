//! Reads a joint study, and the sidecar of a single log.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use toml::Spanned;

use super::about::about;
use super::beliefs::{JOINT_NAMES, uncertain};
use super::document::{ANGLE, Document, FINITE, Number, PERIOD, Range64, Text, range};
use super::error::LogError;
use super::motor::{motor, tau_is};
use super::raw_columns::columns;
use super::schema::{RawExtra, RawJoint, RawLog, RawMotor, RawRelease, RawSensor, RawStudy};
use super::source::is_log_folder;
use super::types::{DriveMode, ExtraMass, JointSpec, Nominal, Release, Role, SensorSpec, Study, StudyLog};
use super::window::{Window, overlap};
use crate::number::STANDARD_GRAVITY_M_S2;

const INERTIA: Range64 = range(|x| x > 0.0 && x < 1e4, "a number above 0 and below 1e4 (kg m^2)");
const MOMENT: Range64 = range(|x| x >= 0.0, "a number not below 0 (kg m)");
const TORQUE: Range64 = range(|x| x >= 0.0, "a number not below 0 (N m)");
const VISCOUS: Range64 = range(|x| x >= 0.0, "a number not below 0 (N m s/rad)");
const GRAVITY: Range64 = range(|x| x > 0.0 && x <= 30.0, "a number above 0 and at most 30 (m/s^2), without sign");
pub(super) const RESOLUTION: Range64 =
    range(|x| (0.0..0.5).contains(&x), "a step from 0 (unknown) to below 0.5 rad; a larger one looks like degrees");
const MASS: Range64 =
    range(|x| x > 0.0 && x <= 100.0, "a mass above 0 and at most 100 kg; a larger one looks like grams");
const DISTANCE: Range64 =
    range(|x| x > 0.0 && x <= 10.0, "a length above 0 and at most 10 m; a larger one looks like millimetres");
const SIZE: Range64 =
    range(|x| (0.0..=10.0).contains(&x), "a length from 0 to 10 m; a larger one looks like millimetres");

pub(super) const ROLES: [(&str, Role); 2] = [("fit", Role::Fit), ("validate", Role::Validate)];
pub(super) const DRIVES: [(&str, DriveMode); 3] =
    [("off", DriveMode::Off), ("position", DriveMode::Position), ("torque", DriveMode::Torque)];

/// Reads a joint study: nominal model, sensor, motor, and the logs, which have to exist but are not read yet.
///
/// `[log.extra]` without `radius` or `length` is a point mass; gravity is 9.81 m/s^2 unless stated.
///
/// # Errors
/// [`LogError`] naming the file and the key: unknown keys, missing keys, values out of range, logs that are not there.
pub fn read_study(path: &Path) -> Result<Study, LogError> {
    study_of(&Document::open(path)?)
}

/// The study that a document is.
pub(super) fn study_of(document: &Document<'_>) -> Result<Study, LogError> {
    let raw: RawStudy = document.parse()?;
    check_schema(document, &raw.schema)?;
    about(document, &raw.about)?;
    let joint_table =
        raw.joint.as_ref().ok_or_else(|| document.missing("[joint]", "the nominal model of the joint"))?;
    let joint = joint(document, joint_table, true)?;
    let sensor = sensor(document, &raw.sensor)?;
    let motor = raw.motor.as_ref().map(|raw| motor(document, "[motor] ", raw)).transpose()?;
    let uncertain = uncertain(document, &raw.uncertain, JOINT_NAMES)?;
    let columns = columns(document, &raw.columns)?;
    if let Some(release) = &raw.release {
        let expected = "it only in the sidecar NAME.toml of a single log NAME.csv";
        return Err(document.wrong("[release]", release.span(), "a release in a study", expected));
    }
    if raw.log.is_empty() {
        return Err(document.missing("[[log]]", "at least one log"));
    }
    let mut logs = Vec::with_capacity(raw.log.len());
    let mut seen = Seen::new();
    for (i, log) in raw.log.into_iter().enumerate() {
        let table = format!("[[log]] {}", i + 1);
        let named = named_log(document, i, &log.file, [&log.from, &log.to], &mut seen)?;
        let role = document.needed_word(&format!("{table} role"), &log.role, &ROLES)?;
        let drive = document.needed_word(&format!("{table} drive"), &log.drive, &DRIVES)?;
        logs.push(study_log(document, &table, log, &raw.motor, (named, role, drive))?);
    }
    if !logs.iter().any(|log| log.role == Role::Fit) {
        return Err(document
            .missing("[[log]] role = \"fit\"", "at least one log with role = \"fit\", to which numbers are fitted"));
    }
    Ok(Study { file: document.file.to_path_buf(), joint, sensor, motor, uncertain, columns, logs, release: None })
}

/// Reads the sidecar `NAME.toml` beside a log `NAME.csv`; `None` if there is none.
///
/// Its keys are those of a study. The nominal model is optional (all four numbers or none), so are `[joint]`, whose
/// name is then the log's, and `[[log]]`, which is then this log, to be fitted, motor off. `[release]` may be added.
///
/// # Errors
/// As [`read_study`]; also where `[[log]]` is about another file.
pub fn read_sidecar_for(log_path: &Path) -> Result<Option<Study>, LogError> {
    Ok(read_sidecar(log_path)?.map(|(study, _)| study))
}

/// As [`read_sidecar_for`], and whether the sidecar says what moves the joint: by `drive`, or because it was released.
pub(crate) fn read_sidecar(log_path: &Path) -> Result<Option<(Study, bool)>, LogError> {
    let path = log_path.with_extension("toml");
    if path == log_path || matches!(fs::metadata(&path), Err(error) if error.kind() == io::ErrorKind::NotFound) {
        return Ok(None);
    }
    let document = Document::open(&path)?;
    let mut raw: RawStudy = document.parse()?;
    check_schema(&document, &raw.schema)?;
    about(&document, &raw.about)?;
    let own_name = log_path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let mut joint = joint(&document, raw.joint.as_ref().unwrap_or(&RawJoint::default()), false)?;
    if joint.name.is_empty() {
        joint.name = log_path.file_stem().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    }
    let sensor = sensor(&document, &raw.sensor)?;
    let motor = raw.motor.as_ref().map(|raw| motor(&document, "[motor] ", raw)).transpose()?;
    let uncertain = uncertain(&document, &raw.uncertain, JOINT_NAMES)?;
    let columns = columns(&document, &raw.columns)?;
    if raw.log.len() > 1 {
        let spans = raw.log[1].file.as_ref().map_or(0..0, Spanned::span);
        let expected =
            format!("only `{own_name}` in the sidecar of that log; give a study of several logs another name");
        return Err(document.wrong("[[log]] 2 file", spans, "a second log", &expected));
    }
    let entry = raw.log.pop().unwrap_or_default();
    if let Some(file) = entry.file.as_ref().filter(|file| Path::new(file.get_ref()).file_name() != log_path.file_name())
    {
        let found = format!("\"{}\"", file.get_ref());
        return Err(document.wrong(
            "[[log]] 1 file",
            file.span(),
            found,
            &format!("\"{own_name}\", the log beside it"),
        ));
    }
    let table = "[[log]] 1";
    let is_stated = entry.drive.is_some() || raw.release.is_some();
    let role = document.word(&format!("{table} role"), &entry.role, &ROLES)?.unwrap_or(Role::Fit);
    let drive = document.word(&format!("{table} drive"), &entry.drive, &DRIVES)?.unwrap_or(DriveMode::Off);
    let window = [("from", &entry.from), ("to", &entry.to)];
    if let Some((key, said)) = window.into_iter().find_map(|(key, said)| Some((key, said.as_ref()?))) {
        let expected = "it only in a study; a log alone is read whole";
        return Err(document.wrong(&format!("{table} {key}"), said.span(), "a part of a log", expected));
    }
    let named = Named { file: own_name, path: log_path.to_path_buf(), window: None };
    let log = study_log(&document, table, entry, &raw.motor, (named, role, drive))?;
    let release = raw.release.as_ref().map(|release| self::release(&document, release.get_ref())).transpose()?;
    let study = Study { file: path.clone(), joint, sensor, motor, uncertain, columns, logs: vec![log], release };
    Ok(Some((study, is_stated)))
}

/// What was named before: the numbers, from 1, of those that took it, and which part.
pub(super) type Seen = BTreeMap<PathBuf, Vec<(usize, Option<Window>)>>;

/// A log as a study names it.
pub(super) struct Named {
    /// What reports call it.
    pub file: String,
    pub path: PathBuf,
    pub window: Option<Window>,
}

/// The log that `[[log]]` number `i`, from 0, names, or the part between two times: it stands there once, and is there.
pub(super) fn named_log(
    document: &Document<'_>,
    i: usize,
    file: &Text,
    ends: [&Number; 2],
    seen: &mut Seen,
) -> Result<Named, LogError> {
    let table = format!("[[log]] {}", i + 1);
    let key = format!("{table} file");
    let file = file.as_ref().ok_or_else(|| document.missing(&*key, "the name of a log"))?;
    let resolved = document.file.parent().unwrap_or(Path::new("")).join(file.get_ref());
    // One file by two spellings is one log; what is at hand is no file.
    let real = if document.has_at_hand(file.get_ref()) { None } else { fs::canonicalize(&resolved).ok() };
    let window = Window::read(document, &table, file.get_ref(), ends)?;
    let before = seen.entry(real.unwrap_or_else(|| resolved.components().collect())).or_default();
    if let Some((first, _)) = before.iter().find(|(_, other)| overlap(window.as_ref(), other.as_ref())) {
        let found = format!("\"{}\", which is also [[log]] {first}", file.get_ref());
        let expected = "every log once, or by `from` and `to` parts of it that have no sample in common";
        return Err(document.wrong(&key, file.span(), found, expected));
    }
    before.push((i + 1, window.clone()));
    let label = window.as_ref().map_or_else(|| file.get_ref().clone(), Window::label);
    if document.has_at_hand(file.get_ref()) {
        return Ok(Named { file: label, path: PathBuf::new(), window });
    }
    is_file(&resolved).map_err(|source| {
        let at = document.place(&key, file.span());
        LogError::NamedLog { at, path: resolved.clone(), source }
    })?;
    Ok(Named { file: label, path: resolved, window })
}

fn is_file(path: &Path) -> io::Result<()> {
    let is_odd_folder = fs::metadata(path)?.is_dir() && !is_log_folder(path);
    if is_odd_folder { Err(io::ErrorKind::IsADirectory.into()) } else { Ok(()) }
}

pub(crate) fn check_schema(document: &Document<'_>, schema: &Option<Spanned<i64>>) -> Result<(), LogError> {
    let schema = schema.as_ref().ok_or_else(|| document.missing("schema", "schema = 1 at the top of the file"))?;
    if *schema.get_ref() == 1 {
        return Ok(());
    }
    Err(document.wrong("schema", schema.span(), schema.get_ref().to_string(), "1, the only schema there is"))
}

fn joint(document: &Document<'_>, raw: &RawJoint, full: bool) -> Result<JointSpec, LogError> {
    let name = match &raw.name {
        Some(name) if name.get_ref().trim().is_empty() => {
            return Err(document.wrong("[joint] name", name.span(), "an empty name", "a name such as \"q1\""));
        }
        Some(name) => name.get_ref().clone(),
        None if full => return Err(document.missing("[joint] name", "a name such as \"q1\"")),
        None => String::new(),
    };
    let any = [&raw.inertia, &raw.moment, &raw.coulomb, &raw.viscous].into_iter().any(Option::is_some);
    let nominal = if full || any {
        all_or_list(document, raw)?;
        Some(Nominal {
            inertia_kg_m2: document.needed("[joint] inertia", &raw.inertia, INERTIA)?,
            moment_kg_m: document.needed("[joint] moment", &raw.moment, MOMENT)?,
            coulomb_nm: document.needed("[joint] coulomb", &raw.coulomb, TORQUE)?,
            viscous_nm_s_rad: document.needed("[joint] viscous", &raw.viscous, VISCOUS)?,
        })
    } else {
        None
    };
    Ok(JointSpec {
        name,
        nominal,
        gravity_m_s2: document.number("[joint] gravity", &raw.gravity, GRAVITY)?.unwrap_or(STANDARD_GRAVITY_M_S2),
        rest_rad: document.number("[joint] rest", &raw.rest, ANGLE)?,
    })
}

/// Of several numbers that a study has still to say all are told at once.
fn all_or_list(document: &Document<'_>, raw: &RawJoint) -> Result<(), LogError> {
    let keys = [
        ("inertia (kg m^2)", &raw.inertia),
        ("moment (kg m)", &raw.moment),
        ("coulomb (N m)", &raw.coulomb),
        ("viscous (N m s/rad)", &raw.viscous),
    ];
    let missing: Vec<&str> = keys.iter().filter(|(_, value)| value.is_none()).map(|(key, _)| *key).collect();
    if missing.len() < 2 {
        return Ok(());
    }
    Err(LogError::MissingNumbers { file: document.file.to_path_buf(), table: "[joint]", keys: missing })
}

pub(super) fn sensor(document: &Document<'_>, raw: &RawSensor) -> Result<SensorSpec, LogError> {
    let resolution = document.number("[sensor] resolution", &raw.resolution, RESOLUTION)?;
    Ok(SensorSpec {
        resolution_rad: resolution.filter(|step| *step > 0.0),
        period_s: document.number("[sensor] period", &raw.period, PERIOD)?,
    })
}

fn study_log(
    document: &Document<'_>,
    table: &str,
    mut raw: RawLog,
    base: &Option<RawMotor>,
    (Named { file, path, window }, role, drive): (Named, Role, DriveMode),
) -> Result<StudyLog, LogError> {
    let (prefix, merged) = match (raw.motor.take(), base) {
        (Some(own), base) => (format!("{table} motor."), Some(own.over(base.clone().unwrap_or_default()))),
        (None, base) => ("[motor] ".to_owned(), base.clone()),
    };
    let motor = merged.as_ref().map(|merged| motor(document, &prefix, merged)).transpose()?;
    if drive == DriveMode::Position && motor.is_none() {
        let expected = format!("kp and kd of the controller, which {table} (drive = \"position\") needs");
        return Err(document.missing("[motor]", expected));
    }
    let session = session(document, table, &raw.session)?;
    let tau_is = tau_is(document, table, &raw, merged.as_ref().map(|merged| (&*prefix, merged)), drive)?;
    let extra = raw.extra.as_ref().map(|extra| self::extra(document, table, extra)).transpose()?;
    Ok(StudyLog { file, path, role, drive, motor, extra, session, tau_is, window })
}

fn session(document: &Document<'_>, table: &str, raw: &Text) -> Result<Option<String>, LogError> {
    match raw {
        Some(name) if name.get_ref().trim().is_empty() => {
            let expected = "a name such as \"feb\", the same for all logs that were taken in one go";
            Err(document.wrong(&format!("{table} session"), name.span(), "an empty name", expected))
        }
        name => Ok(name.as_ref().map(|name| name.get_ref().clone())),
    }
}

pub(super) fn extra(document: &Document<'_>, table: &str, raw: &RawExtra) -> Result<ExtraMass, LogError> {
    let key = |name: &str| format!("{table} extra.{name}");
    Ok(ExtraMass {
        mass_kg: document.needed(&key("mass"), &raw.mass, MASS)?,
        distance_m: document.needed(&key("distance"), &raw.distance, DISTANCE)?,
        radius_m: document.number(&key("radius"), &raw.radius, SIZE)?.unwrap_or(0.0),
        length_m: document.number(&key("length"), &raw.length, SIZE)?.unwrap_or(0.0),
    })
}

fn release(document: &Document<'_>, raw: &RawRelease) -> Result<Release, LogError> {
    Ok(Release {
        time_s: document.number("[release] time", &raw.time, FINITE)?,
        setpoint_rad: document.number("[release] setpoint", &raw.setpoint, ANGLE)?,
        angle_rad: document.number("[release] angle", &raw.angle, ANGLE)?,
    })
}

#[cfg(test)]
#[path = "study_tests.rs"]
mod tests;
