//! The gap of a robot with a clamped base, told by torques: what the measured motion asks for against what the drives gave.
//!
//! Along a measured motion `tau = inertial(q, q', q'') + gravity(q) + armature q'' + friction`, which is linear in nearly
//! every number and every size of an effect: least squares under what the study believes of them, causes grown and pruned by
//! what they predict of logs that were not fitted. Both sides pass the same low pass; at rest friction is only bounded. It is
//! the comparison for arms whose simulation diverges, and says nothing of what a setpoint becomes.

mod answer;
mod bench;
mod bodies;
mod body_fit;
mod case;
mod design;
mod diagnose;
mod low_pass;
mod motion;
mod numbers;
mod parameters;
mod rounds;
mod search;
mod signals;
mod study;
mod sure;
mod system;
mod weigh;

pub use answer::TorqueTraces;
pub use case::TorqueCase;
pub use diagnose::{TorqueDiagnosis, TorqueError, diagnose_torques};
pub use motion::diagnose_motion;
pub use study::{ClampedFound, diagnose_setup};
