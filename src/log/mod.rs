//! Layer 1: logs and studies. Reading, checking, writing.

mod types;

pub use types::{
    Derivative, DriveMode, ExtraMass, Hold, JointSpec, Log, MotorSpec, Nominal, Release, Role, SensorSpec, Study,
    StudyLog,
};
