//! `aibo-fit check`: what logs are like and what they can tell, before any diagnosis.

use super::CliError;
use super::common::{CommonArgs, print, write_outputs};
use super::progress::Progress;
use super::provenance::provenance;
use super::still::never_moved;
use crate::gap::{Checkup, GapError, check};
use crate::identify::Case;
use crate::log::{Outputs, StudyKind, study_kind};
use crate::report::{CheckReport, check_json, check_text};
use clap::Args;
use std::path::{Path, PathBuf};

/// Look at logs before any diagnosis: their health, what they can and cannot determine, what they would show
///
/// Of each log: sampling, jitter, lost samples, holes, the encoder's step, noise, rest. Of a study besides: what the logs
/// make of the numbers that it states, which of them they cannot determine and what would, and the smallest size of each
/// effect that they would show. Nothing is written unless --json or --out (check.txt) asks for it.
#[derive(Args, Debug)]
#[command(
    after_help = "Angles are in rad, times in s, torques in N m. Exit codes: 0 done; 1 the joint never moved.\n\n\
Example: aibo-fit check data/examples/delay/study.toml"
)]
pub(super) struct CheckArgs {
    /// A study (.toml) of a joint, or a log; of a log alone only the health is told
    #[arg(value_name = "STUDY|LOG")]
    path: PathBuf,
    #[command(flatten)]
    common: CommonArgs,
}

/// Runs the command.
pub(super) fn run(args: &CheckArgs) -> Result<u8, CliError> {
    let progress = Progress::new(args.common.quiet);
    progress.say("reading");
    let is_study = args.path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    let case = if is_study { joint_study(&args.path)? } else { Case::of_logs(std::slice::from_ref(&args.path), None)? };
    if case.items.iter().all(|item| item.experiments.is_empty()) {
        return never_moved(&args.common, &case, "nothing to check");
    }
    progress.say("what these logs can tell");
    let checkup: Option<Result<Checkup, GapError>> = args.common.on_threads(|| is_study.then(|| check(&case)))?;
    let report = CheckReport::new(&case, checkup.transpose()?, provenance(case.inputs())?);
    let text = check_text(&report);
    let mut outputs = Outputs::default();
    if let Some(folder) = &args.common.out {
        outputs.add(folder.join("check.txt"), text.clone());
    }
    args.common.add_json(&mut outputs, &check_json(&report))?;
    write_outputs(outputs, &case.inputs())?;
    drop(progress);
    if !args.common.quiet {
        print(&text);
    }
    Ok(0)
}

/// A study of a joint; those of robots are refused.
fn joint_study(path: &Path) -> Result<Case, CliError> {
    match study_kind(path)? {
        StudyKind::Robot | StudyKind::Clamped => Err(CliError::Usage(format!(
            "{}: the study of a whole robot; check looks at the study of a joint, or at one log",
            path.display()
        ))),
        StudyKind::Joint => Ok(Case::of_study(path)?),
    }
}
