//! Layer 7: the gap between model and logs. Where it lies, which effect causes it, how far it closes.

mod along;
mod diagnosis;
#[cfg(test)]
mod made;
mod phases;
mod residual_torque;
mod rest;
mod smoother;

pub use diagnosis::{
    Answer, Candidate, Confusion, Detectable, Diagnosis, Gap, GapOptions, LogGap, LogTraces, MapCell, Next, Number,
    Phase, ProfileBin, ResidualTorque, Variable, Verdict, Where,
};
pub use residual_torque::residual_torque;
