//! What is asked for: plain data, as a TOML file has it or as code puts it together.

use crate::log::{ClampedStudy, RobotStudy};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// What is believed, what is true, and the logs to make.
#[derive(Clone, Debug)]
pub struct Spec {
    /// Where it stands, for messages; paths in it are relative to its folder.
    pub file: PathBuf,
    /// Seed of scatter and sensors' noise.
    pub seed: u64,
    /// What the engineer believes.
    pub believed: Believed,
    /// What is true instead.
    pub truth: TruthSpec,
    /// What the truth has and the belief lacks.
    pub effects: Vec<EffectSpec>,
    /// The logs.
    pub logs: Vec<LogSpec>,
}

/// What is believed of a robot that a description describes, what is true, and the logs to make.
#[derive(Clone, Debug)]
pub struct DescribedSpec {
    /// Where it stands, for messages; paths in it are relative to its folder.
    pub file: PathBuf,
    /// Seed of scatter, motions and sensors' noise.
    pub seed: u64,
    /// What the engineer believes: a study without logs.
    pub study: ClampedStudy,
    /// The same as it is written.
    pub(super) tables: toml::Table,
    /// What is true instead.
    pub truth: TruthSpec,
    /// What the truth has and the belief lacks.
    pub effects: Vec<EffectSpec>,
    /// The logs.
    pub logs: Vec<LogSpec>,
}

/// A spec of either kind.
#[derive(Clone, Debug)]
pub enum AnySpec {
    /// A robot with legs, or a joint of a leg.
    Robot(Box<Spec>),
    /// Any robot with a clamped base, `scenario = "fixed"`.
    Described(Box<DescribedSpec>),
}

/// What the engineer believes.
#[derive(Clone, Debug)]
pub enum Believed {
    /// A whole robot: a robot study without logs.
    Robot(Box<RobotStudy>),
    /// A joint of a leg on the bench: the robot study it is simulated with, and the joint.
    Joint(Box<RobotStudy>, JointBench),
}

/// A joint of a leg on the bench.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointBench {
    /// Leg and joint, `rf2` for instance.
    pub name: String,
    /// Angles of the leg's other joints \[rad\], by name; 0 where they are not named.
    #[serde(default)]
    pub angles: BTreeMap<String, f64>,
    /// Gravity in trunk axes \[m/s^2\]; level unless stated.
    pub gravity: Option<[f64; 3]>,
    /// The other joints are held by their controllers, not rigidly.
    #[serde(default)]
    pub others_give: bool,
    /// Believed numbers, where they are not the tables': `I*` \[kg m^2\].
    pub inertia: Option<f64>,
    /// `M*` \[kg m\]
    pub moment: Option<f64>,
    /// \[N m\]
    pub coulomb: Option<f64>,
    /// \[N m s/rad\]
    pub viscous: Option<f64>,
}

/// `[truth]`: where the true robot differs from the believed one.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct TruthSpec {
    /// True masses in units of the believed ones.
    pub mass_scale: MassScale,
    /// Masses that the engineer does not know of.
    pub payload: Vec<PayloadSpec>,
    /// True friction, by joint or kind of joint.
    pub friction: BTreeMap<String, FrictionTruth>,
    /// Torque that arrives per stated gain, by joint; described robots only.
    pub gain: BTreeMap<String, f64>,
    /// Standard deviation of readings before rounding \[rad\]; described robots only.
    pub noise: Option<f64>,
    /// True floor.
    pub floor: FloorTruth,
    /// The floor rises by this angle towards the front \[rad\].
    pub slope: f64,
    /// Relative standard deviation of masses, friction and floor.
    pub scatter: f64,
    /// Of friction, where it is another.
    pub friction_scatter: Option<f64>,
    /// How it is integrated: `stiff` unless stated; `rk2`, `rk4`, `dormand_prince`, `adams`, `bdf`.
    pub method: Option<String>,
    /// Longest step of stiff, rk2 and rk4 \[s\]; 1e-4, and 1e-5 for rk2 and rk4, unless stated.
    pub step: Option<f64>,
    /// Tolerance of the other methods; 1e-7 unless stated.
    pub tolerance: Option<f64>,
}

/// True masses in units of the believed ones.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(untagged, expecting = "expected a number, or one for each part such as { trunk = 1.1 }")]
pub enum MassScale {
    /// One for all parts.
    All(f64),
    /// By part; 1 for the others.
    ByPart(BTreeMap<String, f64>),
}

