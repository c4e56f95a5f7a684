//! Layer 7b: logs from a known truth. What would the logs look like if the robot had this effect, that payload, another
//! floor?
//!
//! A [`Spec`] says what the engineer believes (the sections of a robot study, or a joint of a leg on the bench), what is
//! true instead, and which logs to make; [`make()`] simulates the true robot and answers with logs, the study of what is
//! believed, and the truth, kept apart.
//!
//! The logs come from the simulator that a diagnosis of a robot uses too. They show what a log would look like and test
//! whether the diagnosis finds what was put in; they say nothing about how good the simulator is.

mod described;
mod error;
mod excite;
mod joint;
mod make;
mod plan;
mod read;
mod spec;
mod truth;
mod write;

pub use described::make_described;
pub use error::SynthError;
pub use make::{Alteration, Made, make, make_altered};
pub use spec::{
    AnySpec, Believed, DescribedSpec, EffectSpec, ExtraSpec, FloorTruth, FrictionTruth, JointBench, JointChoice,
    LogSpec, MassScale, PayloadSpec, Spec, TruthSpec,
};
pub use truth::{JointTruth, TrueEffect, TrueParameter, Truth};
