//! What can be wrong with a robot.

use super::description::DescriptionError;
use crate::log::LogError;

/// Errors of the robot layer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RobotError {
    /// The robot's file cannot be read, or is wrong.
    #[error(transparent)]
    File(#[from] LogError),
    /// A description that cannot be read.
    #[error(transparent)]
    Description(Box<DescriptionError>),
    /// A described robot that has what is not simulated.
    #[error("{robot}: {what}; `dynamics` answers for it all the same")]
    NotSimulated {
        /// The robot.
        robot: String,
        /// What it has.
        what: String,
    },
    /// A body that the robot does not have.
    #[error("{robot} has no body {name}; it has {}", bodies.join(", "))]
    NoBody {
        /// The robot.
        robot: String,
        /// The name that was looked for.
        name: String,
        /// The names that there are.
        bodies: Vec<String>,
    },
    /// A joint that the robot does not have.
    #[error("{robot} has no joint {name}; it has {}", joints.join(", "))]
    NoJoint {
        /// The robot.
        robot: String,
        /// The name that was looked for.
        name: String,
        /// The names that there are.
        joints: Vec<String>,
    },
    /// A mass, place or inertia that no body has.
    #[error("body {body}: {what} = {value}, allowed: {allowed}")]
    Value {
        /// The body.
        body: String,
        /// What is wrong.
        what: &'static str,
        /// What was given.
        value: f64,
        /// What may be given.
        allowed: &'static str,
    },
    /// A gait, or a set of amplitudes, that there is not.
    #[error("no {what} {name}; there are {}", known.join(", "))]
    NoGait {
        /// What was looked for.
        what: &'static str,
        /// Its name.
        name: String,
        /// The names that there are.
        known: Vec<String>,
    },
    /// A parameter that no floor has.
    #[error("floor: {what} = {value}, allowed: {allowed}")]
    Floor {
        /// The key in a study's `[floor]`.
        what: &'static str,
        /// What was given.
        value: f64,
        /// What may be given.
        allowed: &'static str,
    },
    /// An effect of the robot's file that the catalogue does not have so.
    #[error("{robot}: [[effect]] {place}: {what}")]
    Effect {
        /// The robot.
        robot: String,
        /// Which one of the file, from 1.
        place: usize,
        /// What is wrong, and what was expected.
        what: String,
    },
    /// A joint whose parent is neither the base nor moved by an earlier joint.
    #[error("joint {joint}: parent {parent} hangs on no earlier joint")]
    Order {
        /// The joint.
        joint: String,
        /// Its parent.
        parent: String,
    },
    /// Nothing resists a joint: its axis goes through all the mass it moves.
    #[error(
        "joint {joint}: what it moves has no inertia about its axis ({inertia_kg_m2:e} kg m^2), expected above 0; give \
         the bodies beyond it mass and size"
    )]
    NoInertia {
        /// The joint.
        joint: String,
        /// The inertia about its axis with all joints at 0.
        inertia_kg_m2: f64,
    },
}

impl From<DescriptionError> for RobotError {
    fn from(error: DescriptionError) -> Self {
        match error {
            DescriptionError::File(error) => Self::File(error),
            other => Self::Description(Box::new(other)),
        }
    }
}
