//! Layer 4: pendulum models of one joint.
//!
//! - [`ratios`]: mass and friction from two fitted ratios of the simple pendulum (3.2-3.6).

pub mod ratios;

pub use ratios::{
    RatioError, RatioTest, SimpleEstimate, friction_from_ratios, length_from_stiffness, mass_from_ratios,
};
