//! The formats that are read.

use std::fmt;

/// A format that is read, recognised by what a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// The project's own CSV, or any other that `[columns]` explains.
    Csv,
    /// A table with a row for each message, empty cells where another message stands.
    StaggeredCsv,
    /// A JointState message as a table, in one of the layouts that tools write.
    JointStateTable,
    /// A folder of SAGE: `control.csv`, `state_motor.csv`, `joint_list.txt`.
    Sage,
    /// A bag of ROS 1.
    Rosbag1,
    /// A ROS 2 bag in SQLite.
    Rosbag2,
    /// MCAP.
    Mcap,
    /// A LeRobot dataset, or one of its Parquet files.
    LeRobot,
    /// Arrays of NumPy.
    Npz,
    /// A log of Rhoban's BAM, in JSON.
    Bam,
    /// Arrays that no file holds.
    Arrays,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Csv => "CSV",
            Self::StaggeredCsv => "CSV with a row for each message",
            Self::JointStateTable => "a table of JointState messages",
            Self::Sage => "a SAGE recording",
            Self::Rosbag1 => "a bag of ROS 1",
            Self::Rosbag2 => "a rosbag2 file (SQLite)",
            Self::Mcap => "MCAP",
            Self::LeRobot => "a LeRobot dataset",
            Self::Npz => "NumPy arrays",
            Self::Bam => "a log of BAM (JSON)",
            Self::Arrays => "arrays",
        })
    }
}
