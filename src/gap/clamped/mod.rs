//! The gap of any robot with a clamped base, joint by joint.
//!
//! Along the measured motion of all joints each of them is the pendulum of the bench with an inertia and a load that time
//! changes ([`Carriage`](crate::joint::Carriage)): the same kernel, fit, search and decision serve it. A joint answers for
//! its own fault and not for its neighbour's.

mod alike;
mod along;
mod answer;
mod body;
mod case;
mod diagnose;
mod followed;
mod in_common;
mod named;
mod pooled;
mod setup;
#[cfg(test)]
pub(super) mod tests;

pub use super::BodyKind;
pub use answer::JointAnswer;
pub(super) use body::{BELIEVED, BODY_OPEN};
pub use body::{BodyCause, BodyName};
pub use case::{ClampedCase, ClampedJoint};
pub use diagnose::{ClampedAnswer, ClampedDiagnosis, ClampedGap, SharedCause, diagnose_clamped};
pub(super) use diagnose::{concluded, concluded_of, diagnose_joints};
pub(super) use followed::SimulatedMotion;
pub(super) use in_common::Common;
pub use named::{NamedCause, NoSuchCause};
pub use pooled::PooledNumber;
pub use setup::{ClampedCaseError, ClampedSetup};
