//! Free-form laws: a torque, a friction or a shift of the reading that is a smooth function of one variable of the chain,
//! given as a curve.
//!
//! A law is an effect without a formula. It acts wherever the joint's equations do, sticking and breakaway included, and
//! its values may bear derivatives as any parameter.

mod curve;
mod on_chain;
mod table;

pub use curve::Curve;
pub use table::{CurveTable, LawTable};

use super::{Contact, FrictionTerm, Real, Stage};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

/// What a law is a function of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "&'static str")]
pub enum LawVariable {
    /// Joint angle \[rad\]; of a law of the reading, what gain and once-per-turn error make of it.
    Angle,
    /// Joint speed \[rad/s\].
    Speed,
    /// Gravity torque of link and extra mass \[N m\].
    Load,
    /// Torque that the motor delivers \[N m\].
    MotorTorque,
    /// Time from the start of the log \[s\].
    Time,
    /// Slope of the setpoint that the controller has \[rad/s\]; 0 where no setpoint drives the joint.
    SetpointRate,
}

impl LawVariable {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Angle, Self::Speed, Self::Load, Self::MotorTorque, Self::Time, Self::SetpointRate];

    /// The word in files and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Angle => "angle",
            Self::Speed => "speed",
            Self::Load => "load",
            Self::MotorTorque => "torque",
            Self::Time => "time",
            Self::SetpointRate => "setpoint_rate",
        }
    }

    /// The words in sentences.
    pub fn words(self) -> &'static str {
        match self {
            Self::Angle => "angle",
            Self::Speed => "speed",
            Self::Load => "gravity torque",
            Self::MotorTorque => "motor torque",
            Self::Time => "time",
            Self::SetpointRate => "speed of the setpoint",
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Angle => "rad",
            Self::Speed | Self::SetpointRate => "rad/s",
            Self::Load | Self::MotorTorque => "N m",
            Self::Time => "s",
        }
    }
}

impl fmt::Display for LawVariable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for LawVariable {
    type Err = BadLaw;

    fn from_str(name: &str) -> Result<Self, BadLaw> {
        let known = Self::ALL.into_iter().find(|variable| variable.name() == name);
        known.ok_or_else(|| BadLaw::Variable { found: name.to_owned() })
    }
}

/// What a law adds to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "&'static str")]
pub enum LawActs {
    /// The torque on the joint, as it is \[N m\]; a function of the variable with its sign.
    Torque,
    /// The torque that resists motion \[N m\], which is cut off at zero; a function of the variable's size, or of the
    /// angle with its sign.
    Friction,
    /// What the encoder reads, and the controller sees \[rad\]; a function of angle or time.
    Reading,
    /// What arrives of the motor's torque, as a share of it: 0.1 is a tenth more; a function of angle, speed or time.
    Gain,
}

impl LawActs {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Torque, Self::Friction, Self::Reading, Self::Gain];

    /// The word in files and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Torque => "torque",
            Self::Friction => "friction",
            Self::Reading => "reading",
            Self::Gain => "gain",
        }
    }

    /// The unit of the law's values; empty for a share.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Torque | Self::Friction => "N m",
            Self::Reading => "rad",
            Self::Gain => "",
        }
    }
}

impl fmt::Display for LawActs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for LawActs {
    type Err = BadLaw;

    fn from_str(name: &str) -> Result<Self, BadLaw> {
        let known = Self::ALL.into_iter().find(|acts| acts.name() == name);
        known.ok_or_else(|| BadLaw::Acts { found: name.to_owned() })
    }
}

/// Words in files, both ways.
macro_rules! as_word {
    ($($word:ty),*) => {$(
        impl From<$word> for &'static str {
            fn from(word: $word) -> Self {
                word.name()
            }
        }

        impl TryFrom<String> for $word {
            type Error = BadLaw;

            fn try_from(name: String) -> Result<Self, BadLaw> {
                name.parse()
            }
        }
    )*};
}
as_word!(LawVariable, LawActs);

/// Why something is no law.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BadLaw {
    /// Not as many values as knots.
    #[error("{x} values in x and {y} in y; each knot has one value")]
    Lengths {
        /// Knots.
        x: usize,
        /// Values.
        y: usize,
    },
    /// No two knots.
    #[error("{found} knot(s) in x; a curve takes at least 2")]
    TooFew {
        /// How many there are.
        found: usize,
    },
    /// Knots out of order.
    #[error("x[{index}] = {after} does not follow x[{}] = {before}; x must increase", index - 1)]
    NotIncreasing {
        /// Of the later one.
        index: usize,
        /// The earlier.
        before: f64,
        /// The later.
        after: f64,
    },
    /// A number that is none.
    #[error("{column}[{index}] = {value} is not a finite number")]
    NotFinite {
        /// x or y.
        column: &'static str,
        /// Which.
        index: usize,
        /// What it is.
        value: f64,
    },
    /// A variable that the chain does not have.
    #[error("unknown variable {found:?}; one of angle, speed, load, torque, time, setpoint_rate was expected")]
    Variable {
        /// What was found.
        found: String,
    },
    /// Something that a law cannot act on.
    #[error("acts = {found:?}; one of torque, friction, reading, gain was expected")]
    Acts {
        /// What was found.
        found: String,
    },
    /// A law of several variables, or of none.
    #[error("a law of {found} variables; exactly one was expected in `variables`")]
    Variables {
        /// How many there are.
        found: usize,
    },
    /// A stage that the chain does not have.
    #[error("unknown stage {found:?}; one of setpoint, delay, controller, motor, gearing, link, sensor was expected")]
    Stage {
        /// What was found.
        found: String,
    },
    /// Values in another unit.
    #[error("unit {found:?} of table.y; a law of the {acts} is in {:?}", acts.unit())]
    Unit {
        /// What was found.
        found: String,
        /// What the law acts on.
        acts: LawActs,
    },
    /// A reading that would turn back while the angle goes on.
    #[error("the reading falls by {fall} rad/rad; it may not turn back while the angle goes on: no slope below -0.9")]
    Fold {
        /// The least slope.
        fall: f64,
    },
    /// A law that the chain has no place for.
    #[error("a law of the {acts} cannot be a function of {variable}: {why}")]
    Pair {
        /// What it acts on.
        acts: LawActs,
        /// What it is a function of.
        variable: LawVariable,
        /// The reason.
        why: &'static str,
    },
}

