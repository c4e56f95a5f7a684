//! The effects by name, in one table: one more effect is one file and one line here.

use super::{Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Real};
use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// A stage of the chain from setpoint to log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// What reaches the controller as setpoint, and how often.
    Setpoint,
    /// When it reaches it.
    Delay,
    /// The control law.
    Controller,
    /// Torque from command: gain, limits.
    Motor,
    /// Between motor and link: rotor, play, losses under motor load.
    Gearing,
    /// Inertia, gravity, friction, springs, stops.
    Link,
    /// Zero and gain of the reading.
    Sensor,
}

impl Stage {
    /// All of them, in the chain's order.
    pub const ALL: [Stage; 7] =
        [Stage::Setpoint, Stage::Delay, Stage::Controller, Stage::Motor, Stage::Gearing, Stage::Link, Stage::Sensor];

    /// The word in reports and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Setpoint => "setpoint",
            Stage::Delay => "delay",
            Stage::Controller => "controller",
            Stage::Motor => "motor",
            Stage::Gearing => "gearing",
            Stage::Link => "link",
            Stage::Sensor => "sensor",
        }
    }
}

/// One of the formulas of a family of effects.
///
/// A family says what depends on what; which formula is a detail that the evidence picks.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct EffectForm {
    /// The family.
    pub id: EffectId,
    /// Its place among the family's forms; 0 is the default.
    form: u8,
}

/// Evaluates an expression with the term and the name of a form.
macro_rules! of_form {
    ($form:expr, $($effect:ident, $module:ident;)* |$term:ident, $name:ident| $then:expr) => {
        match $form.id {
            $(EffectId::$effect => {
                let ($term, $name) = <super::$module::Term as Effect>::FORMS[usize::from($form.form)];
                $then
            })*
        }
    };
}

macro_rules! catalogue {
    ($($(#[$doc:meta])* $effect:ident, $module:ident, $stage:ident;)*) => {
        /// An effect of the catalogue.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum EffectId { $($(#[$doc])* $effect,)* }

        impl EffectId {
            /// All of them, in the order of the catalogue.
            pub const ALL: &'static [EffectId] = &[$(EffectId::$effect,)*];

            /// The fixed id, e.g. `load_friction`.
            pub fn id(self) -> &'static str {
                match self { $(EffectId::$effect => stringify!($module),)* }
            }

            /// The stage of the chain on which it sits.
            pub fn stage(self) -> Stage {
                match self { $(EffectId::$effect => Stage::$stage,)* }
            }

        }

        impl EffectForm {
            /// What distinguishes it within its family, e.g. `exponential`; empty where the family has one form only.
            pub fn name(self) -> &'static str {
                of_form!(self, $($effect, $module;)* |term, name| { let _ = term; name })
            }

            /// How many forms a family has.
            fn count(id: EffectId) -> usize {
                match id { $(EffectId::$effect => <super::$module::Term as Effect>::FORMS.len(),)* }
            }

            /// Its parameters under the catalogue's names; the first measures its size.
            #[inline]
            pub fn named_parameters(self) -> &'static [Named] {
                of_form!(self, $($effect, $module;)* |term, _name| term.named_parameters())
            }

            /// Its parameters as they are searched.
            pub fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
                of_form!(self, $($effect, $module;)* |term, _name| term.parameters(reach))
            }

            /// Points from which a search starts; empty where logs of this reach cannot show the effect.
            pub fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
                of_form!(self, $($effect, $module;)* |term, _name| term.starts(reach))
            }

            /// Puts the effect on a chain; `bare_kg_m2` is the inertia of the bare link.
            #[inline]
            pub fn apply<T: Real>(self, values: &[T], bare_kg_m2: T, chain: &mut Chain<T>) {
                of_form!(self, $($effect, $module;)* |term, _name| term.apply(values, bare_kg_m2, chain))
            }

            /// The values under the catalogue's names, of the values as they are searched.
            pub fn named(self, values: &[f64], coulomb_nm: f64) -> Vec<f64> {
                of_form!(self, $($effect, $module;)* |term, _name| term.named(values, coulomb_nm))
            }

            /// The values as they are searched, of the catalogue's.
            pub fn searched(self, named: &[f64], coulomb_nm: f64) -> Vec<f64> {
                of_form!(self, $($effect, $module;)* |term, _name| term.searched(named, coulomb_nm))
            }

            fn near_default(self, values: &[f64], reach: &Reach) -> Vec<f64> {
                of_form!(self, $($effect, $module;)* |term, _name| term.near_default(values, reach))
            }
        }
    };
}

