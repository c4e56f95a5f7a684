//! From the TOML to a checked robot study.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use toml::Spanned;

use super::described::{DescribedBeliefs, described, is_described};
use super::raw::{RawControl, RawFloor, RawFriction, RawRobot, RawRobotLog, RawRobotSensor, RawRobotStudy, Triple};
use super::{
    ControlSpec, FloorSpec, Forward, LegFrictionSpec, RobotRelease, RobotScenario, RobotSensorSpec, RobotStudy,
    RobotStudyLog,
};
use crate::log::about::about;
use crate::log::beliefs::{ANY_NAME, uncertain};
use crate::log::clamped_study::RawBeliefs;
use crate::log::document::{Document, FINITE, NOT_NEGATIVE, PERIOD, POSITIVE, Range64, range};
use crate::log::document::{Number, Text};
use crate::log::error::LogError;
use crate::log::motor::{DERIVATIVES, HOLDS};
use crate::log::motor_types::{Derivative, Hold};
use crate::log::raw_columns::columns;
use crate::log::read_log::read_robot_logs;
use crate::log::robot_log::RobotLog;
use crate::log::study::{Named, RESOLUTION, ROLES, Seen, check_schema, extra, named_log};
use crate::log::types::Role;

/// The robot that is compiled in.
const EMBEDDED: &str = "ers7";
/// Unless stated, the lowest foot hangs so high at first (4.2.2) [m].
const DROP_HEIGHT_M: f64 = 0.02;

const HEIGHT: Range64 =
    range(|x| (0.0..=1.0).contains(&x), "a height from 0 to 1 m; a larger one looks like millimetres");
/// Friction of a joint, in N m or N m s/rad.
const JOINT_FRICTION: Range64 = range(|x| (0.0..=10.0).contains(&x), "a number from 0 to 10");
const EXPONENT: Range64 = range(|x| (1.0..=5.0).contains(&x), "a number from 1 to 5");
const NOISE: Range64 =
    range(|x| (0.0..0.5).contains(&x), "a standard deviation from 0 to below 0.5 rad; a larger one looks like degrees");
const DISPLACEMENT: Range64 = range(|x| x.abs() <= 100.0, "a length within 100 m; a larger one looks like millimetres");

/// The two kinds of study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StudyKind {
    /// One joint: [`read_study`](crate::log::read_study).
    Joint,
    /// A whole robot: [`read_robot_study`].
    Robot,
    /// Any robot with a clamped base, `scenario = "fixed"`: [`read_clamped_study`](crate::log::read_clamped_study).
    Clamped,
}

/// Which kind of study a file is, by its table `[robot]` and the scenario there; a file that is no TOML is the kind that
/// its text looks like, so that its reader says what is wrong.
///
/// # Errors
/// [`LogError`] where the file cannot be read as text.
pub fn study_kind(path: &Path) -> Result<StudyKind, LogError> {
    Document::open(path).map(|document| kind_of(&document))
}

/// The same of a document.
pub(in crate::log) fn kind_of(document: &Document<'_>) -> StudyKind {
    match toml::from_str::<toml::Table>(document.text()) {
        Ok(table) => match table.get("robot") {
            Some(robot) => match robot.get("scenario").map(toml::Value::as_str) {
                Some(Some("fixed")) => StudyKind::Clamped,
                // Beliefs of single joints are those of a robot whose base is held.
                None if table.contains_key("joints") => StudyKind::Clamped,
                _ => StudyKind::Robot,
            },
            None => StudyKind::Joint,
        },
        Err(_) if document.text().lines().any(|line| line.trim_start().starts_with("[robot]")) => StudyKind::Robot,
        Err(_) => StudyKind::Joint,
    }
}

/// Reads a robot study: what is believed of robot, friction, control, floor and sensors, and the logs, which have to
/// exist but are not read yet.
///
/// # Errors
/// [`LogError`] naming the file and the key: unknown keys, missing keys, keys that do not belong to the scenario, values
/// out of range, logs that are not there.
pub fn read_robot_study(path: &Path) -> Result<RobotStudy, LogError> {
    robot_study_of(&Document::open(path)?)
}

