//! Layer 7: the gap between model and logs. Where it lies, which effect causes it, how far it closes.

mod along;
mod binned;
mod blocks;
mod diagnosis;
mod localise;
#[cfg(test)]
mod made;
mod map;
mod phases;
mod residual_torque;
mod rest;
mod smoother;
mod stage;
mod variables;

pub use diagnosis::{
    Answer, Candidate, Confusion, Detectable, Diagnosis, Gap, GapOptions, LogGap, LogTraces, MapCell, Next, Number,
    Phase, ProfileBin, ResidualTorque, Variable, Verdict, Where,
};
pub use localise::{LogPart, localise, stage_by_signature};
pub use residual_torque::residual_torque;
