//! What was found on a robot's joints and bodies, put back into the robot as a whole: as numbers of its description, and as
//! one simulation of all joints at once.

mod masses;
mod numbers;
mod simulated;

pub use numbers::{FoundRobot, found_robot};
pub use simulated::{Whole, WholeJoint, simulated};
