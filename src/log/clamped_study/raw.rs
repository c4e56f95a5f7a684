//! The TOML of a study as it stands in the file; unknown keys are errors, missing ones are not yet.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use crate::log::about::RawAbout;
use crate::log::document::{Number, Text};
use crate::log::raw_columns::RawColumns;
use crate::log::schema::{RawMotor, RawSensor, RawUncertain};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawClampedStudy {
    pub schema: Option<Spanned<i64>>,
    #[serde(default)]
    pub about: RawAbout,
    pub robot: RawDescribed,
    #[serde(default)]
    pub joints: BTreeMap<String, RawBeliefs>,
    #[serde(default)]
    pub groups: BTreeMap<String, Spanned<Vec<String>>>,
    #[serde(default)]
    pub control: RawLoop,
    #[serde(default)]
    pub sensor: RawSensor,
    #[serde(default)]
    pub uncertain: RawUncertain,
    #[serde(default)]
    pub columns: RawColumns,
    #[serde(default)]
    pub log: Vec<RawClampedLog>,
}

/// What of a document is believed, logs apart.
pub(crate) struct RawBelieved {
    pub robot: RawDescribed,
    pub joints: BTreeMap<String, RawBeliefs>,
    pub groups: BTreeMap<String, Spanned<Vec<String>>>,
    pub control: RawLoop,
    pub sensor: RawSensor,
    pub uncertain: RawUncertain,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawDescribed {
    pub model: Text,
    pub scenario: Text,
    pub tip: Text,
    pub gravity: Option<Spanned<Vec<f64>>>,
    #[serde(default)]
    pub without: Vec<String>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawLoop {
    pub hold: Text,
    pub derivative: Text,
    pub sample_period: Number,
}

/// What a study says of a joint: friction, and keys of `[motor]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawBeliefs {
    pub coulomb: Number,
    pub viscous: Number,
    pub armature: Number,
    pub kp: Number,
    pub ki: Number,
    pub kd: Number,
    pub torque_limit: Number,
    pub speed_limit: Number,
    pub model: Text,
    pub kt: Number,
    pub resistance: Number,
    pub supply: Number,
    pub duty_limit: Number,
    pub encoder: Text,
    pub tau_is: Text,
    pub gear: Number,
}

impl RawBeliefs {
    /// Whether it says what turns the law's answer into torque.
    pub(in crate::log) fn says_of_motor(&self) -> bool {
        let numbers = [&self.kt, &self.resistance, &self.supply, &self.duty_limit];
        self.model.is_some() || numbers.into_iter().any(Option::is_some)
    }

    /// What of it turns the law's answer or a current into torque, as a motor has it.
    pub(in crate::log) fn as_motor(&self) -> RawMotor {
        RawMotor {
            model: self.model.clone(),
            kt: self.kt.clone(),
            resistance: self.resistance.clone(),
            supply: self.supply.clone(),
            duty_limit: self.duty_limit.clone(),
            tau_is: self.tau_is.clone(),
            gear: self.gear.clone(),
            ..RawMotor::default()
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawClampedLog {
    pub file: Text,
    pub role: Text,
    pub drive: Text,
    pub session: Text,
    pub predict: Text,
    pub from: Number,
    pub to: Number,
}
