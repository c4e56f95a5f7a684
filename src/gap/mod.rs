//! Layer 7: the gap between model and logs. Where it lies, which effect causes it, how far it closes.
//!
//! [`diagnose`] fits hypotheses about a study (the joint as given, recalibrated, with each effect of the catalogue, with
//! two), weighs them on fitted and held-out logs, and says what it found as a [`Diagnosis`]. Where the gap lies is asked
//! of the torque that the recalibrated joint lacks ([`residual_torque`](residual_torque()), [`localise`](localise())),
//! without looking at any effect.

mod along;
mod as_given;
mod attribute;
mod beginnings;
mod binned;
mod blocks;
mod body_kind;
mod calibrate;
mod chance;
mod check;
#[cfg(feature = "robots")]
pub mod clamped;
mod compare;
mod decide;
mod demands;
mod detect;
mod diagnose;
mod diagnosis;
mod differs;
mod doubts;
mod evidence;
mod explore;
mod floor;
mod folds;
pub mod gate;
mod grow;
mod held_out;
mod held_response;
mod hold_fit;
mod hold_scan;
#[cfg(feature = "robots")]
pub mod inverse;
mod judged;
mod kin;
mod law_candidates;
mod law_found;
mod law_shape;
mod laws;
mod localise;
mod log_part;
mod logs;
mod looks_like;
#[cfg(test)]
mod made;
mod map;
mod model;
#[cfg(feature = "robots")]
pub mod neighbours;
mod next;
mod numbers;
mod pairs;
mod phases;
mod place;
mod projector;
mod rates;
mod reach;
mod recalibrated;
mod refuted;
mod residual_torque;
mod rest;
#[cfg(feature = "robots")]
pub mod robot;
pub(crate) mod rotor;
mod score;
mod searched;
mod sentence;
mod sight;
mod smoother;
mod stage;
mod strength;
mod together;
mod told;
mod torque_seen;
mod trial;
mod twins;
mod unnamed;
mod variables;
mod waterfall;
#[cfg(feature = "robots")]
pub mod whole;
mod within;

pub use crate::identify::BeliefFound;
pub use body_kind::BodyKind;
pub use check::{Checkup, check};
pub(crate) use decide::HARDLY_A_GAP;
pub use diagnose::{GapError, diagnose};
pub use diagnosis::{
    Answer, Candidate, CauseShare, Confusion, Detectable, Diagnosis, Gap, GapOptions, LawFound, LogGap, LogTraces,
    MapCell, Next, Number, Phase, ProfileBin, ResidualTorque, Variable, Verdict, Where,
};
pub use differs::Differs;
pub use localise::localise;
pub use log_part::LogPart;
pub use logs::{By, LogSet};
pub use looks_like::looks_like;
pub(crate) use model::GapModel;
pub use rates::{Rate, Rates};
pub(crate) use reach::reach_of;
pub use residual_torque::residual_torque;
