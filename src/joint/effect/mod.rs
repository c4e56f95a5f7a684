//! The catalogue of unmodelled effects: terms that may be added to one stage of the chain.

mod catalogue;

pub use catalogue::{EffectId, Stage, UnknownEffect};