catalogue! {
    /// Static friction above Coulomb's, falling with speed.
    Stribeck, stribeck, Link;
    /// Friction that grows with the gravity torque on the bearing.
    LoadFriction, load_friction, Link;
    /// Friction that grows with the motor torque through the gears.
    GearFriction, gear_friction, Gearing;
    /// Friction that grows with the square of the speed.
    QuadraticDrag, quadratic_drag, Link;
    /// Coulomb friction that differs with the direction.
    AsymmetricFriction, asymmetric_friction, Link;
    /// Coulomb friction that varies over a turn.
    PositionFriction, position_friction, Link;
    /// Friction that changes along a log.
    FrictionDrift, friction_drift, Link;
    /// Free play between motor and link.
    Backlash, backlash, Gearing;
    /// A spring between motor and link.
    Compliance, compliance, Gearing;
    /// A parallel spring.
    JointSpring, joint_spring, Link;
    /// A stop inside the range of motion.
    EndStop, end_stop, Link;
    /// The encoder's zero, or the direction of the centre of mass.
    AngleOffset, angle_offset, Sensor;
    /// The encoder's gain.
    SensorGain, sensor_gain, Sensor;
    /// The reading is late.
    SensorDelay, sensor_delay, Sensor;
    /// The setpoint acts late.
    Delay, delay, Delay;
    /// The setpoint is taken over only every so often.
    SetpointHold, setpoint_hold, Setpoint;
    /// The servo limits speed and acceleration of its setpoint.
    SetpointProfile, setpoint_profile, Setpoint;
    /// Small torques do not arrive.
    DeadBand, dead_band, Motor;
    /// The motor's torque saturates.
    TorqueLimit, torque_limit, Motor;
    /// The motor's torque falls with speed.
    SpeedLimit, speed_limit, Motor;
    /// The motor delivers more or less than commanded.
    MotorGain, motor_gain, Motor;
}

impl EffectId {
    /// Whether only a motor that is on can show it. A late reading shifts a free log too, but so would another start.
    pub fn is_driven_only(self) -> bool {
        use EffectId::*;
        self == SensorDelay
            || matches!(
                self,
                GearFriction | Delay | SetpointHold | SetpointProfile | DeadBand | TorqueLimit | SpeedLimit | MotorGain
            )
    }

    /// Whether the simulator of whole robots has it too; it does not have a spring before the link or a late reading.
    pub fn is_known_to_robots(self) -> bool {
        !matches!(self, EffectId::Compliance | EffectId::SensorDelay)
    }

    /// Its forms, the default first.
    pub fn forms(self) -> impl Iterator<Item = EffectForm> {
        (0..EffectForm::count(self)).map(move |form| EffectForm { id: self, form: form as u8 })
    }

