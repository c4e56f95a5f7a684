//! Layer 7: the gap between model and logs. Where it lies, which effect causes it, how far it closes.

mod diagnosis;
mod shim;

pub use diagnosis::{
    Answer, Candidate, Confusion, Detectable, Diagnosis, Gap, GapOptions, LogGap, LogTraces, MapCell, Next, Number,
    Phase, ProfileBin, ResidualTorque, Variable, Verdict, Where,
};
pub use shim::{GapError, diagnose};
