//! A robot moved through time: what its logs would look like.
//!
//! - [`Joints`]: the chain of `joint` on every joint of the tree: setpoint path, controller, motor, friction, springs,
//!   stops, encoder, and any effect of the catalogue on any joint.
//! - [`Setpoints`]: what is asked of the joints, as a table over time.
//! - [`Scenario`]: model, joints, setpoints, start and [`Surroundings`]: the problem, which no run changes.
//! - [`Method`]: how to step. [`run`] answers with a [`Recording`]: samples at the sensors' period, what it cost, joints
//!   beyond their speed limits, and where and why the motion diverged if it did.
//! - [`follow()`] and [`Walked`]: what a recording says of joints and of a walk.
//!
//! The controllers' derivative gains make joints of 1e-6 kg m^2 as fast as 1.5e6 1/s, so no method takes them along
//! explicitly. [`Method::Stiff`] solves `(M + g h B + (g h)^2 K) a = ...` with the joints' own damping B and stiffness K
//! and lets joints stick truly; the others are those of [`integrate`](crate::integrate), with friction made smooth and
//! rates that their step cannot follow slowed down to what it can.

mod bend;
mod commands;
mod error;
mod events;
mod follow;
mod following;
mod joints;
mod log;
mod places;
mod recording;
mod run;
mod scenario;
mod sensor;
mod setpoints;
mod side;
mod smooth;
mod stiff;
mod sweep;
mod terms;
#[cfg(test)]
mod tests;
mod walked;
mod world;

pub use error::SimulateError;
pub use follow::{Follow, follow};
pub use joints::{Control, JointDrive, Joints};
pub use log::{log_csv, readings};
pub use recording::{BaseSample, Diverged, Recording, SpeedWarning};
pub use run::{Method, run};
pub use scenario::{External, Scenario, Still, Surroundings};
pub(crate) use sensor::standard_normal;
pub use sensor::{Accelerometer, PositionSensor};
pub use setpoints::{Column, Setpoints};
pub use sweep::{SweepPoint, Swept, sweep};
pub use walked::{Footfalls, TrunkCurves, Walked, distortion_rad, tilt_rad};