/// The study that a document is.
pub(in crate::log) fn robot_study_of(document: &Document<'_>) -> Result<RobotStudy, LogError> {
    if let Ok(table) = toml::from_str::<toml::Table>(document.text())
        && !table.contains_key("robot")
    {
        let joint = if table.contains_key("joint") { " (this is a joint study)" } else { "" };
        return Err(document.missing("[robot]", format!("the robot and its scenario{joint}")));
    }
    let raw: RawRobotStudy = document.parse_any()?;
    check_schema(document, &raw.schema)?;
    about(document, &raw.about)?;
    let Sections { model, model_path, described, scenario, drop_height_m, friction, control, floor, sensor } =
        robot_sections(
            document,
            (&raw.robot, &raw.joints),
            (raw.friction.as_ref(), raw.control.as_ref(), raw.floor.as_ref(), raw.sensor.as_ref()),
        )?;
    let uncertain = uncertain(document, &raw.uncertain, ANY_NAME)?;
    let columns = columns(document, &raw.columns)?;
    if raw.log.is_empty() {
        return Err(document.missing("[[log]]", "at least one log"));
    }
    let mut seen = BTreeMap::new();
    let logs = raw.log.iter().enumerate().map(|(i, log)| self::log(document, i, log, scenario, &mut seen));
    let logs: Vec<RobotStudyLog> = logs.collect::<Result<_, _>>()?;
    if !logs.iter().any(|log| log.role == Role::Fit) {
        return Err(document
            .missing("[[log]] role = \"fit\"", "at least one log with role = \"fit\", to which numbers are fitted"));
    }
    let file = document.file.to_path_buf();
    Ok(RobotStudy {
        file,
        model,
        model_path,
        described,
        scenario,
        drop_height_m,
        friction,
        control,
        floor,
        sensor,
        uncertain,
        columns,
        logs,
    })
}

/// Reads the logs of a robot study, in the study's order, single readings that jump and come back between their neighbours.
///
/// # Errors
/// The error of the first log, in the study's order, that cannot be read, or whose period is about 1000 times off
/// `[sensor] period`.
pub fn read_robot_study_logs(study: &RobotStudy) -> Result<Vec<RobotLog>, LogError> {
    let paths: Vec<&Path> = study.logs.iter().map(|log| log.path.as_path()).collect();
    let logs = read_robot_logs(&paths, &study.columns, study.sensor.period_s)?;
    Ok(logs.into_iter().map(RobotLog::without_spikes).collect())
}

/// What a robot study says before its logs.
pub(crate) struct Sections {
    pub model: String,
    pub model_path: Option<PathBuf>,
    pub described: Option<DescribedBeliefs>,
    pub scenario: RobotScenario,
    pub drop_height_m: f64,
    pub friction: LegFrictionSpec,
    pub control: ControlSpec,
    pub floor: FloorSpec,
    pub sensor: RobotSensorSpec,
}

type RawSections<'a> =
    (Option<&'a RawFriction>, Option<&'a RawControl>, Option<&'a Spanned<RawFloor>>, Option<&'a RawRobotSensor>);

/// How the robot is held. Studies with a clamped base have a reader of their own.
fn scenario(document: &Document<'_>, given: &Option<Spanned<String>>) -> Result<RobotScenario, LogError> {
    const EXPECTED: &str = "\"air\", \"floor\" or \"drop\" for a robot that walks, \"fixed\" where its base is clamped";
    let key = "[robot] scenario";
    let given = given.as_ref().ok_or_else(|| document.missing(key, EXPECTED))?;
    let known = RobotScenario::WORDS.iter().find(|(word, _)| *word == given.get_ref().trim());
    let unknown = || document.wrong(key, given.span(), format!("{:?}", given.get_ref()), EXPECTED);
    known.map(|(_, scenario)| *scenario).ok_or_else(unknown)
}

