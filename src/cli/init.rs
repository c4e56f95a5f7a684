//! `aibo-fit init`: a study written from logs.

use super::CliError;
use super::common::{CommonArgs, log_name, print, study_name, warn, write_outputs};
use crate::log::{Outputs, beside_columns};
use crate::report::{Draft, draft_study, list_item};
use clap::Args;
use std::fs;
use std::path::{Path, PathBuf};

/// The name of a study that this program writes.
const STUDY: &str = "study.toml";

/// Write a study from logs, to fill in
///
/// Looks at logs of any format that is read (CSV with any names and units, SAGE folders, JointState tables, rosbag2, MCAP,
/// LeRobot datasets, NumPy arrays, BAM's JSON) and writes a study with all they show: joints, columns and units, period,
/// encoder's step, what drives the joints. Guesses are marked as guesses; what a log cannot show (inertia, friction,
/// gains) stands there as comments that say what to weigh or look up, and is told on standard output.
#[derive(Args, Debug)]
#[command(
    after_help = "With --robot the study is of the whole robot, else of one joint: --joint, or the one that moves most.\n\
An existing study is not written over unless --force is given. Next: fill it in, then `aibo-fit gap study.toml`.\n\n\
Example: aibo-fit init data/examples/arm/log0.csv --robot data/examples/arm/arm.urdf --study fits/arm/study.toml"
)]
pub(super) struct InitArgs {
    /// Logs: files, or folders of SAGE, LeRobot or rosbag2
    #[arg(value_name = "LOG", required = true)]
    logs: Vec<PathBuf>,
    /// The robot's description: URDF, MJCF or TOML
    #[arg(long, value_name = "FILE")]
    robot: Option<PathBuf>,
    /// The joint that the study is about
    #[arg(long, value_name = "NAME", conflicts_with = "robot")]
    joint: Option<String>,
    /// The study's file [default: study.toml in the folder of the first log]
    #[arg(long, short, value_name = "FILE")]
    study: Option<PathBuf>,
    /// Write over a study that is there
    #[arg(long)]
    force: bool,
    /// No text on standard output
    #[arg(long, short)]
    quiet: bool,
}

/// Runs the command.
pub(super) fn run(args: &InitArgs) -> Result<u8, CliError> {
    let beside = || args.logs.first().and_then(|log| log.parent()).unwrap_or(Path::new("")).join(STUDY);
    let study = args.study.clone().unwrap_or_else(beside);
    if study.exists() && !args.force {
        let why = format!("{}: there is a study already; name another by --study, or give --force", study.display());
        return Err(CliError::Usage(why));
    }
    let draft = draft_study(&args.logs, args.robot.as_deref(), args.joint.as_deref(), folder_of(&study))?;
    write_draft(&study, &draft).map_err(not_over_inputs)?;
    if !args.quiet {
        args.logs.iter().for_each(|log| warn_of_unused(log, NOT_TAKEN));
        print(&format!("study: {}\n\nWhat the logs do not tell:\n", study.display()));
        draft.untold.iter().for_each(|sentence| print(&(list_item(sentence) + "\n")));
        let study = study.display();
        let first = match &draft.to_fill[..] {
            [] => String::new(),
            keys => format!(" fill in {} in {study}, then", keys.join(", ")),
        };
        print(&format!("\nnext:{first}\n  aibo-fit check {study}\n  aibo-fit gap {study}\n"));
    }
    Ok(0)
}

/// Writes the study of a log and a robot into the output folder, and answers with its path; one that was filled in since
/// is not written over.
pub(super) fn drafted(log: &Path, robot: &Path, common: &CommonArgs) -> Result<PathBuf, CliError> {
    let name = if log.is_dir() { study_name(&log.join(STUDY)) } else { log_name(log) };
    let study = common.folder(&name).join(STUDY);
    let draft = draft_study(&[log.to_path_buf()], Some(robot), None, folder_of(&study))?;
    if fs::read(&study).is_ok_and(|there| there != draft.text.as_bytes()) {
        let study = study.display();
        let why = format!(
            "{study}: there is a study already, and not the one that this log alone gives; go on with it (`aibo-fit gap {study}`, \
             `aibo-fit check {study}`), or choose another --out"
        );
        return Err(CliError::Usage(why));
    }
    write_draft(&study, &draft)?;
    if !common.quiet {
        warn_of_unused(log, NOT_TAKEN);
        print(&format!("study: {} (written from the log; guesses are marked in it)\n", study.display()));
        draft
            .untold
            .iter()
            .for_each(|sentence| print(&(list_item(&format!("not told by the log: {sentence}")) + "\n")));
        print("\n");
    }
    Ok(study)
}

/// Why a study that is written lacks what sidecars say.
const NOT_TAKEN: &str = "the study that is written has only [columns] of it; copy what belongs there";

/// Says what a log's sidecar has that is not used.
pub(super) fn warn_of_unused(log: &Path, why: &str) {
    let keys = beside_columns(log);
    if !keys.is_empty() {
        let sidecar = log.with_extension("toml");
        warn(&format!("{}: not used: {}; {why}", sidecar.display(), keys.join(", ")));
    }
}

fn write_draft(study: &Path, draft: &Draft) -> Result<(), CliError> {
    let mut outputs = Outputs::default();
    outputs.add_apart(study, draft.text.clone());
    write_outputs(outputs, &draft.inputs)
}

/// Says what to do where the study would take the place of a file that it is made from.
fn not_over_inputs(error: CliError) -> CliError {
    match error {
        CliError::Overwrites { input } => {
            let input = input.display();
            CliError::Usage(format!(
                "{input}: the study is made from this file and not written over it; name another by --study"
            ))
        }
        other => other,
    }
}

fn folder_of(study: &Path) -> &Path {
    study.parent().unwrap_or(Path::new(""))
}
