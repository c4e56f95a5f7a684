//! The TOML of a study as it stands in the file; unknown keys are errors, missing ones are not yet.

use serde::Deserialize;
use toml::Spanned;

use super::about::RawAbout;
use super::document::{Number, Text};
use super::raw_columns::RawColumns;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawStudy {
    pub schema: Option<Spanned<i64>>,
    #[serde(default)]
    pub about: RawAbout,
    pub joint: Option<RawJoint>,
    #[serde(default)]
    pub sensor: RawSensor,
    pub motor: Option<RawMotor>,
    #[serde(default)]
    pub uncertain: RawUncertain,
    #[serde(default)]
    pub columns: RawColumns,
    #[serde(default)]
    pub log: Vec<RawLog>,
    pub release: Option<Spanned<RawRelease>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawJoint {
    pub name: Text,
    pub inertia: Number,
    pub moment: Number,
    pub coulomb: Number,
    pub viscous: Number,
    pub gravity: Number,
    pub rest: Number,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawSensor {
    pub resolution: Number,
    pub period: Number,
}

#[derive(Deserialize, Default, Clone)]
#[serde(deny_unknown_fields)]
pub(super) struct RawMotor {
    pub kp: Number,
    pub ki: Number,
    pub kd: Number,
    pub hold: Text,
    pub derivative: Text,
    pub sample_period: Number,
    pub torque_limit: Number,
    pub speed_limit: Number,
    pub model: Text,
    pub kt: Number,
    pub resistance: Number,
    pub supply: Number,
    pub duty_limit: Number,
    pub encoder: Text,
    pub armature: Number,
    pub tau_is: Text,
    pub gear: Number,
}

impl RawMotor {
    /// The same without what says what a current is; a motor fed by voltage has its constant still.
    pub(super) fn without_current(self) -> Self {
        let is_voltage = self.model.as_ref().is_some_and(|model| model.get_ref() == "voltage");
        Self { kt: self.kt.filter(|_| is_voltage), gear: None, tau_is: None, ..self }
    }

    /// This motor with another's keys where it has none itself; one that is of the plain kind takes nothing over that only
    /// a motor fed by voltage has.
    pub(super) fn over(self, mut base: Self) -> Self {
        let says = |text: &Text, word: &str| text.as_ref().is_some_and(|text| text.get_ref() == word);
        if says(&self.model, "torque") {
            let is_current = says(self.tau_is.as_ref().map_or(&base.tau_is, |_| &self.tau_is), "current");
            let kt = base.kt.take().filter(|_| is_current);
            base = Self { kt, resistance: None, supply: None, duty_limit: None, ..base };
        }
        Self {
            kp: self.kp.or(base.kp),
            ki: self.ki.or(base.ki),
            kd: self.kd.or(base.kd),
            hold: self.hold.or(base.hold),
            derivative: self.derivative.or(base.derivative),
            sample_period: self.sample_period.or(base.sample_period),
            torque_limit: self.torque_limit.or(base.torque_limit),
            speed_limit: self.speed_limit.or(base.speed_limit),
            model: self.model.or(base.model),
            kt: self.kt.or(base.kt),
            resistance: self.resistance.or(base.resistance),
            supply: self.supply.or(base.supply),
            duty_limit: self.duty_limit.or(base.duty_limit),
            encoder: self.encoder.or(base.encoder),
            armature: self.armature.or(base.armature),
            tau_is: self.tau_is.or(base.tau_is),
            gear: self.gear.or(base.gear),
        }
    }
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawLog {
    pub file: Text,
    pub role: Text,
    pub drive: Text,
    pub session: Text,
    pub from: Number,
    pub to: Number,
    pub tau_is: Text,
    pub kt: Number,
    pub gear: Number,
    pub motor: Option<RawMotor>,
    pub extra: Option<RawExtra>,
}

/// A number, or a table of numbers by name; which of them it is, is checked when it is read.
pub(super) type RawSpread = Option<Spanned<toml::Value>>;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawUncertain {
    pub inertia: RawSpread,
    pub moment: RawSpread,
    pub mass: RawSpread,
    pub friction: RawSpread,
    pub gain: RawSpread,
    pub torque: RawSpread,
    pub floor: RawSpread,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawExtra {
    pub mass: Number,
    pub distance: Number,
    pub radius: Number,
    pub length: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawRelease {
    pub time: Number,
    pub setpoint: Number,
    pub angle: Number,
}

/// Table of a joint in `pose.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawJointPose {
    #[serde(default)]
    pub held: std::collections::BTreeMap<String, Spanned<f64>>,
    pub gravity: Option<Spanned<[f64; 3]>>,
    pub mount: Number,
    #[serde(default)]
    pub hanging: std::collections::BTreeMap<String, Spanned<f64>>,
}

/// `pose.toml`: how the robot was clamped.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "keys that are notes for people are known, so that a misspelt key is an error")]
pub(super) struct RawPose {
    pub leg: Text,
    pub bodies: Option<Vec<String>>,
    pub axes: Option<String>,
    pub sign: Option<String>,
    pub others: Option<String>,
    pub hanging_from: Option<String>,
    pub q1: Option<RawJointPose>,
    pub q2: Option<RawJointPose>,
    pub q3: Option<RawJointPose>,
}
