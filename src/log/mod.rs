//! Layer 1: logs and studies. Reading, checking, writing.
//!
//! [`read_log`] and [`read_study`] accept the formats of the specification and nothing else: a file that they accept
//! has finite numbers, rising time, and very likely seconds and radians. [`health`] then says what a log is like.

mod about;
mod arrays;
mod at_hand;
mod beliefs;
mod clamped_study;
mod column;
mod columns;
mod day;
mod document;
mod error;
mod format;
mod header;
mod health;
mod health_correlation;
mod health_motion;
mod health_noise;
mod health_saturation;
mod health_stamps;
mod inputs;
mod manifest;
mod mcap_out;
mod motor;
mod motor_types;
mod outputs;
mod place;
mod plausible;
mod pose;
mod raw_columns;
mod read_log;
mod release;
mod robot_log;
mod robot_study;
mod rows;
mod schema;
mod sidecar;
mod source;
mod spikes;
mod study;
mod thin;
mod toml_text;
mod types;
mod uncertain;
mod window;
mod workshop;
mod write;
mod write_source;
mod write_study;

pub(crate) use clamped_study::{RawBeliefs, RawBelieved, RawDescribed, RawLoop, believed as clamped_beliefs};
pub(crate) use document::{Document, NOT_NEGATIVE, POSITIVE, Range64, finite_within, range};
pub(crate) use inputs::{check_drive_stated, check_inputs, check_torque_sign};
pub(crate) use manifest::sha256;
pub(crate) use robot_study::{
    RawControl, RawFloor, RawFriction, RawRobot, RawRobotSensor, Sections, floor, robot_sections,
};
pub(crate) use schema::{RawSensor, RawUncertain};
pub(crate) use sidecar::{sidecar_of, study_beside};
pub(crate) use study::{check_schema, read_sidecar};
pub(crate) use toml_text::{toml_key, toml_string};

pub use about::{About, read_about};
pub use arrays::ArrayLog;
pub use at_hand::{StudyAtHand, read_at_hand};
pub use clamped_study::{
    ClampedStudy, ClampedStudyLog, JointBeliefs, Predict, read_clamped_study, read_clamped_study_logs,
};
pub use columns::{ColumnSpec, Columns, Unit};
pub use day::Day;
pub use error::{CellFault, FileKind, LogError, UnitFault};
pub use format::Format;
pub use health::{Health, health};
pub use health_saturation::{Holds, Stuck};
pub use health_stamps::SetpointStamps;
pub use inputs::read_study_logs;
pub(crate) use inputs::{check_joint_inputs, read_each_log};
pub use manifest::MANIFEST_FILE;
pub use mcap_out::{McapTopic, mcap_bytes, write_mcap};
pub use motor_types::{Derivative, EncoderSide, Hold, MotorModel, MotorSpec, TauIs, VoltageMotor};
pub use outputs::Outputs;
pub use place::{Place, Subject};
pub use plausible::check_period;
pub use pose::{Pose, read_pose_for};
pub use raw_columns::study_columns;
pub use read_log::{read_joint_log, read_joint_log_as, read_log, read_robot_log};
pub use release::{HeldPhase, Start};
pub use robot_log::{BaseColumns, JointColumns, RobotLog};
pub use robot_study::{
    ControlSpec, DescribedBeliefs, FloorSpec, Forward, LegFrictionSpec, RobotRelease, RobotScenario, RobotSensorSpec,
    RobotStudy, RobotStudyLog, StudyKind, read_robot_study, read_robot_study_logs, study_kind,
};
pub use sidecar::{beside_columns, sidecar_columns};
pub use source::{Channel, Source, log_files, read_source};
pub use spikes::Spikes;
pub use study::{read_sidecar_for, read_study};
pub use thin::{liveliest, stretches, thinned};
pub use types::{DriveMode, ExtraMass, JointSpec, Log, Nominal, Release, Role, SensorSpec, Stamped, Study, StudyLog};
pub use uncertain::{Spread, Uncertain};
pub use window::Window;
pub(crate) use workshop::Workshop;
pub use write::{write_atomically, write_log};
pub use write_source::{mcap_topics, write_csv};
pub use write_study::study_text;
