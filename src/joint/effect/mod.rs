//! The catalogue of unmodelled effects: terms that may be added to one stage of the chain.
//!
//! Each effect is one file with its physics, its parameters (units, zero, bounds), the points from which a search
//! starts, and the term that it puts on a [`Chain`]. They serve fitting and simulation alike. One more effect is one
//! file and one line in the table of `catalogue.rs`.

mod angle_offset;
mod asymmetric_friction;
mod backlash;
mod catalogue;
mod compliance;
mod dead_band;
mod delay;
mod end_stop;
mod friction_drift;
mod gear_friction;
mod joint_spring;
mod load_friction;
mod motor_gain;
mod position_friction;
mod quadratic_drag;
mod sensor_delay;
mod sensor_gain;
mod setpoint_hold;
mod setpoint_profile;
mod speed_limit;
mod stribeck;
#[cfg(test)]
mod tests;
mod torque_limit;

use super::{Chain, Real};
use std::fmt;

pub use catalogue::{EffectForm, EffectId, Stage, UnknownEffect};

/// How an effect's parameter is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scan {
    /// By its logarithm.
    Logarithm,
    /// As it is, with a typical change in its unit.
    Linear(f64),
    /// Not at all: it takes the values of the starting points only.
    Held,
}

/// A parameter as it is searched.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectParameter {
    /// Name; that of the catalogue where the two are the same.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Lowest value.
    pub lower: f64,
    /// Highest value.
    pub upper: f64,
    /// How it is searched.
    pub scan: Scan,
    /// What is believed of it before any log is seen, where that says something: middle, in its unit, and standard
    /// deviation, relative where it is searched by its logarithm.
    pub likely: Option<[f64; 2]>,
}

impl EffectParameter {
    fn linear(name: &'static str, unit: &'static str, [lower, upper]: [f64; 2], scale: f64) -> Self {
        Self { name, unit, lower, upper, scan: Scan::Linear(scale), likely: None }
    }

    /// One of the values of the starting points.
    fn held(name: &'static str, unit: &'static str, [lower, upper]: [f64; 2]) -> Self {
        Self { name, unit, lower, upper, scan: Scan::Held, likely: None }
    }

    fn logarithm(name: &'static str, unit: &'static str, [lower, upper]: [f64; 2]) -> Self {
        Self { name, unit, lower, upper, scan: Scan::Logarithm, likely: None }
    }

    fn likely(self, middle: f64, sd: f64) -> Self {
        Self { likely: Some([middle, sd]), ..self }
    }
}

/// A parameter under the catalogue's name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Named {
    /// The catalogue's name.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// What it is where the effect is absent; a limit is absent at infinity.
    pub zero: f64,
    /// Values that make sense, whatever the joint.
    pub bounds: Bounds,
}

/// Values that a parameter may have on any joint, in SI units; a search keeps to what its logs can show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bounds {
    /// From the first to the second.
    Within([f64; 2]),
    /// One or the other.
    Either([f64; 2]),
}

impl Bounds {
    /// No parameter of a joint is larger, whatever its SI unit; a stop's stiffness comes nearest.
    const LARGEST: f64 = 1e9;
    const ANY: Self = Self::Within([-Self::LARGEST, Self::LARGEST]);
    const NOT_NEGATIVE: Self = Self::Within([0.0, Self::LARGEST]);
    /// Zero would divide.
    const POSITIVE: Self = Self::Within([1e-12, Self::LARGEST]);
    const ANGLE: Self = Self::Within([-std::f64::consts::TAU, std::f64::consts::TAU]);

    /// The part of an interval in which there are values.
    pub fn clip(self, [low, high]: [f64; 2]) -> [f64; 2] {
        match self {
            Self::POSITIVE => [low.max(0.0), high],
            Bounds::Within([lower, upper]) => [low.max(lower), high.min(upper)],
            Bounds::Either(_) => [low, high],
        }
    }

    /// Whether a value is one of them; NaN never is.
    pub fn admit(self, value: f64) -> bool {
        match self {
            Bounds::Within([lower, upper]) => lower <= value && value <= upper,
            Bounds::Either(values) => values.contains(&value),
        }
    }
}

impl fmt::Display for Bounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NOT_NEGATIVE => write!(f, "zero or above, up to {:e}", Self::LARGEST),
            Self::POSITIVE => write!(f, "above zero, up to {:e}", Self::LARGEST),
            Bounds::Within([lower, upper]) if upper == Self::LARGEST => write!(f, "{lower:e} to {upper:e}"),
            Bounds::Within([lower, upper]) => write!(f, "{lower:.3} to {upper:.3}"),
            Bounds::Either([first, second]) => write!(f, "{first} or {second}"),
        }
    }
}

/// How far a joint and its logs reach: what gives an effect's parameters their typical sizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Largest gravity torque, or drive torque where there is no gravity \[N m\].
    pub torque_nm: f64,
    /// Of the nominal joint \[N m\].
    pub coulomb_nm: f64,
    /// Of the nominal bare link \[kg m^2\].
    pub inertia_kg_m2: f64,
    /// Largest speed \[rad/s\].
    pub speed_rad_s: f64,
    /// Lowest and highest angle \[rad\].
    pub angle_rad: [f64; 2],
    /// Longest log \[s\].
    pub duration_s: f64,
    /// Quantisation step \[rad\], or noise.
    pub resolution_rad: f64,
    /// The driven logs, where there are any.
    pub driven: Option<DrivenReach>,
}

/// How far driven logs reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenReach {
    /// Largest commanded torque \[N m\].
    pub command_nm: f64,
    /// Largest speed \[rad/s\].
    pub speed_rad_s: f64,
    /// Sampling period \[s\].
    pub period_s: f64,
    /// Some are driven by a setpoint, not by a torque.
    pub by_setpoint: bool,
    /// The control law of some has a derivative gain.
    pub by_derivative: bool,
    /// The control law of some has an integral gain.
    pub by_integral: bool,
}

/// One effect of the catalogue, in one of its forms.
trait Effect: Copy + 'static {
    /// Its forms with their names, the default first; the only one has no name.
    const FORMS: &'static [(Self, &'static str)];

    /// Parameters of the default form under the catalogue's names; the first measures its size.
    const NAMED: &'static [Named];

    /// Parameters of this form under the catalogue's names; the first measures its size.
    fn named_parameters(self) -> &'static [Named] {
        Self::NAMED
    }

    /// Values of this form that do much the same as fitted ones of the default form.
    fn near_default(self, values: &[f64], _reach: &Reach) -> Vec<f64> {
        values.to_vec()
    }

    /// Its parameters as they are searched.
    fn parameters(self, reach: &Reach) -> Vec<EffectParameter>;

    /// Points from which a search starts; empty where the logs cannot show the effect.
    fn starts(self, reach: &Reach) -> Vec<Vec<f64>>;

    /// Puts the term on a chain; `bare_kg_m2` is the inertia of the bare link.
    fn apply<T: Real>(self, values: &[T], bare_kg_m2: T, chain: &mut Chain<T>);

    /// The values under the catalogue's names, of the values as they are searched.
    fn named(self, values: &[f64], _coulomb_nm: f64) -> Vec<f64> {
        values.to_vec()
    }

    /// The values as they are searched, of the catalogue's.
    fn searched(self, named: &[f64], _coulomb_nm: f64) -> Vec<f64> {
        named.to_vec()
    }
}

/// All combinations of two sets of values.
fn pairs(a: &[f64], b: &[f64]) -> Vec<Vec<f64>> {
    a.iter().flat_map(|&a| b.iter().map(move |&b| vec![a, b])).collect()
}
