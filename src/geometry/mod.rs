//! Layer 2: geometry. What are the moment of inertia and the gravity torque of a leg that swings about one of its
//! joints?
//!
//! - [`tables`]: the ERS-7 as data (Tables A.1, A.2, 3.3, 3.4), embedded from `data/ers7.toml`.
//! - [`inertia`]: ellipsoids (3.1), hollow cylinders (3.8), parallel axes (3.9), rotation of tensors.
//!
//! Left out: whole-robot kinematics (the robot layer builds its tree from the same tables), bodies whose centre of
//! mass is not their geometric centre.

pub mod error;
pub mod inertia;
pub mod leg;
pub mod tables;

pub use error::GeometryError;
pub use leg::{Leg, LegJoint, LegPose, joint_name, level_gravity};
pub use tables::{Axis, Ers7Tables, FrictionTables, Joint, LegFriction, Part};
