//! What was found on a robot's joints and bodies, put back into the robot as a whole: as numbers of its description, and as
//! one simulation of all joints at once.

mod beginning;
mod bench;
mod body;
mod common;
mod followed;
mod masses;
mod noise;
mod numbers;
mod parts;
mod robot;
mod settled;
mod simulated;
mod unknown;

pub(in crate::gap) use body::{BodyAtBest, body_at_best};
pub(in crate::gap) use followed::{AsFound, as_found, as_stated_at_best, numbers_alone_leave_noise};
pub use numbers::{FoundRobot, found_robot};
pub use robot::{PlacedCause, WholeRobot, placed_causes};
pub(in crate::gap) use settled::Settled;
pub(crate) use simulated::predicted_csv;
pub use simulated::{LeftOut, Whole, WholeJoint, WholeMotion, simulated};