impl Default for MassScale {
    fn default() -> Self {
        Self::All(1.0)
    }
}

/// A mass on a part.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct PayloadSpec {
    /// \[kg\]
    pub mass: f64,
    /// The part; the robot's root unless stated.
    pub body: Option<String>,
    /// Place in the part's frame \[m\].
    pub at: [f64; 3],
}

/// True friction of a joint, where it differs.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct FrictionTruth {
    /// \[N m\]
    pub coulomb: Option<f64>,
    /// \[N m s/rad\]
    pub viscous: Option<f64>,
}

/// True floor, where it differs; keys and units of a study's `[floor]`.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
#[expect(missing_docs, reason = "the keys of a study's [floor]")]
pub struct FloorTruth {
    pub stiffness: Option<f64>,
    pub damping: Option<f64>,
    pub exponent: Option<f64>,
    #[serde(rename = "static")]
    pub static_friction: Option<f64>,
    pub coulomb: Option<f64>,
    pub viscous: Option<f64>,
    pub steepness: Option<f64>,
    pub stribeck_speed: Option<f64>,
    pub torsion_radius: Option<f64>,
}

/// `[[effect]]`: an effect of the catalogue on joints.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct EffectSpec {
    /// `torque_limit` for instance.
    pub id: String,
    /// Where; in a joint's spec the joint.
    #[serde(default)]
    pub joints: JointChoice,
    /// The catalogue's parameters, all of them.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, f64>,
}

/// Joints of a robot.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(untagged, expecting = "expected \"all\", a joint or kind of joint, or a list of them")]
pub enum JointChoice {
    /// `all` that have a controller, a joint, or a kind of joint.
    One(String),
    /// Several of these.
    Many(Vec<String>),
}

impl Default for JointChoice {
    fn default() -> Self {
        Self::One("all".to_owned())
    }
}

/// `[[log]]`: a log to make.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LogSpec {
    /// Its name.
    pub file: String,
    /// `fit` (default) or `validate`.
    pub role: Option<String>,
    /// Air and floor: a gait that is built in, a gait's file, or a motion file; `trot` unless stated. Described robots:
    /// `sines` (unless stated), `steps`, or a file.
    pub gait: Option<String>,
    /// Air and floor: a table of setpoints, `t` and a column for each joint.
    pub setpoints: Option<String>,
    /// The gait's set of amplitudes; `air` in the air and the gait's first on the floor unless stated.
    pub amplitude: Option<String>,
    /// Cycles per second; the gait's own unless stated.
    pub frequency: Option<f64>,
    /// \[s\]; the gait's or table's own unless stated, 4 s for a drop.
    pub duration: Option<f64>,
    /// Air and floor: write the trunk's place and what its accelerometers feel too.
    pub base: bool,
    /// Described robots: logs of one name were taken in one go.
    pub session: Option<String>,
    /// Floor: state the displacement between these two times \[s\] as measured, to a millimetre.
    pub forward: Option<[f64; 2]>,
    /// Drop: the joint that is let go.
    pub released: Option<String>,
    /// Drop: when \[s\]; 0.5 unless stated.
    pub release_time: Option<f64>,
    /// Drop: setpoints of the joints \[rad\], by name; rest where they are not named.
    pub angles: BTreeMap<String, f64>,
    /// Drop: setpoint of the joint of a joint's spec \[rad\].
    pub angle: Option<f64>,
    /// Drop: gravity in trunk axes \[m/s^2\]; level unless stated.
    pub gravity: Option<[f64; 3]>,
    /// Drop: a known mass on the lower leg.
    pub extra: Option<ExtraSpec>,
}

impl LogSpec {
    /// Keys that only drops know, and whether they are stated.
    pub(super) fn of_a_drop(&self) -> [(&'static str, bool); 6] {
        [
            ("released", self.released.is_some()),
            ("release_time", self.release_time.is_some()),
            ("angles", !self.angles.is_empty()),
            ("angle", self.angle.is_some()),
            ("gravity", self.gravity.is_some()),
            ("extra", self.extra.is_some()),
        ]
    }
}

/// `[log.extra]`, as in a study.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExtraSpec {
    /// \[kg\]
    pub mass: f64,
    /// Axis of the joint that is let go to the mass's centre \[m\].
    pub distance: f64,
    /// \[m\]
    #[serde(default)]
    pub radius: f64,
    /// \[m\]
    #[serde(default)]
    pub length: f64,
}
