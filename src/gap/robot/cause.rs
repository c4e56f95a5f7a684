//! What may be wrong with a robot: any effect of the joint catalogue, a joint's friction, a payload, the floor.

use super::place::Place;
use crate::joint::EffectId;
use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// A cause of a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Cause {
    /// An effect of the joint catalogue.
    Effect(EffectId),
    /// Coulomb friction other than the study's: a matter of calibration.
    Coulomb,
    /// Viscous friction other than the study's: a matter of calibration.
    Viscous,
    /// A mass on the trunk that the study does not know.
    Payload,
    /// Another friction of the floor; its static friction grows alike.
    FloorFriction,
    /// A floor that is not level.
    FloorSlope,
    /// Another stiffness of the floor.
    FloorStiffness,
}

/// Where on the robot a cause acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotStage {
    /// A stage of a joint's chain.
    Joint(crate::joint::Stage),
    /// The floor.
    Floor,
    /// The trunk.
    Trunk,
}

impl RobotStage {
    /// The word in reports and JSON.
    pub fn name(self) -> &'static str {
        match self {
            RobotStage::Joint(stage) => stage.name(),
            RobotStage::Floor => "floor",
            RobotStage::Trunk => "trunk",
        }
    }
}

impl Serialize for RobotStage {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl Cause {
    /// Those that are on no joint.
    pub const OF_ROBOT: [Cause; 4] = [Cause::Payload, Cause::FloorFriction, Cause::FloorSlope, Cause::FloorStiffness];

    /// All of them.
    pub fn all() -> impl Iterator<Item = Cause> {
        let known = EffectId::ALL.iter().copied().filter(|effect| effect.is_known_to_robots());
        let effects = known.map(Cause::Effect);
        effects.chain([Cause::Coulomb, Cause::Viscous]).chain(Cause::OF_ROBOT)
    }

    /// The word in reports and JSON.
    pub fn id(self) -> &'static str {
        match self {
            Cause::Effect(effect) => effect.id(),
            Cause::Coulomb => "coulomb",
            Cause::Viscous => "viscous",
            Cause::Payload => "payload",
            Cause::FloorFriction => "floor_friction",
            Cause::FloorSlope => "floor_slope",
            Cause::FloorStiffness => "floor_stiffness",
        }
    }

    /// Whether it is on no joint.
    pub fn is_of_robot(self) -> bool {
        Cause::OF_ROBOT.contains(&self)
    }

    /// Whether it is a number of the study that is off.
    pub fn is_calibration(self) -> bool {
        matches!(self, Cause::Coulomb | Cause::Viscous)
    }

    /// Whether it is free play, in which a joint hunts: its simulation takes short steps and time.
    pub(super) fn is_play(self) -> bool {
        self == Cause::Effect(EffectId::Backlash)
    }

    /// Whether the motor's torque jumps or bends at a threshold, which long steps meet late.
    pub(super) fn jumps(self) -> bool {
        use EffectId::{DeadBand, SpeedLimit, TorqueLimit};
        [DeadBand, SpeedLimit, TorqueLimit].into_iter().any(|effect| self == Cause::Effect(effect))
    }

    /// Where it acts.
    pub fn stage(self) -> RobotStage {
        use crate::joint::Stage;
        match self {
            Cause::Effect(effect) => RobotStage::Joint(effect.stage()),
            Cause::Coulomb | Cause::Viscous => RobotStage::Joint(Stage::Link),
            Cause::Payload => RobotStage::Trunk,
            Cause::FloorFriction | Cause::FloorSlope | Cause::FloorStiffness => RobotStage::Floor,
        }
    }

    /// Names and units of its values.
    pub fn named(self) -> Vec<(&'static str, &'static str)> {
        match self {
            Cause::Effect(effect) => effect.named_parameters().iter().map(|p| (p.name, p.unit)).collect(),
            Cause::Coulomb => vec![("mu_c", "N m")],
            Cause::Viscous => vec![("mu_v", "N m s/rad")],
            Cause::Payload => vec![("mass", "kg"), ("right", "m"), ("rear", "m")],
            Cause::FloorFriction => vec![("mu", "")],
            Cause::FloorSlope => vec![("forward", "rad"), ("right", "rad")],
            Cause::FloorStiffness => vec![("stiffness", "N/m")],
        }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

impl Serialize for Cause {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.id())
    }
}

/// A word that is no cause.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{word}` is not an effect; a joint or a robot may have {known}")]
pub struct UnknownCause {
    /// As the user wrote it.
    pub word: String,
    /// All ids.
    pub known: String,
}

impl FromStr for Cause {
    type Err = UnknownCause;

    fn from_str(word: &str) -> Result<Self, UnknownCause> {
        // Effects that only a joint of its own can have are causes too; a robot's diagnosis does not try them.
        let of_joints = EffectId::ALL.iter().copied().map(Cause::Effect);
        let known: Vec<Cause> = of_joints.chain(Cause::all().filter(|c| !matches!(c, Cause::Effect(_)))).collect();
        known.iter().copied().find(|cause| cause.id() == word).ok_or_else(|| UnknownCause {
            word: word.to_owned(),
            known: known.iter().map(|cause| cause.id()).collect::<Vec<_>>().join(", "),
        })
    }
}

/// A cause on some joints, with its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// What is the matter.
    pub cause: Cause,
    /// With which joints.
    pub place: Place,
    /// Under the names of [`Cause::named`], in SI units.
    pub values: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_read_back() {
        for cause in Cause::all() {
            assert_eq!(cause.id().parse::<Cause>(), Ok(cause));
            assert!(!cause.named().is_empty(), "{cause}");
        }
        assert!("gremlins".parse::<Cause>().unwrap_err().to_string().contains("floor_slope"));
    }
}
