//! What a file holds, whatever its format: named channels in SI units, each with stamps of its own.
//!
//! Every reader makes a [`Source`]; logs of a joint and of a robot are made of one ([`assemble`]). What is asked of a
//! joint and what is read of it stay apart, each at the times that its own messages or cells carry.

mod assemble;
mod bags;
mod bam;
mod bytes;
mod cdr;
mod cdr_write;
mod cells;
mod channel;
#[cfg(feature = "parquet")]
mod contained;
mod crc;
mod defects;
mod guess;
mod heading;
#[cfg(feature = "robots")]
mod intake;
mod joint_columns;
mod joint_layout;
mod joint_tables;
mod json_message;
mod kind;
#[cfg(feature = "parquet")]
mod lerobot;
#[cfg(feature = "robots")]
mod mcap;
mod mend;
mod message;
mod npy;
mod npz;
#[cfg(feature = "robots")]
mod packed;
#[cfg(feature = "parquet")]
mod parquet_numbers;
mod plotjuggler;
mod read;
mod roles;
#[cfg(feature = "robots")]
mod ros1_bag;
#[cfg(feature = "robots")]
mod rosbag;
mod sage;
#[cfg(feature = "robots")]
mod sqlite;
mod stamps;
mod stream;
mod table;
mod topics;
mod units;
mod want;
#[cfg(feature = "robots")]
mod zip;

pub(super) use assemble::{joint_log, robot_log};
pub(super) use cdr_write::JointStateForm;
pub(super) use crc::Crc;
pub(super) use kind::is_log_folder;
pub(super) use mend::tried;
pub(super) use read::{checked, read_wanted};
pub(super) use table::are_of_messages;
pub(super) use want::Want;

pub use channel::{Channel, Source};
pub use kind::log_files;
pub use read::read_source;
