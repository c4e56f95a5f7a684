//! What may be behind a gap: nothing, wrong numbers, effects of the catalogue, or something that it does not have.

use crate::joint::{EffectId, Stage};
use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// The cause of a made study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The nominal model is right.
    Nothing,
    /// One to four of the four numbers are wrong.
    Calibration,
    /// One effect of the catalogue.
    One(EffectId),
    /// Two effects of the catalogue.
    Two(EffectId, EffectId),
    /// A mechanism that the catalogue does not have.
    Outside(OutsideId),
}

macro_rules! outside {
    ($($(#[$doc:meta])* $name:ident, $id:literal, $stage:ident;)*) => {
        /// A mechanism that the catalogue does not have.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum OutsideId { $($(#[$doc])* $name,)* }

        impl OutsideId {
            /// All of them.
            pub const ALL: &'static [OutsideId] = &[$(OutsideId::$name,)*];

            /// Its id, e.g. `cogging`.
            pub fn id(self) -> &'static str {
                match self { $(OutsideId::$name => $id,)* }
            }

            /// The stage of the chain on which it sits.
            pub fn stage(self) -> Stage {
                match self { $(OutsideId::$name => Stage::$stage,)* }
            }
        }
    };
}

outside! {
    /// A torque that swings several times per turn.
    Cogging, "cogging", Gearing;
    /// A spring between motor and link.
    FlexibleJoint, "flexible_joint", Gearing;
    /// Friction that gives way over a large angle before it slips.
    SoftPresliding, "soft_presliding", Link;
    /// A reading that deviates several times per turn.
    EncoderHarmonic, "encoder_harmonic", Sensor;
    /// Friction that follows the speed late.
    FrictionMemory, "friction_memory", Link;
    /// Friction that changes at an instant.
    FrictionJump, "friction_jump", Link;
    /// The base tilts to and fro.
    BaseSway, "base_sway", Link;
    /// The motor gets weaker along a log.
    SupplySag, "supply_sag", Motor;
    /// The controller ignores small errors.
    DeadZone, "dead_zone", Controller;
    /// The controller's setpoint follows at a limited rate.
    SetpointSlew, "setpoint_slew", Setpoint;
    /// Viscous friction that varies over a turn.
    AngleViscous, "angle_viscous", Link;
    /// A magnet beside the link.
    MagneticDetent, "magnetic_detent", Link;
    /// A cable that springs and slips.
    HystereticSpring, "hysteretic_spring", Link;
    /// Somebody knocks against the link now and then.
    Knocks, "knocks", Link;
}

impl fmt::Display for OutsideId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

impl Serialize for OutsideId {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.id())
    }
}

/// Effects that this exam's simulator makes by the catalogue's definition.
pub(super) fn simulable() -> Vec<EffectId> {
    use EffectId::*;
    let beyond = [Compliance, SensorDelay, SetpointProfile, DeadBand];
    EffectId::ALL.iter().copied().filter(|effect| !beyond.contains(effect)).collect()
}

/// Effects that only a driven log can show.
pub(super) fn needs_motor(effect: EffectId) -> bool {
    effect.is_driven_only()
}

impl Cause {
    /// Whether a study of this cause needs driven logs to show it.
    pub(super) fn needs_motor(self) -> bool {
        match self {
            Cause::Nothing | Cause::Calibration => false,
            Cause::One(effect) => needs_motor(effect),
            Cause::Two(first, second) => needs_motor(first) || needs_motor(second),
            Cause::Outside(id) => {
                matches!(id, OutsideId::SupplySag | OutsideId::DeadZone | OutsideId::SetpointSlew)
            }
        }
    }
}

/// Which causes are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CauseFilter {
    /// The kind is drawn at random.
    Any,
    /// Nothing is missing.
    Nothing,
    /// Wrong numbers only.
    Calibration,
    /// Any one effect of the catalogue.
    AnyEffect,
    /// Any two effects of different kinds.
    AnyPair,
    /// Anything that the catalogue does not have.
    AnyOutside,
    /// Just this.
    Only(Cause),
}

/// A word that names no cause.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is no cause; write any, none, calibration, effect, pair, outside, an effect's id, two ids joined by +, \
     or one of {outside}",
    outside = OutsideId::ALL.iter().map(|o| o.id()).collect::<Vec<_>>().join(", ")
)]
pub struct UnknownCause(String);

impl FromStr for CauseFilter {
    type Err = UnknownCause;

    fn from_str(word: &str) -> Result<Self, UnknownCause> {
        let unknown = || UnknownCause(word.to_owned());
        let effect = |word: &str| match word.trim().parse::<EffectId>() {
            Ok(effect) if simulable().contains(&effect) => Ok(effect),
            _ => Err(unknown()),
        };
        Ok(match word {
            "any" => CauseFilter::Any,
            "none" => CauseFilter::Nothing,
            "calibration" => CauseFilter::Calibration,
            "effect" => CauseFilter::AnyEffect,
            "pair" => CauseFilter::AnyPair,
            "outside" => CauseFilter::AnyOutside,
            _ => {
                if let Some(id) = OutsideId::ALL.iter().find(|id| id.id() == word) {
                    CauseFilter::Only(Cause::Outside(*id))
                } else if let Some((first, second)) = word.split_once('+') {
                    let (first, second) = (effect(first)?, effect(second)?);
                    if first == second {
                        return Err(unknown());
                    }
                    CauseFilter::Only(Cause::Two(first, second))
                } else {
                    CauseFilter::Only(Cause::One(effect(word)?))
                }
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_are_read_from_words() {
        assert_eq!("any".parse(), Ok(CauseFilter::Any));
        assert_eq!("delay".parse(), Ok(CauseFilter::Only(Cause::One(EffectId::Delay))));
        assert_eq!("cogging".parse(), Ok(CauseFilter::Only(Cause::Outside(OutsideId::Cogging))));
        let pair = Cause::Two(EffectId::Delay, EffectId::Stribeck);
        assert_eq!("delay+stribeck".parse(), Ok(CauseFilter::Only(pair)));
        for wrong in ["", "delay+delay", "gremlins", "delay+gremlins"] {
            let error = wrong.parse::<CauseFilter>().unwrap_err().to_string();
            assert!(error.contains("knocks"), "{error}");
        }
    }
}
