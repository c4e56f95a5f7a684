//! The gap of any robot with a clamped base, joint by joint.
//!
//! Along the measured motion of all joints each of them is the pendulum of the bench with an inertia and a load that time
//! changes ([`Carriage`](crate::joint::Carriage)): the same kernel, fit, search and decision serve it. A joint answers for
//! its own fault and not for its neighbour's.

mod along;
mod case;
mod diagnose;
#[cfg(test)]
mod tests;

pub use case::{ClampedCase, ClampedCaseError, ClampedJoint};
pub use diagnose::{ClampedAnswer, ClampedDiagnosis, ClampedGap, JointAnswer, SharedCause, diagnose_clamped};
