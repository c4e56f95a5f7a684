//! The TOML of a robot file as it stands there; unknown keys are errors.

use crate::log::RawFloor;
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

pub(super) type Number = Spanned<f64>;
pub(super) type Text = Spanned<String>;
pub(super) type Triple = Spanned<[f64; 3]>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawRobot {
    pub schema: Spanned<i64>,
    pub name: String,
    pub root: Text,
    pub base: Option<Text>,
    pub gravity_m_s2: Option<Triple>,
    pub part: Vec<RawPart>,
    #[serde(default)]
    pub joint: Vec<RawJoint>,
    #[serde(default)]
    pub friction: BTreeMap<String, RawFriction>,
    #[serde(default)]
    pub gains: BTreeMap<String, RawGains>,
    pub encoder: Option<RawEncoder>,
    #[serde(default)]
    pub sensor: Vec<RawSensor>,
    #[serde(default)]
    pub effect: Vec<RawEffect>,
    #[serde(default)]
    pub attached: Vec<RawAttached>,
    pub floor: Option<RawFloor>,
    pub floor_slope_rad: Option<Spanned<[f64; 2]>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawEffect {
    pub id: String,
    pub joints: Spanned<Vec<Text>>,
    pub parameters: BTreeMap<String, Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawAttached {
    pub part: Text,
    pub mass_kg: Number,
    pub at_m: Triple,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPart {
    pub name: Text,
    pub diameter_m: Triple,
    pub mass_kg: Number,
    pub inertia_kg_m2: Option<Triple>,
    pub contact_mm: Option<Triple>,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "expected \"x\", \"y\", \"z\" or a unit vector such as [0.6, 0.0, 0.8]")]
pub(super) enum RawAxis {
    Letter(String),
    Vector([f64; 3]),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawJoint {
    pub name: Text,
    pub kind: Option<String>,
    pub parent: Text,
    pub child: Text,
    pub axis: Spanned<RawAxis>,
    pub sign: Option<Spanned<i64>>,
    pub parent_mm: Triple,
    pub child_mm: Triple,
    pub phi_deg: Option<Triple>,
    pub hardware_rad: Option<Spanned<[f64; 2]>>,
    pub software_rad: Option<Spanned<[f64; 2]>>,
    pub speed_rad_s: Option<Number>,
    pub spring: Option<RawSpring>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawSpring {
    pub stiffness_nm_rad: Number,
    pub damping_nm_s_rad: Option<Number>,
    pub rest_rad: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawFriction {
    pub joints: Spanned<Vec<Text>>,
    pub coulomb_nm: Option<Spanned<Vec<f64>>>,
    pub viscous_nm_s_rad: Option<Spanned<Vec<f64>>>,
    pub static_nm: Option<Spanned<Vec<f64>>>,
    pub stribeck_rad_s: Option<Spanned<Vec<f64>>>,
    pub steepness_s_rad: Option<Spanned<Vec<f64>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawGains {
    pub shift: Spanned<[i64; 3]>,
    #[serde(default)]
    pub g: BTreeMap<Text, Spanned<[i64; 3]>>,
    #[serde(default)]
    pub si: BTreeMap<Text, Triple>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawEncoder {
    pub resolution_rad: Number,
    pub variation_rad: Number,
    pub period_s: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawSensor {
    pub name: Text,
    pub unit: String,
    pub range: Option<Spanned<[f64; 2]>>,
}
