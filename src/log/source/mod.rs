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
mod columns;
mod crc;
mod defects;
mod guess;
mod heading;
mod intake;
mod joint_layout;
mod joint_tables;
mod json_message;
mod kind;
#[cfg(feature = "parquet")]
mod lerobot;
mod mcap;
mod message;
mod npy;
mod npz;
mod packed;
mod plotjuggler;
mod read;
mod roles;
mod ros1_bag;
mod rosbag;
mod sage;
mod sqlite;
mod stamps;
mod stream;
mod table;
mod topics;
mod units;
mod zip;

pub(super) use assemble::{joint_log, robot_log};
pub(super) use cdr_write::joint_state;
pub(super) use columns::{RawColumns, column_of, columns};
pub(super) use crc::Crc;
pub(super) use defects::{more, tell_mend, tell_others};
pub(super) use kind::is_log_folder;
pub(super) use read::{Want, read_wanted};

pub use channel::{Channel, Format, Source};
pub use columns::{ColumnSpec, Columns, Unit, study_columns};
pub use kind::log_files;
pub use read::read_source;
