//! Turns logs of robot joints into trustworthy dynamics.

pub mod cli;
pub mod fit;
pub mod geometry;
pub mod identify;
pub mod integrate;
pub mod joint;
pub mod log;
pub mod pendulum;
pub mod report;
