//! `aibo-fit gate`: realism as a check in CI.

use super::CliError;
use super::common::{CommonArgs, file_to_write, print, write_outputs};
use super::error::NO;
use super::progress::Progress;
use super::provenance::provenance;
use crate::gap::clamped::ClampedSetup;
use crate::gap::gate::{GateBounds, GateStudy};
use crate::gap::inverse::diagnose_setup;
use crate::gap::robot::{RobotCase, RobotOptions, diagnose_robot};
use crate::gap::{GapOptions, diagnose};
use crate::identify::Case;
use crate::log::{LogError, Outputs, StudyKind, study_kind};
use crate::report::{
    ClampedGapReport, GapReport, RobotGapReport, clamped_gap_json, gap_json, gate_baseline, gate_json, gate_junit,
    gate_markdown, gate_study, gate_text, robot_gap_json,
};
use clap::Args;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Fail where the gap between model and logs is larger than it may be, naming joint, log and cause
///
/// Diagnoses each study as `gap` does, and judges what the model as given is off by (RMS), log by log and joint by joint,
/// against a bound, or against an earlier run (--baseline, as written by --json of `gate` or `gap`). A study without an
/// answer fails, too. Nothing is written but what --json, --junit and --summary ask for.
#[derive(Args, Debug)]
#[command(
    after_help = "Exit codes: 0 passed; 1 a gap is larger than it may be, or a study has no answer; 2 usage; 5 the baseline \
cannot be read.\n\nExample: aibo-fit gate data/examples/delay/study.toml --max-gap 0.1"
)]
pub(super) struct GateArgs {
    /// Studies of joints and robots
    #[arg(value_name = "STUDY", required = true)]
    studies: Vec<PathBuf>,
    /// The largest RMS error of the model as given [rad; N m where a study predicts torques]
    #[arg(long, value_name = "RAD", value_parser = not_negative)]
    max_gap: Option<f64>,
    /// By how much the error may have grown since the baseline [%]
    #[arg(long, value_name = "PERCENT", value_parser = not_negative, requires = "baseline")]
    max_growth: Option<f64>,
    /// An earlier gate's or diagnosis's --json
    #[arg(long, value_name = "FILE", requires = "max_growth")]
    baseline: Option<PathBuf>,
    /// Write the result as JUnit XML, for a CI system
    #[arg(long, value_name = "FILE", value_parser = file_to_write())]
    junit: Option<PathBuf>,
    /// Write a short summary in Markdown, for a pull request
    #[arg(long, value_name = "FILE", value_parser = file_to_write())]
    summary: Option<PathBuf>,
    #[command(flatten)]
    common: CommonArgs,
}

fn not_negative(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("expected a number not below 0".to_owned()),
    }
}

/// Runs the command.
pub(super) fn run(args: &GateArgs) -> Result<u8, CliError> {
    if args.max_gap.is_none() && args.max_growth.is_none() {
        let what = "nothing to hold to: give --max-gap RAD, or --baseline FILE with --max-growth PERCENT";
        return Err(CliError::Usage(what.to_owned()));
    }
    let bounds = GateBounds { max_gap: args.max_gap, max_growth: args.max_growth.map(|percent| percent / 100.0) };
    let baseline = args.baseline.as_deref().map(read_baseline).transpose()?.unwrap_or_default();
    let progress = Progress::new(args.common.quiet);
    let judged = |path: &PathBuf| {
        let name = path.display().to_string();
        progress.say(&name);
        // A diagnosis that serves as baseline does not know its study's name.
        let earlier = |joint: &str, log: &str| {
            let of = |study: &str| baseline.get(&(study.to_owned(), joint.to_owned(), log.to_owned())).copied();
            of(&name).or_else(|| of(""))
        };
        match args.common.on_threads(|| document(path, &progress)).and_then(|found| found) {
            Ok(document) => gate_study(&name, &document, &bounds, &earlier),
            Err(error) => GateStudy::failed(&name, error.to_string()),
        }
    };
    let studies: Vec<GateStudy> = args.studies.iter().map(judged).collect();
    let mut rows = studies.iter().flat_map(|study| &study.rows).peekable();
    if let Some(file) = args.baseline.clone()
        && rows.peek().is_some()
        && rows.all(|row| row.is_new)
    {
        let what = "it has none of these joints and logs, so nothing would be held against it".to_owned();
        return Err(CliError::FitFile { file, what });
    }
    let inputs: Vec<PathBuf> = args.studies.iter().chain(&args.baseline).cloned().collect();
    let from = provenance([])?;
    let mut outputs = Outputs::default();
    args.common.add_json(&mut outputs, &gate_json(&studies, &bounds, &from.version, &from.command))?;
    if let Some(path) = &args.junit {
        outputs.add_apart(path, gate_junit(&studies));
    }
    if let Some(path) = &args.summary {
        outputs.add_apart(path, gate_markdown(&studies));
    }
    write_outputs(outputs, &inputs)?;
    drop(progress);
    if !args.common.quiet {
        print(&gate_text(&studies));
    }
    Ok(if studies.iter().all(GateStudy::passes) { 0 } else { NO })
}

/// Errors of an earlier run, by study, joint and log.
fn read_baseline(path: &Path) -> Result<BTreeMap<(String, String, String), f64>, CliError> {
    let wrong = |what: String| CliError::FitFile { file: path.to_path_buf(), what };
    let text = std::fs::read_to_string(path).map_err(|source| LogError::Read { file: path.to_path_buf(), source })?;
    let document: Value = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    gate_baseline(&document).ok_or_else(|| wrong("expected what --json of gate or gap writes".to_owned()))
}

/// The diagnosis of a study of any kind, as `gap --json` writes it.
fn document(study: &Path, progress: &Progress) -> Result<Value, CliError> {
    let encoded = |error: serde_json::Error| CliError::Encode(error.to_string());
    match study_kind(study)? {
        StudyKind::Joint => {
            let (case, options) = (Case::of_study(study)?, GapOptions::default());
            let diagnosis = diagnose(&case, &options, progress)?;
            let report = GapReport::new(&case, diagnosis, options, provenance(case.inputs())?);
            serde_json::to_value(gap_json(&report)).map_err(encoded)
        }
        StudyKind::Clamped => {
            let (setup, options) = (ClampedSetup::read(study)?, GapOptions::default());
            let from = provenance(setup.inputs())?;
            let found = diagnose_setup(&setup, &options, progress)?;
            clamped_gap_json(&ClampedGapReport::new(&setup, found, &options, &from)).map_err(encoded)
        }
        StudyKind::Robot => {
            let case = RobotCase::of_study(study).map_err(|error| CliError::RobotCase(Box::new(error)))?;
            let options = RobotOptions::default();
            let diagnosis = diagnose_robot(&case, &options, &|what| progress.say(what))?;
            let report = RobotGapReport::new(&case, diagnosis, options, provenance(case.inputs())?);
            serde_json::to_value(robot_gap_json(&report)).map_err(encoded)
        }
    }
}
