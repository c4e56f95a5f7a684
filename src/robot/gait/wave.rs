//! A gait: a wave for each joint.

use crate::number::math;
use crate::robot::{JointId, Model, RobotError};
use std::f64::consts::TAU;
use std::path::Path;

/// Angles that a controller is asked for.
pub trait Setpoints {
    /// Joints that there are.
    fn joints(&self) -> usize;

    /// Setpoint of a joint at a time \[rad\].
    fn angle_rad(&self, joint: JointId, t_s: f64) -> f64;

    /// Setpoints of all joints at a time \[rad\].
    ///
    /// # Panics
    /// Where `out` has not the number of joints.
    fn setpoints(&self, t_s: f64, out: &mut [f64]) {
        assert!(out.len() == self.joints(), "{} setpoints for {} joints", out.len(), self.joints());
        for (k, angle_rad) in out.iter_mut().enumerate() {
            *angle_rad = self.angle_rad(JointId::of(k), t_s);
        }
    }
}

/// How a wave goes over its cycle, from phase 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    Sine,
    Cosine,
    /// Values at phases, joined by lines.
    Linear(Vec<[f64; 2]>),
    /// The same, coming to rest at every value: `x^2 (3 - 2x)` between two.
    Smooth(Vec<[f64; 2]>),
}

impl Shape {
    /// Value at a phase; any number of cycles.
    pub fn at(&self, phase: f64) -> f64 {
        match self {
            Self::Sine => math::sin(TAU * phase),
            Self::Cosine => math::cos(TAU * phase),
            Self::Linear(keys) => between(keys, phase, |x| x),
            Self::Smooth(keys) => between(keys, phase, ease),
        }
    }
}

/// `x^2 (3 - 2x)`, from 0 to 1 with zero slope at both ends.
pub(super) fn ease(x: f64) -> f64 {
    x * x * (3.0 - 2.0 * x)
}

/// Keys of a cycle, the first at phase 0; the last leads back to the first.
fn between(keys: &[[f64; 2]], phase: f64, share: impl Fn(f64) -> f64) -> f64 {
    let phase = phase.rem_euclid(1.0);
    let next = keys.partition_point(|key| key[0] <= phase);
    let [from, low] = keys[next.max(1) - 1];
    let [to, high] = keys.get(next).copied().unwrap_or([1.0, keys[0][1]]);
    low + (high - low) * share((phase - from) / (to - from))
}

/// What one joint does: `stand + e amplitude shape(s / period + phase)`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Wave {
    pub stand_rad: f64,
    pub shape: Shape,
    /// Cycles by which the joint is ahead.
    pub phase: f64,
    /// One for each amplitude set, with its sign.
    pub amplitude_rad: Vec<f64>,
}

impl Wave {
    pub fn still(stand_rad: f64) -> Self {
        Self { stand_rad, shape: Shape::Sine, phase: 0.0, amplitude_rad: Vec::new() }
    }
}

/// A gait: standing first, then walking in cycles that grow in smoothly.
///
/// With the time s since the walk's start, `q = stand + e A shape(s / period + phase)` and
/// `e = x^2 (3 - 2x)`, `x = min(1, s / ramp)`. It goes on for as long as it is asked.
///
/// ```
/// use aibo_fit::robot::{Gait, Model, Setpoints};
/// let robot = Model::ers7();
/// let trot = Gait::built_in("trot", robot)?;
/// let mut angles = [0.0; 22];
/// trot.setpoints(0.0, &mut angles);
/// assert_eq!(angles[..3], [-0.30, 0.10, 0.10]);
/// assert_eq!(trot.amplitudes(), ["floor", "air"]);
/// # Ok::<(), aibo_fit::robot::RobotError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Gait {
    pub(super) name: String,
    pub(super) about: String,
    pub(super) stand_s: f64,
    pub(super) walk_s: f64,
    pub(super) period_s: f64,
    pub(super) ramp_s: f64,
    pub(super) sets: Vec<String>,
    pub(super) set: usize,
    pub(super) waves: Vec<Wave>,
}

