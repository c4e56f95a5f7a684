//! The gap of a whole robot: where it lies, which cause, how far it closes.
//!
//! A robot study says what its engineer believes; logs of all joints say what the robot did. [`diagnose_robot`] simulates
//! the robot as given, then with every cause on every joint, pair or set of joints that may have it, refits what comes
//! near in full, and weighs hypotheses on gait cycles that no fit saw.
//!
//! Masses, friction and floor of a real robot are off by some percent everywhere. With the trunk clamped these numbers are
//! fitted beside every hypothesis; on the floor what they do is part of the noise, by robots drawn at random, for there any
//! change makes feet land a little differently.

mod attained;
mod attribute;
mod beliefs;
mod believed;
mod bench;
mod case;
mod cause;
mod column;
mod comes_back;
mod decide;
mod diagnose;
mod diagnosis;
mod forward;
mod glance;
mod hold_scan;
mod layout;
mod limbs;
mod map;
mod measure;
mod next;
mod noise;
mod numbers;
mod part;
mod phases;
mod place;
mod rank;
mod reach;
mod refine;
mod scatter;
mod screen;
mod sentence;
mod settle;
mod standing;
mod start;
mod still;
mod suspects;
#[cfg(test)]
mod tests;
mod torque;
mod tried;
mod unseen;

pub use case::RobotCase;
pub use cause::{Cause, Change, RobotStage, UnknownCause};
pub use diagnose::{RobotGapError, diagnose_robot};
pub use diagnosis::{
    Displacement, Found, GaitCell, GaitPhase, JointGap, JointTrace, RobotAnswer, RobotCandidate, RobotDetectable,
    RobotDiagnosis, RobotGap, RobotOptions, RobotWhere,
};
pub use forward::motion_with;
pub use place::Place;
