//! Reads a robot file: the format of `data/ers7.toml`, for any tree of revolute joints.
//!
//! One reader serves the leg of the pendulum layers ([`Ers7Tables`](super::Ers7Tables)) and the whole robot
//! (`robot::Model`). A file that it accepts is a tree of named parts with masses, places and axes that a machine can
//! have; whatever it refuses, it refuses with file, line, key, what was found and what was expected.

mod check;
mod raw;
#[cfg(test)]
mod tests;
mod tree;

use std::path::Path;

use nalgebra::Vector3;

use super::tables::{Joint, Part};
use crate::log::{Document, FloorSpec, LogError};

/// The robot file of the thesis's tables, `data/ers7.toml`.
pub const ERS7_TOML: &str = include_str!("../../../data/ers7.toml");

/// The `schema` this code reads.
pub(super) const SCHEMA: i64 = 1;

/// Friction set that is taken where nothing else is asked for; the ERS-7's is that of Table 3.4.
pub(crate) const FRICTION_SET: &str = "chosen";
/// Gain set that is taken where nothing else is asked for; the ERS-7's is that of Table B.2.
pub(crate) const GAIN_SET: &str = "printed";
/// A frame of the robot: how often its controllers get setpoints, unless a file says otherwise \[s\].
pub(crate) const FRAME_S: f64 = 0.008;

/// How the root part is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    /// Free in space.
    Floating,
    /// Held where it is.
    Clamped,
}

/// Friction of one joint (eqs 3.11, 3.14).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointFriction {
    /// Coulomb friction `mu_c` \[N m\].
    pub coulomb_nm: f64,
    /// Viscous friction `mu_v` \[N m s/rad\].
    pub viscous_nm_s_rad: f64,
    /// Static friction `mu_st` \[N m\]; 0: term absent.
    pub static_nm: f64,
    /// Stribeck speed `v_st` \[rad/s\]; 0: term absent.
    pub stribeck_rad_s: f64,
    /// Steepness `s` of the regularised sign \[s/rad\]; 0: term absent.
    pub steepness_s_rad: f64,
}

/// A named set of joint friction: `[friction.NAME]`.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionSet {
    /// `estimated` for instance.
    pub name: String,
    /// Friction by joint or kind of joint, in file order; joints that are not here have none.
    pub by_joint: Vec<(String, JointFriction)>,
}

/// A named set of controller gains as OPEN-R takes them (2.7): `[gains.NAME]`.
#[derive(Clone, Debug, PartialEq)]
pub struct GainSet {
    /// `printed` for instance.
    pub name: String,
    /// Shifts `s` of P, I and D, the same for every joint.
    pub shift: [u8; 3],
    /// Integers `g` of P, I and D by joint or kind of joint, in order of name; joints that are not here have no
    /// controller.
    pub by_joint: Vec<(String, [u16; 3])>,
    /// P, I and D by joint or kind of joint where they are no such integers \[N m/rad, N m/(rad s), N m s/rad\]; these
    /// come first.
    pub si: Vec<(String, [f64; 3])>,
}

/// `[[effect]]`: an effect of the catalogue on joints, as written; the robot says whether it can be.
#[derive(Clone, Debug, PartialEq)]
pub struct FileEffect {
    /// The catalogue's id.
    pub id: String,
    /// Names or kinds of joints.
    pub joints: Vec<String>,
    /// By the catalogue's names, in SI units.
    pub parameters: Vec<(String, f64)>,
}

/// `[[attached]]`: a point mass fixed to a part.
#[derive(Clone, Debug, PartialEq)]
pub struct FileAttached {
    /// The part.
    pub part: String,
    /// \[kg\]
    pub mass_kg: f64,
    /// In the part's frame \[m\].
    pub at_m: Vector3<f64>,
}

/// The position sensors (section B.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderData {
    /// Quantisation step \[rad\].
    pub resolution_rad: f64,
    /// Width within which all readings of one angle lie \[rad\].
    pub variation_rad: f64,
    /// Sampling period \[s\].
    pub period_s: f64,
}

/// Another sensor and its range (Table B.1).
#[derive(Clone, Debug, PartialEq)]
pub struct SensorRange {
    /// `head_ir_near` for instance.
    pub name: String,
    /// Unit of the range; empty where it has none.
    pub unit: String,
    /// Least and greatest reading, where they are known.
    pub range: Option<[f64; 2]>,
}

/// A robot as its file has it, checked, in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotTables {
    /// `ers7`, or the name in a user's file.
    pub name: String,
    /// The part that is on no joint: `trunk`.
    pub root: String,
    /// How the root is held; floating where the file does not say.
    pub base: Base,
    /// Gravity in the world \[m/s^2\]; (0, -9.81, 0) where the file does not say.
    pub gravity_m_s2: Vector3<f64>,
    /// Table A.2, in file order.
    pub parts: Vec<Part>,
    /// Tables A.1 and A.3, in joint order; a joint's parent always hangs on an earlier joint.
    pub joints: Vec<Joint>,
    /// Friction sets, in order of name.
    pub friction: Vec<FrictionSet>,
    /// Gain sets, in order of name.
    pub gains: Vec<GainSet>,
    /// The position sensors, where the file has them.
    pub encoder: Option<EncoderData>,
    /// Other sensors.
    pub sensors: Vec<SensorRange>,
    /// Effects beyond the baseline joint, in file order.
    pub effects: Vec<FileEffect>,
    /// Masses fixed to parts, in file order.
    pub attached: Vec<FileAttached>,
    /// The floor that goes with this robot, where the file has one.
    pub floor: Option<FloorSpec>,
    /// How that floor rises towards the front and the right \[rad\].
    pub floor_slope_rad: [f64; 2],
}

impl RobotTables {
    /// Reads a robot file.
    ///
    /// # Errors
    /// [`LogError`] with file, line and key.
    pub fn read(file: &Path) -> Result<Self, LogError> {
        check::checked(&Document::open(file)?)
    }

    /// Reads a robot file that is at hand; `file` is its name in errors.
    ///
    /// # Errors
    /// As [`RobotTables::read`].
    pub fn from_toml(file: &Path, text: &str) -> Result<Self, LogError> {
        check::checked(&Document::of_text(file, text))
    }

    /// A friction set by name.
    pub fn friction_set(&self, name: &str) -> Option<&FrictionSet> {
        self.friction.iter().find(|set| set.name == name)
    }
}

/// What a table by joint or kind says of a joint: its own row, or that of its kind.
pub fn row_of<'a, T>(rows: &'a [(String, T)], joint: &Joint) -> Option<&'a T> {
    let named = |name: &str| rows.iter().find(|(row, _)| row == name).map(|(_, value)| value);
    named(&joint.name).or_else(|| named(&joint.kind))
}