/// The gaits that are compiled in.
const BUILT_IN: [(&str, &str); 8] = [
    ("trot", include_str!("../../../data/gaits/trot.toml")),
    ("trot-2hz", include_str!("../../../data/gaits/trot-2hz.toml")),
    ("crawl", include_str!("../../../data/gaits/crawl.toml")),
    ("pace", include_str!("../../../data/gaits/pace.toml")),
    ("turn-left", include_str!("../../../data/gaits/turn-left.toml")),
    ("sideways-right", include_str!("../../../data/gaits/sideways-right.toml")),
    ("fall", include_str!("../../../data/gaits/fall.toml")),
    ("topple", include_str!("../../../data/gaits/topple.toml")),
];

impl Gait {
    /// Names of the gaits that are compiled in.
    pub fn names() -> impl Iterator<Item = &'static str> {
        BUILT_IN.iter().map(|(name, _)| *name)
    }

    /// A gait that is compiled in, for a robot that has its joints.
    ///
    /// # Errors
    /// [`RobotError::NoGait`] with the names that there are; [`RobotError::File`] where the robot lacks a joint or is
    /// too slow.
    pub fn built_in(name: &str, model: &Model) -> Result<Self, RobotError> {
        let Some((name, text)) = BUILT_IN.iter().find(|(other, _)| *other == name) else {
            return Err(RobotError::NoGait {
                what: "gait",
                name: name.to_owned(),
                known: Self::names().map(str::to_owned).collect(),
            });
        };
        Self::from_toml(&Path::new("data/gaits").join(format!("{name}.toml")), text, model)
    }

    /// The same gait with another set of amplitudes.
    ///
    /// # Errors
    /// [`RobotError::NoGait`] with the sets that there are.
    pub fn with_amplitude(&self, set: &str) -> Result<Self, RobotError> {
        match self.sets.iter().position(|other| other == set) {
            Some(set) => Ok(Self { set, ..self.clone() }),
            None => Err(RobotError::NoGait { what: "amplitude set", name: set.to_owned(), known: self.sets.clone() }),
        }
    }

    /// The same gait with another number of cycles per second, above 0.
    #[must_use]
    pub fn at_frequency(&self, frequency_hz: f64) -> Self {
        Self { period_s: 1.0 / frequency_hz, ..self.clone() }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What its file says of it.
    pub fn about(&self) -> &str {
        &self.about
    }

    /// Names of its amplitude sets; the first is the default.
    pub fn amplitudes(&self) -> &[String] {
        &self.sets
    }

    /// The set it uses.
    pub fn amplitude(&self) -> &str {
        &self.sets[self.set]
    }

    /// Time it stands before it walks \[s\].
    pub fn stand_s(&self) -> f64 {
        self.stand_s
    }

    /// Time it is meant to walk \[s\].
    pub fn walk_s(&self) -> f64 {
        self.walk_s
    }

    /// Time of one cycle \[s\].
    pub fn period_s(&self) -> f64 {
        self.period_s
    }
}

impl Setpoints for Gait {
    fn joints(&self) -> usize {
        self.waves.len()
    }

    fn angle_rad(&self, joint: JointId, t_s: f64) -> f64 {
        let wave = &self.waves[joint.index()];
        let walked_s = t_s - self.stand_s;
        let amplitude_rad = wave.amplitude_rad.get(self.set).copied().unwrap_or(0.0);
        if amplitude_rad == 0.0 || !(walked_s > 0.0) {
            return wave.stand_rad;
        }
        let grown = if walked_s < self.ramp_s { ease(walked_s / self.ramp_s) } else { 1.0 };
        wave.stand_rad + grown * amplitude_rad * wave.shape.at(walked_s / self.period_s + wave.phase)
    }
}
