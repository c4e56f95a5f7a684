//! Reads a spec from TOML.

use super::spec::{AnySpec, Believed, DescribedSpec, EffectSpec, JointBench, LogSpec, Spec, TruthSpec};
use crate::log::{
    Document, LogError, RawBeliefs, RawBelieved, RawControl, RawDescribed, RawFloor, RawFriction, RawLoop, RawRobot,
    RawRobotSensor, RawSensor, RawUncertain, RobotScenario, RobotStudy, Sections, Uncertain, check_schema,
    clamped_beliefs, robot_sections,
};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSpec {
    schema: Option<Spanned<i64>>,
    #[serde(default)]
    seed: u64,
    robot: Option<RawRobot>,
    #[serde(default)]
    joints: BTreeMap<String, RawBeliefs>,
    joint: Option<Spanned<JointBench>>,
    friction: Option<RawFriction>,
    control: Option<RawControl>,
    floor: Option<Spanned<RawFloor>>,
    sensor: Option<RawRobotSensor>,
    #[serde(default)]
    truth: TruthSpec,
    #[serde(default)]
    effect: Vec<EffectSpec>,
    #[serde(default)]
    log: Vec<LogSpec>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawDescribedSpec {
    schema: Option<Spanned<i64>>,
    #[serde(default)]
    seed: u64,
    robot: RawDescribed,
    #[serde(default)]
    joints: BTreeMap<String, RawBeliefs>,
    #[serde(default)]
    groups: BTreeMap<String, Spanned<Vec<String>>>,
    #[serde(default)]
    control: RawLoop,
    #[serde(default)]
    sensor: RawSensor,
    #[serde(default)]
    uncertain: RawUncertain,
    #[serde(default)]
    truth: TruthSpec,
    #[serde(default)]
    effect: Vec<EffectSpec>,
    #[serde(default)]
    log: Vec<LogSpec>,
}

/// Gives a kind of spec its two ways in, over its own `of`.
macro_rules! read_as {
    ($kind:ident) => {
        impl $kind {
            /// Reads a spec.
            ///
            /// # Errors
            /// [`LogError`] with file and key: no TOML, unknown or missing keys, wrong types, and what a robot study's
            /// sections refuse. Whether truth, effects and logs can be is found when they are made.
            pub fn read(path: &Path) -> Result<Self, LogError> {
                Self::of(&Document::open(path)?)
            }

            /// Reads a spec that is at hand; `file` is its name in errors, and its folder that of paths in it.
            ///
            /// # Errors
            /// As [`Self::read`].
            pub fn from_toml(file: &Path, text: &str) -> Result<Self, LogError> {
                Self::of(&Document::of_text(file, text))
            }
        }
    };
}

read_as!(AnySpec);
read_as!(Spec);

impl AnySpec {
    fn of(document: &Document<'_>) -> Result<Self, LogError> {
        let tables = toml::from_str::<toml::Table>(document.text()).unwrap_or_default();
        let scenario = tables.get("robot").and_then(|robot| robot.get("scenario"));
        if scenario.and_then(toml::Value::as_str) != Some("fixed") {
            return Spec::of(document).map(|spec| Self::Robot(Box::new(spec)));
        }
        let raw: RawDescribedSpec = document.parse_any()?;
        check_schema(document, &raw.schema)?;
        let RawDescribedSpec { robot, joints, groups, control, sensor, uncertain, .. } = raw;
        let believed = RawBelieved { robot, joints, groups, control, sensor, uncertain };
        Ok(Self::Described(Box::new(DescribedSpec {
            file: document.file.to_path_buf(),
            seed: raw.seed,
            study: clamped_beliefs(document, believed)?,
            tables,
            truth: raw.truth,
            effects: raw.effect,
            logs: raw.log,
        })))
    }
}

impl Spec {
    fn of(document: &Document<'_>) -> Result<Self, LogError> {
        let raw: RawSpec = document.parse_any()?;
        check_schema(document, &raw.schema)?;
        let rest = (raw.friction.as_ref(), raw.control.as_ref(), raw.floor.as_ref(), raw.sensor.as_ref());
        let believed = match (&raw.robot, raw.joint) {
            (Some(robot), None) => {
                Believed::Robot(Box::new(study(document, robot_sections(document, (robot, &raw.joints), rest)?)))
            }
            (None, Some(joint)) => {
                let mut study =
                    study(document, robot_sections(document, (&RawRobot::on_the_bench(), &raw.joints), rest)?);
                study.scenario = RobotScenario::Drop;
                Believed::Joint(Box::new(study), joint.into_inner())
            }
            (Some(_), Some(joint)) => {
                return Err(document.wrong("[joint]", joint.span(), "[joint] beside [robot]", "one of the two"));
            }
            (None, None) => return Err(document.missing("[robot]", "the robot that is believed in, or a [joint]")),
        };
        Ok(Self {
            file: document.file.to_path_buf(),
            seed: raw.seed,
            believed,
            truth: raw.truth,
            effects: raw.effect,
            logs: raw.log,
        })
    }
}

fn study(document: &Document<'_>, sections: Sections) -> RobotStudy {
    let Sections { model, model_path, described, scenario, drop_height_m, friction, control, floor, sensor } = sections;
    RobotStudy {
        file: document.file.to_path_buf(),
        model,
        model_path,
        described,
        scenario,
        drop_height_m,
        friction,
        control,
        floor,
        sensor,
        uncertain: Uncertain::default(),
        columns: crate::log::Columns::default(),
        logs: Vec::new(),
    }
}
