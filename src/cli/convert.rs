//! `aibo-fit convert`: a log of any format as the project's own CSV, or as MCAP.

use super::CliError;
use super::common::{log_name, print, refuse_overwriting};
use crate::log::{
    log_files, mcap_topics, read_source, sidecar_columns, study_columns, write_atomically, write_csv, write_mcap,
};
use clap::Args;
use std::path::PathBuf;

/// Write a log of any format as CSV in seconds and radians, or as MCAP
///
/// CSV has one row a stamp, and empty cells where setpoints and readings have stamps of their own. MCAP has JointState
/// messages in CDR: /joint_states of what was read, /joint_command of what was asked.
#[derive(Args, Debug)]
#[command(after_help = "Angles are in rad, times in s from the start of a bag, torques in N m.\n\n\
Example: aibo-fit convert data/examples/arm/log0.csv fits/arm.mcap")]
pub(super) struct ConvertArgs {
    /// The log: a file, or a folder of SAGE, LeRobot or rosbag2
    #[arg(value_name = "LOG")]
    log: PathBuf,
    /// What to write: a name that ends in .csv or .mcap
    #[arg(value_name = "OUT")]
    out: PathBuf,
    /// A study whose [columns] say what the log calls its columns, and their units
    #[arg(long, value_name = "STUDY")]
    columns: Option<PathBuf>,
    /// No text on standard output
    #[arg(long, short)]
    quiet: bool,
}

/// Runs the command.
pub(super) fn run(args: &ConvertArgs) -> Result<u8, CliError> {
    let ending = args.out.extension().map(|ending| ending.to_ascii_lowercase());
    let is_mcap = match ending.as_ref().and_then(|ending| ending.to_str()) {
        Some("mcap") => true,
        Some("csv") => false,
        _ => {
            return Err(CliError::Usage(format!("{}: expected a name that ends in .csv or .mcap", args.out.display())));
        }
    };
    let columns = args.columns.as_deref().map_or_else(|| sidecar_columns(&args.log), study_columns)?;
    let source = read_source(&args.log, &columns)?;
    refuse_overwriting([args.out.as_path()], &log_files(&args.log)?)?;
    let samples: usize = source.clocks.iter().map(Vec::len).max().unwrap_or(0);
    let (joints, format) = (source.joints().len(), source.format);
    let notes = source.notes.clone();
    write_atomically(&args.out, |out| match is_mcap {
        true => write_mcap(&mcap_topics(source, &log_name(&args.log)), out),
        false => write_csv(&source, out),
    })?;
    if !args.quiet {
        let joints = if joints == 1 { "1 joint".to_owned() } else { format!("{joints} joints") };
        print(&format!("{}: {samples} samples, {joints}, from {format}\n", args.out.display()));
        notes.iter().for_each(|note| print(&format!("- {note}\n")));
    }
    Ok(0)
}
