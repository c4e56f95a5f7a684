//! Layer 4: pendulums of one joint.
//!
//! - [`SimplePendulum`]: point mass and linear friction (3.2); [`ratios`]: mass and friction from two fitted ratios
//!   (3.3-3.6).
//! - [`ExtensivePendulum`]: bodies with inertias, Coulomb to Stribeck friction (3.12, 3.13).
//! - [`rollout`](rollout()): their motion, with true sticking.

#[cfg(test)]
mod drive_tests;
mod events;
mod extensive;
mod history;
#[cfg(test)]
mod law_tests;
mod leap;
mod one_body;
mod play;
mod profile;
pub mod ratios;
mod rollout;
mod schedule;
mod simple;

pub(crate) use play::{LINK_SHARE, ROTOR_AT_MOST};

pub use extensive::ExtensivePendulum;
pub use ratios::{
    RatioError, RatioTest, SimpleEstimate, friction_from_ratios, length_from_stiffness, mass_from_ratios,
};
pub use rollout::{Diverged, Start, State, readings, rollout, rollout_refined};
pub use schedule::Input;
pub(crate) use schedule::{Command, SAME_INSTANT_S, Schedule};
pub use simple::SimplePendulum;
