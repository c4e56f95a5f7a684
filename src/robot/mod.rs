//! Layer 6: the whole robot as a tree of rigid bodies on revolute joints. Which accelerations do torques and forces
//! give, and which torques does a motion need?
//!
//! - [`Model`]: the robot, immutable: bodies, joints, limits, gains, friction, springs. Read from a file in the format
//!   of `data/ers7.toml`; nothing here knows the ERS-7.
//! - [`State`]: where it is and how it moves.
//! - [`Dynamics`]: the working memory of one evaluation at a time. Forward dynamics by the articulated-body algorithm
//!   (Featherstone 2008, chapter 7), inverse dynamics by recursive Newton-Euler (chapter 5), the mass matrix by
//!   composite rigid bodies (chapter 6), energies, momentum, places and velocities.
//! - [`LanesDynamics`]: forward dynamics of many robots at once, the same bits for each.
//! - [`Floor`]: what stands under it (eqs 2.3-2.6), with what an implicit step needs.
//! - [`Gait`]: what is asked of its joints (section 4.1).
//! - [`mod@bench`]: the drop test of 3.4 on the whole robot.
//! - [`description`]: robots that others described, as URDF or MJCF, and [`mod@tree`]: the dynamics of any of them.
//! - [`study`]: a robot study, and its logs as scenes of that.
//! - [`simulate`]: joints with controllers, motors, friction and effects on the tree, moved through time.
//!
//! Twists and wrenches (2.1, 2.2) are the inside of [`Dynamics`]; what it takes and gives is in world axes, or in
//! generalised coordinates:
//!
//! `v = [base linear velocity, world axes (3); base angular velocity, body axes (3); joint rates (n)]`, and
//! `M(q) dv/dt + bias(q, v) = [base wrench; tau] + J^T f`, gravity being in `bias`. A clamped base does not accelerate,
//! and the base wrench is what holds it; the coordinates stay the same.

pub mod bench;
mod contact;
pub mod description;
mod dynamics;
mod error;
mod gait;
mod model;
pub mod simulate;
mod spatial;
mod state;
pub mod study;
pub mod tree;

pub(crate) use contact::STEEPEST_RAD;
pub use contact::{Contact, Floor, FloorParameters, Resting, Touching};
pub use dynamics::{BodyMotion, ContactDamping, Dynamics, Energy, Force, Input, LanesDynamics, Momentum};
pub use error::RobotError;
pub use gait::{Between, Gait, Motion, Sampled, Setpoints};
pub use model::{Attached, Body, BodyId, Following, JointId, Model, PidGains, Touch};
pub use state::State;
pub use study::Nominal;
