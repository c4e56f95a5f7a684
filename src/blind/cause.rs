//! What may be behind a gap: nothing, wrong numbers, effects of the catalogue, or something that it does not have.

use crate::gap::Variable;
use crate::joint::{EffectId, Stage};
use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// The cause of a made study.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The nominal model is right, but for what the study says that it may be off.
    Nothing,
    /// Numbers are wrong by more than the study says.
    Calibration,
    /// Effects of the catalogue, all at once.
    Effects(Vec<EffectId>),
    /// A servo: a motor fed by voltage, a dead band, friction by load and speed, a delay.
    Servo,
    /// A mechanism that the catalogue does not have.
    Outside(OutsideId),
}

macro_rules! outside {
    ($($(#[$doc:meta])* $name:ident, $id:literal, $stage:ident, [$($variable:ident),*];)*) => {
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

            /// What it depends on: any of these is a right answer.
            pub fn variables(self) -> &'static [Variable] {
                match self { $(OutsideId::$name => &[$(Variable::$variable),*],)* }
            }
        }
    };
}

outside! {
    /// A torque that swings several times per turn.
    Cogging, "cogging", Gearing, [Angle];
    /// Friction that gives way over a large angle before it slips.
    SoftPresliding, "soft_presliding", Link, [Direction, Amplitude, Speed];
    /// A reading that deviates several times per turn.
    EncoderHarmonic, "encoder_harmonic", Sensor, [Angle];
    /// Friction that follows the speed late.
    FrictionMemory, "friction_memory", Link, [Speed, Direction, Time];
    /// Friction that changes at an instant.
    FrictionJump, "friction_jump", Link, [Time, Direction];
    /// The base tilts to and fro.
    BaseSway, "base_sway", Link, [Time];
    /// The motor gets weaker along a log.
    SupplySag, "supply_sag", Motor, [Time, Torque];
    /// Viscous friction that varies over a turn.
    AngleViscous, "angle_viscous", Link, [Angle, Speed];
    /// A magnet beside the link.
    MagneticDetent, "magnetic_detent", Link, [Angle];
    /// A cable that springs and slips.
    HystereticSpring, "hysteretic_spring", Link, [Direction, Amplitude, Angle];
    /// Somebody knocks against the link now and then.
    Knocks, "knocks", Link, [Time];
    /// The encoder's zero wanders along a log.
    EncoderDrift, "encoder_drift", Sensor, [Time];
    /// The motor's torque swings over its turn.
    TorqueRipple, "torque_ripple", Motor, [Angle, Torque];
    /// The proportional gain grows with the error.
    ProgressiveGain, "progressive_gain", Controller, [Torque, SetpointRate];
    /// The controller integrates its error, and the study does not say so.
    HiddenIntegral, "hidden_integral", Controller, [Torque, Load, Time];
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

/// Effects that only a driven log can show.
pub(super) fn needs_motor(effect: EffectId) -> bool {
    effect.is_driven_only()
}

impl Cause {
    /// Whether a study of this cause needs driven logs to show it.
    pub(super) fn needs_motor(&self) -> bool {
        match self {
            Cause::Nothing | Cause::Calibration => false,
            Cause::Effects(effects) => effects.iter().any(|effect| needs_motor(*effect)),
            Cause::Servo => true,
            Cause::Outside(id) => matches!(
                id,
                OutsideId::SupplySag | OutsideId::TorqueRipple | OutsideId::ProgressiveGain | OutsideId::HiddenIntegral
            ),
        }
    }

    /// Whether an effect is part of it.
    pub(super) fn has(&self, effect: EffectId) -> bool {
        matches!(self, Cause::Effects(effects) if effects.contains(&effect))
    }
}

/// Most effects at once.
pub(super) const MOST_EFFECTS: usize = 4;
/// Words for so many effects at once, from one on.
const COUNTS: [&str; MOST_EFFECTS] = ["effect", "pair", "three", "four"];

/// Which causes are drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CauseFilter {
    /// The kind is drawn at random.
    Any,
    /// So many effects of the catalogue, one to four.
    Effects(usize),
    /// Anything that the catalogue does not have.
    AnyOutside,
    /// Just this.
    Only(Cause),
}

/// A word that names no cause.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is no cause; write any, none, calibration, {counts}, servo, outside, an effect's id, two to four different \
     ids joined by +, or one of {outside}",
    counts = COUNTS.join(", "),
    outside = OutsideId::ALL.iter().map(|o| o.id()).collect::<Vec<_>>().join(", ")
)]
pub struct UnknownCause(String);

impl FromStr for CauseFilter {
    type Err = UnknownCause;

    fn from_str(word: &str) -> Result<Self, UnknownCause> {
        let unknown = || UnknownCause(word.to_owned());
        let cause = match word {
            "any" => return Ok(CauseFilter::Any),
            "outside" => return Ok(CauseFilter::AnyOutside),
            "none" => Cause::Nothing,
            "calibration" => Cause::Calibration,
            "servo" => Cause::Servo,
            _ => {
                if let Some(count) = COUNTS.iter().position(|name| *name == word) {
                    return Ok(CauseFilter::Effects(count + 1));
                }
                if let Some(id) = OutsideId::ALL.iter().find(|id| id.id() == word) {
                    return Ok(CauseFilter::Only(Cause::Outside(*id)));
                }
                let mut effects: Vec<EffectId> = Vec::new();
                for id in word.split('+') {
                    let effect = id.trim().parse().map_err(|_| unknown())?;
                    if effects.contains(&effect) || effects.len() == MOST_EFFECTS {
                        return Err(unknown());
                    }
                    effects.push(effect);
                }
                Cause::Effects(effects)
            }
        };
        Ok(CauseFilter::Only(cause))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_are_read_from_words() {
        let only = |effects: &[EffectId]| Ok(CauseFilter::Only(Cause::Effects(effects.to_vec())));
        assert_eq!("any".parse(), Ok(CauseFilter::Any));
        assert_eq!("three".parse(), Ok(CauseFilter::Effects(3)));
        assert_eq!("servo".parse(), Ok(CauseFilter::Only(Cause::Servo)));
        assert_eq!("delay".parse(), only(&[EffectId::Delay]));
        assert_eq!("cogging".parse(), Ok(CauseFilter::Only(Cause::Outside(OutsideId::Cogging))));
        assert_eq!("delay+stribeck".parse(), only(&[EffectId::Delay, EffectId::Stribeck]));
        let five = "delay+stribeck+backlash+joint_spring+motor_gain";
        for wrong in ["", "delay+delay", "gremlins", "delay+gremlins", five] {
            let error = wrong.parse::<CauseFilter>().unwrap_err().to_string();
            assert!(error.contains("knocks"), "{error}");
        }
    }
}