/// A law on a joint.
///
/// ```
/// use aibo_fit::joint::{Law, LawActs, LawVariable};
/// // A spring of 0.2 N m/rad within half a radian either way.
/// let law = Law::new(LawVariable::Angle, LawActs::Torque, [-0.5, 0.5].into(), &[0.1, -0.1])?;
/// assert!((law.at(0.25) + 0.05f64).abs() < 1e-15);
/// # Ok::<(), aibo_fit::joint::BadLaw>(())
/// ```
#[derive(Clone, Debug)]
pub struct Law<T> {
    variable: LawVariable,
    acts: LawActs,
    curve: Arc<Curve<T>>,
}

impl<T: Real> Law<T> {
    /// The curve through `values` at increasing knots, in the units of variable and effect.
    ///
    /// # Errors
    /// [`BadLaw`] for knots and values that make no curve ([`Curve::new`]), and where the chain has no place for such a law.
    pub fn new(variable: LawVariable, acts: LawActs, at: Arc<[f64]>, values: &[T]) -> Result<Self, BadLaw> {
        let why = match (acts, variable) {
            (LawActs::Reading, LawVariable::Angle | LawVariable::Time) | (LawActs::Torque, _) => None,
            (LawActs::Reading, _) => Some("an encoder errs over angle or time alone"),
            (LawActs::Friction, LawVariable::SetpointRate) => Some("nothing that rubs knows the setpoint"),
            (LawActs::Friction, _) => None,
            (LawActs::Gain, LawVariable::Angle | LawVariable::Speed | LawVariable::Time) => None,
            (LawActs::Gain, _) => Some("a share of the motor's torque depends on angle, speed or time alone"),
        };
        if let Some(why) = why {
            return Err(BadLaw::Pair { acts, variable, why });
        }
        Ok(Self { variable, acts, curve: Arc::new(Curve::new(at, values)?) })
    }

    /// What it is a function of.
    pub fn variable(&self) -> LawVariable {
        self.variable
    }

    /// What it adds to.
    pub fn acts(&self) -> LawActs {
        self.acts
    }

    /// Its curve.
    pub fn curve(&self) -> &Curve<T> {
        &self.curve
    }

    /// Its value, in the unit of what it acts on.
    #[inline]
    pub fn at(&self, x: T) -> T {
        self.curve.value(x)
    }

    /// The stage of the chain that it changes.
    pub fn stage(&self) -> Stage {
        self.acts.stage(self.variable)
    }

    /// The same law for another kind of number, without derivatives.
    pub fn held<U: Real>(&self) -> Law<U> {
        Law { variable: self.variable, acts: self.acts, curve: Arc::new(self.curve.held()) }
    }
}

impl LawActs {
    /// The stage of the chain that such a law of a variable changes.
    pub fn stage(self, variable: LawVariable) -> Stage {
        match (self, variable) {
            (LawActs::Reading, _) => Stage::Sensor,
            (LawActs::Friction, LawVariable::MotorTorque) => Stage::Gearing,
            (LawActs::Torque, LawVariable::MotorTorque | LawVariable::SetpointRate) | (LawActs::Gain, _) => {
                Stage::Motor
            }
            _ => Stage::Link,
        }
    }
}

/// A law of friction is one of its terms.
impl<T: Real> FrictionTerm<T> for Law<T> {
    fn resistance_nm(&self, at: &Contact<T>) -> T {
        let size = |x: T| if x.re() < 0.0 { -x } else { x };
        self.at(match self.variable {
            LawVariable::Angle => at.angle_rad,
            LawVariable::Speed => at.speed_rad_s,
            LawVariable::Load => size(at.gravity_nm),
            LawVariable::MotorTorque => size(at.motor_nm),
            LawVariable::Time => at.t_s,
            LawVariable::SetpointRate => return T::nought(),
        })
    }

    fn slope_nm_s_rad(&self, speed_rad_s: f64, _t_s: f64) -> f64 {
        match self.variable {
            LawVariable::Speed => self.curve.steepest(NEAR * speed_rad_s, speed_rad_s / NEAR),
            _ => 0.0,
        }
    }

    fn changes_with_time(&self) -> bool {
        self.variable == LawVariable::Time
    }
}

/// Within a step a speed stays between this share of itself and its inverse, as far as the choice of the step goes.
const NEAR: f64 = 0.5;
