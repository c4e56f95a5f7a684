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

            /// Its parameters under the catalogue's names; the first measures its size.
            pub fn named_parameters(self) -> &'static [Named] {
                match self { $(EffectId::$effect => super::$module::Term::NAMED,)* }
            }

            /// Its parameters as they are searched.
            pub fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
                match self { $(EffectId::$effect => super::$module::Term::parameters(reach),)* }
            }

            /// How many parameters are searched.
            #[inline]
            pub fn searched_count(self) -> usize {
                match self { $(EffectId::$effect => super::$module::Term::NAMED.len(),)* }
            }

            /// Points from which a search starts; empty where logs of this reach cannot show the effect.
            pub fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
                match self { $(EffectId::$effect => super::$module::Term::starts(reach),)* }
            }

            /// Puts the effect on a chain; `bare_kg_m2` is the inertia of the bare link.
            #[inline]
            pub fn apply<T: Real>(self, values: &[T], bare_kg_m2: T, chain: &mut Chain<T>) {
                match self { $(EffectId::$effect => super::$module::Term::apply(values, bare_kg_m2, chain),)* }
            }

            /// The values under the catalogue's names, of the values as they are searched.
            pub fn named(self, values: &[f64], coulomb_nm: f64) -> Vec<f64> {
                match self { $(EffectId::$effect => super::$module::Term::named(values, coulomb_nm),)* }
            }

            /// The values as they are searched, of the catalogue's.
            pub fn searched(self, named: &[f64], coulomb_nm: f64) -> Vec<f64> {
                match self { $(EffectId::$effect => super::$module::Term::searched(named, coulomb_nm),)* }
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
    /// A parallel spring.
    JointSpring, joint_spring, Link;
    /// A stop inside the range of motion.
    EndStop, end_stop, Link;
    /// The encoder's zero, or the direction of the centre of mass.
    AngleOffset, angle_offset, Sensor;
    /// The encoder's gain.
    SensorGain, sensor_gain, Sensor;
    /// The setpoint acts late.
    Delay, delay, Delay;
    /// The setpoint is taken over only every so often.
    SetpointHold, setpoint_hold, Setpoint;
    /// The motor's torque saturates.
    TorqueLimit, torque_limit, Motor;
    /// The motor's torque falls with speed.
    SpeedLimit, speed_limit, Motor;
    /// The motor delivers more or less than commanded.
    MotorGain, motor_gain, Motor;
}

impl EffectId {
    /// Whether only a motor that is on can show it.
    pub fn is_driven_only(self) -> bool {
        use EffectId::{Delay, GearFriction, MotorGain, SetpointHold, SpeedLimit, TorqueLimit};
        matches!(self, GearFriction | Delay | SetpointHold | TorqueLimit | SpeedLimit | MotorGain)
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
