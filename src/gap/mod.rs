//! Layer 7: the gap between model and logs. Where it lies, which effect causes it, how far it closes.

mod attribute;
mod compare;
mod diagnosis;
mod evidence;
mod explore;
mod floor;
mod model;
pub mod probe;
mod reach;
mod trial;

pub use diagnosis::{
    Answer, Candidate, Confusion, Detectable, Diagnosis, Gap, GapOptions, LogGap, LogTraces, MapCell, Next, Number,
    Phase, ProfileBin, ResidualTorque, Variable, Verdict, Where,
};
