//! Layer 7c: sealed trials. Studies whose cause is drawn at random, and how well a diagnosis finds it.
//!
//! Which question: can the diagnosis be believed? A trial makes a study, seals what is true of it, diagnoses the study
//! from its files alone, and only then opens the answer.
//!
//! The maker shares nothing with the code that diagnoses but the names of the effects: it has its own joints, its own
//! integrator (time stepping with set-valued friction at 25 microseconds), its own formulas (half of the studies
//! use variants of the catalogue's, such as presliding instead of rigid Coulomb friction) and mechanisms that the
//! catalogue does not have ([`OutsideId`]).

mod answer;
mod belief;
mod cause;
mod dice;
mod draw;
mod joint;
mod make;
mod matter;
mod mechanism;
mod motion;
mod plan;
mod record;
pub mod robot;
mod score;
mod seal;
mod sensor;
mod sim;
mod size;
mod together;
mod trial;
mod truth;
mod write;

pub use answer::{Answered, GapNumbers, Ranked, StatedEffect, StatedNumber};
pub use cause::{Cause, CauseFilter, OutsideId, UnknownCause};
pub use joint::Family;
pub use make::{Made, make, make_filtered, make_with};
pub use record::{RunRecord, TrialRecord};
pub use score::{
    Bin, ByCause, ByNoise, BySet, BySize, Coverage, Covered, Judgement, Rate, Score, Stated, Table, WallTime, score,
};
pub use seal::{Sealed, TRUTHS_FILE};
pub use sensor::{Noise, Stamps};
pub use trial::Trial;
pub use truth::{Believed, FourNumbers, Gains, Nearest, TrueMechanism, TrueNumber, TrueWhere, Truth};
