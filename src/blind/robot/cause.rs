//! What may be the matter with a made robot.

use super::setting::Setting;
use crate::gap::robot::Cause;
use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// A fault that the catalogue does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum RobotOutside {
    /// A mass on one lower leg.
    Boot,
    /// The clamped trunk is not level, and nobody wrote it down.
    TiltedTrunk,
    /// Setpoints reach the controller in coarse steps of angle.
    CoarseSetpoints,
    /// Setpoints get lost now and then, for some frames.
    LostSetpoints,
    /// Setpoints pass a low-pass filter.
    SlowSetpoints,
    /// Friction that comes and goes many times a radian.
    Cogging,
    /// Friction under the motor's load that grows along the log.
    HotGear,
}

impl RobotOutside {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Boot,
        Self::TiltedTrunk,
        Self::CoarseSetpoints,
        Self::LostSetpoints,
        Self::SlowSetpoints,
        Self::Cogging,
        Self::HotGear,
    ];

    /// The word in reports and JSON.
    pub fn id(self) -> &'static str {
        match self {
            Self::Boot => "boot",
            Self::TiltedTrunk => "tilted_trunk",
            Self::CoarseSetpoints => "coarse_setpoints",
            Self::LostSetpoints => "lost_setpoints",
            Self::SlowSetpoints => "slow_setpoints",
            Self::Cogging => "cogging",
            Self::HotGear => "hot_gear",
        }
    }

    fn shows_in(self, setting: Setting) -> bool {
        match setting {
            Setting::Air => true,
            Setting::Floor => self != Self::TiltedTrunk,
            Setting::Drop => matches!(self, Self::Boot | Self::TiltedTrunk | Self::Cogging),
            // Of an arm a spec says all that is made.
            Setting::Arm => false,
        }
    }
}

impl fmt::Display for RobotOutside {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

impl Serialize for RobotOutside {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.id())
    }
}

/// What is the matter with a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotTrueCause {
    /// Nothing.
    Nothing,
    /// A cause of the catalogue.
    One(Cause),
    /// Two of them.
    Two(Cause, Cause),
    /// Something that the catalogue does not have.
    Outside(RobotOutside),
}

impl RobotTrueCause {
    /// Whether logs of a setting can show it.
    pub fn shows_in(self, setting: Setting) -> bool {
        let shows = |cause: Cause| match (cause, setting) {
            (cause, Setting::Air) => !cause.is_of_robot(),
            (_, Setting::Floor) => true,
            (Cause::Effect(effect), Setting::Drop) => !effect.is_driven_only(),
            (cause, Setting::Drop) => cause.is_calibration(),
            (cause, Setting::Arm) => cause == Cause::Payload || !cause.is_of_robot(),
        };
        match self {
            Self::Nothing => true,
            Self::One(cause) => shows(cause),
            Self::Two(first, second) => shows(first) && shows(second),
            Self::Outside(outside) => outside.shows_in(setting),
        }
    }
}

/// Which causes are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotFilter {
    /// The kind is drawn at random.
    Any,
    /// Nothing is missing.
    Nothing,
    /// A friction that is off.
    Calibration,
    /// Any one effect, payload or property of the floor.
    AnyEffect,
    /// Any two causes.
    AnyPair,
    /// Anything that the catalogue does not have.
    AnyOutside,
    /// Just this.
    Only(RobotTrueCause),
}

impl RobotFilter {
    /// Whether logs of a setting can show some cause of it.
    pub fn shows_in(self, setting: Setting) -> bool {
        match self {
            RobotFilter::Only(cause) => cause.shows_in(setting),
            _ => true,
        }
    }
}

/// A word that names no cause of a robot.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is no cause of a robot; write any, none, calibration, effect, pair, outside, a cause's id ({causes}), two ids \
     joined by +, or one of {outside}",
    causes = Cause::all().map(Cause::id).collect::<Vec<_>>().join(", "),
    outside = RobotOutside::ALL.map(RobotOutside::id).join(", ")
)]
pub struct UnknownRobotCause(String);

impl FromStr for RobotFilter {
    type Err = UnknownRobotCause;

    fn from_str(word: &str) -> Result<Self, UnknownRobotCause> {
        let unknown = || UnknownRobotCause(word.to_owned());
        let cause = |word: &str| word.trim().parse::<Cause>().map_err(|_| unknown());
        Ok(match word {
            "any" => RobotFilter::Any,
            "none" => RobotFilter::Nothing,
            "calibration" => RobotFilter::Calibration,
            "effect" => RobotFilter::AnyEffect,
            "pair" => RobotFilter::AnyPair,
            "outside" => RobotFilter::AnyOutside,
            _ => RobotFilter::Only(match RobotOutside::ALL.into_iter().find(|outside| outside.id() == word) {
                Some(outside) => RobotTrueCause::Outside(outside),
                None => match word.split_once('+') {
                    None => RobotTrueCause::One(cause(word)?),
                    Some((first, second)) if first.trim() != second.trim() => {
                        RobotTrueCause::Two(cause(first)?, cause(second)?)
                    }
                    Some(_) => return Err(unknown()),
                },
            }),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_of_a_robot_are_read_from_words() {
        let one = |cause| Ok(RobotFilter::Only(RobotTrueCause::One(cause)));
        assert_eq!("payload".parse(), one(Cause::Payload));
        assert_eq!("coulomb".parse(), one(Cause::Coulomb));
        assert_eq!("boot".parse(), Ok(RobotFilter::Only(RobotTrueCause::Outside(RobotOutside::Boot))));
        let two = RobotTrueCause::Two(Cause::FloorSlope, Cause::Viscous);
        assert_eq!("floor_slope+viscous".parse(), Ok(RobotFilter::Only(two)));
        for wrong in ["", "delay+delay", "gremlins"] {
            let error = wrong.parse::<RobotFilter>().unwrap_err().to_string();
            assert!(error.contains("payload") && error.contains("tilted_trunk"), "{error}");
        }
    }

    #[test]
    fn a_clamped_robot_shows_no_floor_and_a_free_joint_no_motor() {
        use crate::joint::EffectId;
        let shows = |word: &str, scenario| word.parse::<RobotFilter>().unwrap().shows_in(scenario);
        for (word, in_air, in_drop, in_arm) in [
            ("floor_slope", false, false, false),
            ("delay", true, false, true),
            ("boot", true, true, false),
            ("payload", false, false, true),
        ] {
            assert_eq!(shows(word, Setting::Air), in_air, "{word}");
            assert_eq!(shows(word, Setting::Drop), in_drop, "{word}");
            assert_eq!(shows(word, Setting::Arm), in_arm, "{word}");
            assert!(shows(word, Setting::Floor), "{word}");
        }
        let pair = RobotTrueCause::Two(Cause::Effect(EffectId::Delay), Cause::Payload);
        assert!(!pair.shows_in(Setting::Air) && pair.shows_in(Setting::Floor));
    }
}
