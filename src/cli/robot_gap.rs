//! `aibo-fit gap` on the study of a whole robot.

use super::CliError;
use super::common::{CommonArgs, print, study_name, warn, write_outputs};
use super::error::NO;
use super::gap::{GapArgs, causes};
use super::progress::Progress;
use super::provenance::provenance;
use crate::deadline::Deadline;
use crate::gap::robot::{RobotCase, RobotGapError, RobotOptions, diagnose_robot};
use crate::log::Outputs;
use crate::report::{
    ANIMATION_FILE, REPAIRED_FILE, RobotGapReport, animation_html, repaired_robot, robot_gap_animation,
    robot_gap_figures, robot_gap_html, robot_gap_json, robot_gap_text,
};
use serde_json::json;

/// What stands beside the report, the second where the robot's file is of our own format.
const BESIDE: [(&str, &str); 2] = [
    (ANIMATION_FILE, "the robot as given, repaired and logged, moving together"),
    (REPAIRED_FILE, "the repaired robot, for walk --robot and for a study's model"),
];

/// Runs the command.
pub(super) fn run(args: &GapArgs, deadline: Deadline) -> Result<u8, CliError> {
    if args.twins > 0 {
        let what = "--twins is for the study of a joint: twins of a robot take too long; leave it out, and the \
                    probabilities come from the rates of `blind --robot`";
        return Err(CliError::Usage(what.to_owned()));
    }
    if !args.demands.directives().is_empty() {
        let what = "--fix, --free, --bound and --start are for the study of a joint; of a robot, state what is known in \
                    its study, with 0 in [uncertain] for what is exact";
        return Err(CliError::Usage(what.to_owned()));
    }
    let options = RobotOptions { without: causes(&args.without)?, only: causes(&args.only)?, deadline };
    let progress = Progress::within(args.common.quiet, args.budget);
    progress.say("reading");
    let case = RobotCase::of_study(&args.study).map_err(|error| CliError::RobotCase(Box::new(error)))?;
    progress.pause(|| case.nominal.warnings.iter().for_each(|warning| warn(warning)));
    let diagnosis = args.common.on_threads(|| diagnose_robot(&case, &options, &|what| progress.say(what)))?;
    let diagnosis = match diagnosis {
        Err(error @ RobotGapError::NeverMoved) => return never_moved(&args.common, &case, &error),
        diagnosis => diagnosis?,
    };
    progress.say("drawing");
    let repaired = match case.study.described {
        None => Some(repaired_robot(&case, &diagnosis.changes, &diagnosis.answer.sentence)?),
        Some(_) => None,
    };
    let animation = robot_gap_animation(&case, &diagnosis)?;
    let mut report = RobotGapReport::new(&case, diagnosis, options, provenance(case.inputs())?);
    let beside = BESIDE[..1 + usize::from(repaired.is_some())].iter();
    report.beside = beside.map(|(file, what)| ((*file).to_owned(), (*what).to_owned())).collect();
    let folder = args.common.folder(&study_name(&args.study));
    let mut outputs = Outputs::default();
    for figure in robot_gap_figures(&report)? {
        outputs.add(folder.join(figure.file_name), figure.svg);
    }
    if let Some(repaired) = repaired {
        outputs.add(folder.join(REPAIRED_FILE), repaired);
    }
    outputs.add(folder.join(ANIMATION_FILE), animation_html(&animation)?);
    let page = folder.join("report.html");
    outputs.add_page(&page, robot_gap_html(&report)?);
    args.common.add_json(&mut outputs, &robot_gap_json(&report))?;
    write_outputs(outputs, &case.inputs())?;
    drop(progress);
    if !args.common.quiet {
        print(&robot_gap_text(&report));
        print(&format!("\nreport: {}\n", page.display()));
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