    /// Parameters of the default form under the catalogue's names; the first measures its size.
    pub fn named_parameters(self) -> &'static [Named] {
        EffectForm::from(self).named_parameters()
    }

    /// Parameters of the default form as they are searched.
    pub fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        EffectForm::from(self).parameters(reach)
    }

    /// How many parameters of the default form are searched.
    #[inline]
    pub fn searched_count(self) -> usize {
        EffectForm::from(self).searched_count()
    }

    /// Points from which a search of the default form starts; empty where logs of this reach cannot show the effect.
    pub fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        EffectForm::from(self).starts(reach)
    }

    /// Puts the default form on a chain; `bare_kg_m2` is the inertia of the bare link.
    #[inline]
    pub fn apply<T: Real>(self, values: &[T], bare_kg_m2: T, chain: &mut Chain<T>) {
        EffectForm::from(self).apply(values, bare_kg_m2, chain);
    }

    /// Whether motor side and link move apart with it: such a motion takes many short steps.
    pub(crate) fn parts_two_bodies(self) -> bool {
        matches!(self, EffectId::Backlash | EffectId::Compliance)
    }

    /// The default form's values under the catalogue's names, of the values as they are searched.
    pub fn named(self, values: &[f64], coulomb_nm: f64) -> Vec<f64> {
        EffectForm::from(self).named(values, coulomb_nm)
    }

    /// The default form's values as they are searched, of the catalogue's.
    pub fn searched(self, named: &[f64], coulomb_nm: f64) -> Vec<f64> {
        EffectForm::from(self).searched(named, coulomb_nm)
    }
}

impl EffectForm {
    /// How many parameters are searched.
    #[inline]
    pub fn searched_count(self) -> usize {
        self.named_parameters().len()
    }

    /// Whether it is the form of its family that is tried first.
    pub fn is_default(self) -> bool {
        self.form == 0
    }

    /// Where a refit of this form starts, given fitted values of another form of its family, both as they are searched:
    /// parameters of a form begin with those of the default one.
    pub fn from_other(self, other_values: &[f64], reach: &Reach) -> Vec<f64> {
        let default_values = &other_values[..self.id.searched_count()];
        let mut values =
            if self.is_default() { default_values.to_vec() } else { self.near_default(default_values, reach) };
        for (value, p) in values.iter_mut().zip(self.parameters(reach)) {
            *value = value.clamp(p.lower, p.upper);
        }
        values
    }

    /// The form of a family with a name, or the default one where none is given.
    ///
    /// # Errors
    /// [`UnknownEffect`] where the family has no such form.
    pub fn named_so(id: EffectId, form: Option<&str>) -> Result<Self, UnknownEffect> {
        let Some(name) = form else { return Ok(id.into()) };
        id.forms().find(|form| form.name() == name).ok_or_else(|| UnknownEffect {
            word: format!("{id}:{name}"),
            known: id.forms().map(|form| form.to_string()).collect::<Vec<_>>().join(", "),
        })
    }
}

impl From<EffectId> for EffectForm {
    #[inline]
    fn from(id: EffectId) -> Self {
        Self { id, form: 0 }
    }
}

/// `id`, or `id:form` where the family has several.
impl fmt::Display for EffectForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name() {
            "" => f.write_str(self.id.id()),
            name => write!(f, "{}:{name}", self.id),
        }
    }
}

impl FromStr for EffectForm {
    type Err = UnknownEffect;

    fn from_str(word: &str) -> Result<Self, UnknownEffect> {
        match word.split_once(':') {
            Some((id, form)) => Self::named_so(id.parse()?, Some(form)),
            None => Ok(word.parse::<EffectId>()?.into()),
        }
    }
}

impl fmt::Display for EffectId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

impl Serialize for EffectId {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.id())
    }
}

/// A word that is no effect's id.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{word}` is not an effect; the catalogue has {known}")]
pub struct UnknownEffect {
    /// As the user wrote it.
    pub word: String,
    /// All ids.
    pub known: String,
}

impl FromStr for EffectId {
    type Err = UnknownEffect;

    fn from_str(word: &str) -> Result<Self, UnknownEffect> {
        Self::ALL.iter().copied().find(|e| e.id() == word).ok_or_else(|| UnknownEffect {
            word: word.to_owned(),
            known: Self::ALL.iter().map(|e| e.id()).collect::<Vec<_>>().join(", "),
        })
    }
}
