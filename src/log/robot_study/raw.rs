//! The TOML of a robot study as it stands in the file; unknown keys are errors, missing ones are not yet.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use crate::log::about::RawAbout;
use crate::log::clamped_study::RawBeliefs;
use crate::log::document::{Number, Text};
use crate::log::raw_columns::RawColumns;
use crate::log::schema::{RawExtra, RawUncertain};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawRobotStudy {
    pub schema: Option<Spanned<i64>>,
    #[serde(default)]
    pub about: RawAbout,
    pub robot: RawRobot,
    #[serde(default)]
    pub joints: BTreeMap<String, RawBeliefs>,
    pub friction: Option<RawFriction>,
    pub control: Option<RawControl>,
    pub floor: Option<Spanned<RawFloor>>,
    pub sensor: Option<RawRobotSensor>,
    #[serde(default)]
    pub uncertain: RawUncertain,
    #[serde(default)]
    pub columns: RawColumns,
    #[serde(default)]
    pub log: Vec<RawRobotLog>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawRobot {
    pub model: Text,
    pub scenario: Text,
    pub drop_height: Number,
    #[serde(default)]
    pub feet: BTreeMap<String, Spanned<f64>>,
}

impl RawRobot {
    /// The embedded robot on the bench.
    pub(crate) fn on_the_bench() -> Self {
        let word = |word: &str| Some(Spanned::new(0..0, word.to_owned()));
        Self { model: word("ers7"), scenario: word("drop"), drop_height: None, feet: BTreeMap::new() }
    }
}

/// Three numbers, by joint 1, 2, 3 of a leg.
pub(super) type Triple = Option<Spanned<Vec<f64>>>;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawFriction {
    pub coulomb: Triple,
    pub viscous: Triple,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawControl {
    pub hold: Text,
    pub derivative: Text,
    pub sample_period: Number,
    #[serde(default)]
    pub gains: BTreeMap<String, Spanned<Vec<f64>>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawFloor {
    pub stiffness: Number,
    pub damping: Number,
    pub exponent: Number,
    #[serde(rename = "static")]
    pub static_friction: Number,
    pub coulomb: Number,
    pub viscous: Number,
    pub steepness: Number,
    pub stribeck_speed: Number,
    pub torsion_radius: Number,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawRobotSensor {
    pub resolution: Number,
    pub period: Number,
    pub noise: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawRobotLog {
    pub file: Text,
    pub role: Text,
    pub drive: Text,
    pub released: Text,
    pub release_time: Number,
    pub extra: Option<RawExtra>,
    pub forward: Number,
    pub forward_from: Number,
    pub forward_to: Number,
}
