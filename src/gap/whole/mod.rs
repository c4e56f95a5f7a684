//! What was found on a robot's joints and bodies, put back into the robot as a whole: as numbers of its description, and as
//! one simulation of all joints at once.

mod followed;
mod masses;
mod numbers;
mod robot;
mod simulated;

pub use numbers::{FoundRobot, found_robot};
pub use robot::{PlacedCause, WholeRobot, placed_causes};
pub(crate) use simulated::predicted_csv;
pub use simulated::{LeftOut, Whole, WholeJoint, WholeMotion, simulated};
