//! `aibo-fit gap` on the study of a whole robot.

use super::CliError;
use super::common::{CommonArgs, print, write_outputs};
use super::error::NO;
use super::gap::GapArgs;
use super::progress::Progress;
use super::provenance::provenance;
use crate::gap::robot::{RobotCase, RobotGapError, RobotOptions, diagnose_robot};
use crate::log::Outputs;
use crate::report::{RobotGapReport, robot_gap_json, robot_gap_text};
use serde_json::json;

/// Runs the command.
pub(super) fn run(args: &GapArgs) -> Result<u8, CliError> {
    if args.twins > 0 {
        let what = "--twins is for the study of a joint: twins of a robot take too long; leave it out, and the \
                    probabilities come from the rates of `blind --robot`";
        return Err(CliError::Usage(what.to_owned()));
    }
    let options = RobotOptions { without: args.without.clone(), only: args.only.clone() };
    let progress = Progress::new(args.common.quiet);
    progress.say("reading");
    let case = RobotCase::of_study(&args.study).map_err(|error| CliError::RobotCase(Box::new(error)))?;
    let diagnosis = args.common.on_threads(|| diagnose_robot(&case, &options, &|what| progress.say(what)))?;
    let diagnosis = match diagnosis {
        Err(error @ RobotGapError::NeverMoved) => return never_moved(&args.common, &case, &error),
        diagnosis => diagnosis?,
    };
    progress.say("drawing");
    let report = RobotGapReport::new(&case, diagnosis, options, provenance(case.inputs())?);
    let mut outputs = Outputs::default();
    args.common.add_json(&mut outputs, &robot_gap_json(&report))?;
    write_outputs(outputs, &case.inputs())?;
    drop(progress);
    if !args.common.quiet {
        print(&robot_gap_text(&report));
    }
    Ok(0)
}

/// Nothing moves: that is an answer, too.
fn never_moved(common: &CommonArgs, case: &RobotCase, why: &RobotGapError) -> Result<u8, CliError> {
    let sentence = format!("{}: no diagnosis: {why}.", case.robot());
    let mut outputs = Outputs::default();
    let answer = json!({ "schema": 1, "name": case.robot(), "moved": false, "sentence": sentence });
    common.add_json(&mut outputs, &answer)?;
    write_outputs(outputs, &case.inputs())?;
    if !common.quiet {
        print(&format!("{sentence}\n"));
    }
    Ok(NO)
}
