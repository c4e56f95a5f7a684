//! Layer 2: geometry. What are the moment of inertia and the gravity torque of a leg that swings about one of its
//! joints?
//!
//! - [`robot_file`]: reads a robot of any kind from a file in the format of `data/ers7.toml`.
//! - [`tables`]: the ERS-7 as data (Tables A.1 to A.3, 3.3, 3.4), embedded from `data/ers7.toml`.
//! - [`inertia`]: ellipsoids (3.1), hollow cylinders (3.8), parallel axes (3.9), rotation of tensors.
//! - [`lump`](mod@lump): shoulder, upper leg, lower leg and extra mass as one pendulum about q1, q2 or q3 (3.10),
//!   exactly, at any pose of the other joints and any direction of gravity.
//! - [`straight`]: the thesis's own simplification (3.8-3.10), all bodies on one line.
//!
//! Left out: whole-robot kinematics (the robot layer builds its tree from the same tables), bodies whose centre of
//! mass is not their geometric centre.

pub mod error;
pub mod inertia;
pub mod leg;
pub mod lump;
pub mod robot_file;
pub mod straight;
pub mod tables;

#[cfg(test)]
mod lump_tests;

pub use error::GeometryError;
pub use leg::{Leg, LegJoint, LegPose, joint_name, level_gravity};
pub use lump::{BodyLump, LinkBody, LumpedLink, Mounted, lump};
pub use robot_file::RobotTables;
pub use straight::straight_leg;
pub use tables::{Ers7Tables, FrictionTables, Joint, JointSpring, LegFriction, Part};
