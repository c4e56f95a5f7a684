//! Layer 7: the gap between model and logs. Where it lies, which effect causes it, how far it closes.
//!
//! [`diagnose`] fits hypotheses about a study (the joint as given, recalibrated, with each effect of the catalogue, with
//! two), weighs them on fitted and held-out logs, and says what it found as a [`Diagnosis`].

mod attribute;
mod compare;
mod decide;
mod detect;
mod diagnose;
mod diagnosis;
mod evidence;
mod explore;
mod floor;
mod held_out;
mod model;
mod numbers;
mod rates;
mod reach;
mod sentence;
mod trial;

pub use diagnose::{GapError, diagnose};
pub use diagnosis::{
    Answer, Candidate, Confusion, Detectable, Diagnosis, Gap, GapOptions, LogGap, LogTraces, MapCell, Next, Number,
    Phase, ProfileBin, ResidualTorque, Variable, Verdict, Where,
};
pub(crate) use model::GapModel;
pub(crate) use reach::reach_of;
