//! Which robot a made study is of, and what it does.

use crate::blind::dice::Dice;
use crate::log::RobotScenario;

/// What a made study's logs are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// A quadruped walks, its trunk clamped.
    Air,
    /// It walks on a floor.
    Floor,
    /// One of its joints is let go, the trunk clamped.
    Drop,
    /// An arm that is made at random, on a fixed base, follows setpoints.
    Arm,
}

impl Setting {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Air, Self::Floor, Self::Drop, Self::Arm];

    /// The word in reports, JSON and on the command line.
    pub fn word(self) -> &'static str {
        self.scenario().map_or("arm", RobotScenario::word)
    }

    /// A quadruped's scenario.
    pub(super) fn scenario(self) -> Option<RobotScenario> {
        match self {
            Self::Air => Some(RobotScenario::Air),
            Self::Floor => Some(RobotScenario::Floor),
            Self::Drop => Some(RobotScenario::Drop),
            Self::Arm => None,
        }
    }

    /// Of a hundred studies 45 are in the air, 20 on the floor, 10 drops, 25 of arms.
    pub(super) fn draw(dice: &mut Dice) -> Self {
        match dice.uniform(0.0, 1.0) {
            x if x < 0.45 => Self::Air,
            x if x < 0.65 => Self::Floor,
            x if x < 0.75 => Self::Drop,
            _ => Self::Arm,
        }
    }
}
