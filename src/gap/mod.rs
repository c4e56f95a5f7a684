//! Layer 7: the gap between model and logs. Where it lies, which effect causes it, how far it closes.
//!
//! [`diagnose`] fits hypotheses about a study (the joint as given, recalibrated, with each effect of the catalogue, with
//! two), weighs them on fitted and held-out logs, and says what it found as a [`Diagnosis`]. Where the gap lies is asked
//! of the torque that the recalibrated joint lacks ([`residual_torque`](residual_torque()), [`localise`](localise())),
//! without looking at any effect.

mod body_kind;
mod check;
#[cfg(feature = "robots")]
pub mod clamped;
mod diagnose;
mod diagnosis;
pub mod gate;
pub(crate) mod hypothesis;
#[cfg(feature = "robots")]
pub mod inverse;
mod location;
#[cfg(feature = "robots")]
pub mod neighbours;
mod on_demand;
#[cfg(feature = "robots")]
pub mod robot;
mod search;
mod verdict;
#[cfg(feature = "robots")]
pub mod whole;

pub use crate::identify::BeliefFound;
pub use body_kind::BodyKind;
pub use check::{Checkup, check};
pub use diagnose::{GapError, diagnose};
pub use diagnosis::{
    Answer, Candidate, CauseShare, Confusion, Detectable, Diagnosis, Gap, GapOptions, LawFound, LogGap, LogTraces,
    MapCell, Next, Number, Phase, ProfileBin, ResidualTorque, Variable, Verdict, Where,
};
pub(crate) use diagnosis::{LOGS_IN_TURN, NOT_HELD_OUT, PARTS_IN_TURN};
pub use hypothesis::logs::{By, LogSet};
pub(crate) use hypothesis::model::GapModel;
pub(crate) use hypothesis::reach::reach_of;
pub use location::localise::localise;
pub use location::log_part::LogPart;
pub use location::looks_like::looks_like;
pub use location::residual_torque::residual_torque;
pub use search::differs::Differs;
pub(crate) use verdict::decide::HARDLY_A_GAP;
pub use verdict::rates::{Rate, Rates};