/// Checks everything but the logs.
pub(crate) fn robot_sections(
    document: &Document<'_>,
    (robot, joints): (&RawRobot, &BTreeMap<String, RawBeliefs>),
    (friction, control, floor, sensor): RawSections<'_>,
) -> Result<Sections, LogError> {
    let expected = "\"ers7\", or the path of a robot file: URDF, MJCF or our TOML";
    let model = robot.model.as_ref().ok_or_else(|| document.missing("[robot] model", expected))?;
    if model.get_ref().trim().is_empty() {
        return Err(document.wrong("[robot] model", model.span(), "an empty name", expected));
    }
    let folder = document.file.parent().unwrap_or(Path::new(""));
    let model_path = (model.get_ref() != EMBEDDED).then(|| folder.join(model.get_ref()));
    let scenario = scenario(document, &robot.scenario)?;
    let drop_height = document.number("[robot] drop_height", &robot.drop_height, HEIGHT)?;
    let is_on_floor = scenario == RobotScenario::Floor;
    if let Some(height) = robot.drop_height.as_ref().filter(|_| !is_on_floor) {
        return Err(misplaced(document, "[robot] drop_height", height.span(), scenario, RobotScenario::Floor));
    }
    if let Some(floor) = floor.filter(|_| !is_on_floor) {
        return Err(misplaced(document, "[floor]", floor.span(), scenario, RobotScenario::Floor));
    }
    let described = described(document, robot, joints, friction)?;
    let friction = friction.map(|friction| self::friction(document, friction)).transpose()?.unwrap_or_default();
    let control = self::control(document, control, is_described(model.get_ref()))?;
    let floor = floor.map(|floor| self::floor(document, floor.get_ref())).transpose()?.unwrap_or_default();
    let sensor = sensor.map(|sensor| self::sensor(document, sensor)).transpose()?.unwrap_or_default();
    Ok(Sections {
        model: model.get_ref().clone(),
        model_path,
        described,
        scenario,
        drop_height_m: drop_height.unwrap_or(DROP_HEIGHT_M),
        friction,
        control,
        floor,
        sensor,
    })
}

fn misplaced(
    document: &Document<'_>,
    key: &str,
    span: std::ops::Range<usize>,
    scenario: RobotScenario,
    belongs_to: RobotScenario,
) -> LogError {
    let found = format!("it in scenario = \"{}\"", scenario.word());
    document.wrong(key, span, found, &format!("it with scenario = \"{}\" only", belongs_to.word()))
}

/// Three numbers of a range; `None` where the key is absent.
fn triple(document: &Document<'_>, key: &str, raw: &Triple, of: Range64) -> Result<Option<[f64; 3]>, LogError> {
    let Some(raw) = raw else { return Ok(None) };
    let Ok(numbers) = <[f64; 3]>::try_from(raw.get_ref().as_slice()) else {
        let found = format!("{} numbers", raw.get_ref().len());
        return Err(document.wrong(key, raw.span(), found, "3 numbers"));
    };
    for number in numbers {
        document.within(key, raw.span(), number, of)?;
    }
    Ok(Some(numbers))
}

fn friction(document: &Document<'_>, raw: &RawFriction) -> Result<LegFrictionSpec, LogError> {
    Ok(LegFrictionSpec {
        coulomb_nm: triple(document, "[friction] coulomb", &raw.coulomb, JOINT_FRICTION)?,
        viscous_nm_s_rad: triple(document, "[friction] viscous", &raw.viscous, JOINT_FRICTION)?,
    })
}

fn control(document: &Document<'_>, raw: Option<&RawControl>, is_described: bool) -> Result<ControlSpec, LogError> {
    let default = match is_described {
        true => ControlSpec { hold: Hold::Step, derivative: Derivative::Measurement, ..ControlSpec::default() },
        false => ControlSpec::default(),
    };
    let Some(raw) = raw else { return Ok(default) };
    let hold = document.word("[control] hold", &raw.hold, &HOLDS)?.unwrap_or(default.hold);
    let derivative =
        document.word("[control] derivative", &raw.derivative, &DERIVATIVES)?.unwrap_or(default.derivative);
    if derivative == Derivative::Error && hold == Hold::Step {
        let span = raw.hold.as_ref().or(raw.derivative.as_ref()).map_or(0..0, Spanned::span);
        let expected = "derivative = \"measurement\" beside it: a setpoint held in steps has no derivative";
        return Err(document.wrong("[control] hold", span, "\"step\" with derivative = \"error\"", expected));
    }
    let mut gains = BTreeMap::new();
    for (joint, row) in &raw.gains {
        let key = format!("[control] gains.{joint}");
        let row = triple(document, &key, &Some(row.clone()), NOT_NEGATIVE)?;
        gains.extend(row.map(|row| (joint.clone(), row)));
    }
    let sample_period_s = document.number("[control] sample_period", &raw.sample_period, PERIOD)?;
    Ok(ControlSpec { hold, derivative, sample_period_s, gains })
}

