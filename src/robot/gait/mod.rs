//! Gaits (section 4.1): which angle does the walk ask of each joint at which time?
//!
//! - [`Setpoints`]: anything that has an answer.
//! - [`Gait`]: stand, then walk; one wave for each joint. Gaits are files (`data/gaits/`), format in `docs/reference/robot.md`.
//! - [`Sampled`]: setpoints as a controller gets them, at a period, held or joined by lines: 8 ms frames, or the 128 ms
//!   of a motion file (C.3).
//! - [`Motion`]: a gait as a Tekkotsu motion file (section 4.2.1), written and read back.
//!
//! Figure 4.2's setpoints are not in the text; the trot here is the reference walk, designed and calibrated to the
//! 0.51 m of Table 4.1.

mod motion;
mod motion_file;
mod read;
mod sampled;
#[cfg(test)]
mod tests;
mod wave;

pub use motion::Motion;
pub use sampled::{Between, Sampled};
pub use wave::{Gait, Setpoints};
