//! Sealed trials of a whole robot.
//!
//! Robots are the ERS-7, quadrupeds of another size, and arms that are made at random. The maker uses the program's own
//! simulator, by another integrator and step than the diagnosis ([`RobotTruth::method`]), with masses, friction and floor
//! off by some percent everywhere, and with faults that the catalogue does not have ([`RobotOutside`]). So a trial tests
//! the diagnosis, and not the simulator.

mod answer;
mod arm;
mod cause;
mod fault;
mod judge;
mod make;
mod outside;
mod quadruped;
mod scene;
mod score;
#[cfg(test)]
mod score_tests;
mod setting;
mod size;
mod truth;

pub use answer::{RobotAnswered, RobotRanked, StatedCause};
pub use cause::{RobotFilter, RobotOutside, RobotTrueCause, UnknownRobotCause};
pub use judge::{RobotJudgement, RobotTrial};
pub use make::{RobotMade, RobotOrder, make_robot};
pub use score::{RobotBySize, RobotGroup, RobotScore, score_robots};
pub use setting::Setting;
pub use truth::{RobotTruth, TrueFault};