/// `[floor]`, of a study or of a robot's file.
pub(crate) fn floor(document: &Document<'_>, raw: &RawFloor) -> Result<FloorSpec, LogError> {
    let number = |key: &str, value: &Number, of| document.number(&format!("[floor] {key}"), value, of);
    Ok(FloorSpec {
        stiffness_n_m: number("stiffness", &raw.stiffness, POSITIVE)?,
        damping_n_s_m2: number("damping", &raw.damping, NOT_NEGATIVE)?,
        exponent: number("exponent", &raw.exponent, EXPONENT)?,
        static_friction: number("static", &raw.static_friction, NOT_NEGATIVE)?,
        coulomb: number("coulomb", &raw.coulomb, NOT_NEGATIVE)?,
        viscous_s_m: number("viscous", &raw.viscous, NOT_NEGATIVE)?,
        steepness_s_m: number("steepness", &raw.steepness, POSITIVE)?,
        stribeck_speed_m_s: number("stribeck_speed", &raw.stribeck_speed, NOT_NEGATIVE)?,
        torsion_radius_m: number("torsion_radius", &raw.torsion_radius, NOT_NEGATIVE)?,
    })
}

fn sensor(document: &Document<'_>, raw: &RawRobotSensor) -> Result<RobotSensorSpec, LogError> {
    let above_0 = |value: Option<f64>| value.filter(|value| *value > 0.0);
    Ok(RobotSensorSpec {
        resolution_rad: above_0(document.number("[sensor] resolution", &raw.resolution, RESOLUTION)?),
        period_s: document.number("[sensor] period", &raw.period, PERIOD)?,
        noise_rad: above_0(document.number("[sensor] noise", &raw.noise, NOISE)?),
    })
}

fn log(
    document: &Document<'_>,
    i: usize,
    raw: &RawRobotLog,
    scenario: RobotScenario,
    seen: &mut Seen,
) -> Result<RobotStudyLog, LogError> {
    let table = format!("[[log]] {}", i + 1);
    let key = |name: &str| format!("{table} {name}");
    let Named { file, path, .. } = named_log(document, i, &raw.file, [&None, &None], seen)?;
    let role = document.needed_word(&key("role"), &raw.role, &ROLES)?;
    // Torques and switches of whole logs are for robots with a clamped base.
    document.word(&key("drive"), &raw.drive, &[("position", ())])?;
    if scenario != RobotScenario::Drop {
        let released = raw.released.as_ref().map(|released| ("released", released.span()));
        let release_time = raw.release_time.as_ref().map(|time| ("release_time", time.span()));
        let extra = raw.extra.as_ref().and_then(|extra| Some(("extra.mass", extra.mass.as_ref()?.span())));
        if let Some((name, span)) = released.or(release_time).or(extra) {
            return Err(misplaced(document, &key(name), span, scenario, RobotScenario::Drop));
        }
    }
    let forward_keys =
        [("forward", &raw.forward), ("forward_from", &raw.forward_from), ("forward_to", &raw.forward_to)];
    let stated = forward_keys.iter().find_map(|(name, value)| Some((*name, value.as_ref()?.span())));
    if let Some((name, span)) = stated.clone().filter(|_| scenario != RobotScenario::Floor) {
        return Err(misplaced(document, &key(name), span, scenario, RobotScenario::Floor));
    }
    let release = match scenario {
        RobotScenario::Drop => Some(release(document, &table, &raw.released, &raw.release_time)?),
        _ => None,
    };
    let forward = stated.map(|_| forward(document, &table, raw)).transpose()?;
    let extra = raw.extra.as_ref().map(|extra| self::extra(document, &table, extra)).transpose()?;
    Ok(RobotStudyLog { file, path, role, release, extra, forward })
}

fn release(document: &Document<'_>, table: &str, joint: &Text, time: &Number) -> Result<RobotRelease, LogError> {
    let key = format!("{table} released");
    let joint = joint.as_ref().ok_or_else(|| document.missing(&*key, "the joint that is let go, such as \"lf2\""))?;
    let time_s = document.needed(&format!("{table} release_time"), time, FINITE)?;
    Ok(RobotRelease { joint: joint.get_ref().clone(), time_s })
}

fn forward(document: &Document<'_>, table: &str, raw: &RawRobotLog) -> Result<Forward, LogError> {
    let key = |name: &str| format!("{table} {name}");
    let distance_m = document.needed(&key("forward"), &raw.forward, DISPLACEMENT)?;
    let from_s = document.needed(&key("forward_from"), &raw.forward_from, FINITE)?;
    let to_s = document.needed(&key("forward_to"), &raw.forward_to, FINITE)?;
    if to_s > from_s {
        return Ok(Forward { distance_m, from_s, to_s });
    }
    let span = raw.forward_to.as_ref().map_or(0..0, Spanned::span);
    Err(document.wrong(&key("forward_to"), span, to_s.to_string(), &format!("a time after forward_from = {from_s} s")))
}
