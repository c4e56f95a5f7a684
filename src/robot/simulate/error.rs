//! What can be wrong with a simulation before it starts.

use crate::geometry::GeometryError;
use crate::log::LogError;
use crate::robot::RobotError;
use std::path::PathBuf;

/// A scenario that cannot be.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulateError {
    /// The robot does not have a joint or body.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// A file cannot be read, or is wrong.
    #[error(transparent)]
    File(#[from] LogError),
    /// The robot's file has no such set of friction or gains.
    #[error("{robot} has no {kind} set `{name}`; its file gives them as [{kind}.NAME]")]
    NoSet {
        /// The robot.
        robot: String,
        /// `friction` or `gains`.
        kind: &'static str,
        /// The name that was looked for.
        name: String,
    },
    /// An effect's parameter is out of its bounds.
    #[error("joint {joint}: {effect}: {parameter} is {value}, expected {allowed}")]
    Effect {
        /// The joint.
        joint: String,
        /// The effect's id.
        effect: &'static str,
        /// Its parameter.
        parameter: &'static str,
        /// What was given.
        value: f64,
        /// What may be given.
        allowed: String,
    },
    /// An effect that single joints have and whole robots do not.
    #[error("joint {joint}: {effect} can be simulated on a single joint only, not on a robot")]
    UnknownToRobots {
        /// The joint.
        joint: String,
        /// The effect's id.
        effect: &'static str,
    },
    /// A number makes no sense.
    #[error("{what} is {value}, expected {allowed}")]
    Value {
        /// What is wrong.
        what: &'static str,
        /// What was given.
        value: f64,
        /// What may be given.
        allowed: &'static str,
    },
    /// A method that does not know an effect.
    #[error("joint {joint}: backlash is known to the stiff method only")]
    Backlash {
        /// The joint.
        joint: String,
    },
    /// The bench's geometry is impossible.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// A log or study that does not fit the robot.
    #[error("{}: {what}", file.display())]
    Unfit {
        /// The file.
        file: PathBuf,
        /// What is wrong in it, and what was expected.
        what: String,
    },
    /// A table of setpoints that cannot be.
    #[error("setpoints: {what}")]
    Setpoints {
        /// What is wrong, and where.
        what: String,
    },
}
