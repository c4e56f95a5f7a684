//! Turns logs of robot joints into trustworthy dynamics.

pub mod geometry;
pub mod log;
pub mod pendulum;
pub mod report;
