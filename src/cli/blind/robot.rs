//! `aibo-fit blind --robot`: sealed trials of the diagnosis of whole robots.

use super::open::Drawn;
use super::{BlindArgs, one_by_one, run_with, study_folder, write_diagnosis};
use crate::blind::robot::{
    RobotAnswered, RobotFilter, RobotJudgement, RobotMade, RobotOrder, RobotTrial, RobotTruth, Setting,
    UnknownRobotCause, make_robot, score_robots,
};
use crate::cli::CliError;
use crate::gap::GapOptions;
use crate::gap::clamped::ClampedSetup;
use crate::gap::inverse::diagnose_motion;
use crate::gap::robot::{RobotCase, RobotOptions, diagnose_robot};
use crate::progress::Silent;
use crate::report::{robot_blind_figures, robot_blind_html, robot_blind_text};
use std::path::Path;
use std::time::Instant;

/// Runs the command.
pub(super) fn run(args: &BlindArgs) -> Result<u8, CliError> {
    let usage = |error: UnknownRobotCause| CliError::Usage(error.to_string());
    let filter: RobotFilter = args.cause.parse().map_err(usage)?;
    let setting = Setting::ALL.into_iter().find(|setting| args.scenario.as_deref() == Some(setting.word()));
    let cannot_show = || {
        let place = args.scenario.as_deref().unwrap_or("any");
        CliError::Usage(format!("--cause {}: no log of scenario `{place}` shows it; choose another", args.cause))
    };
    if setting.is_some_and(|setting| !filter.shows_in(setting)) {
        return Err(cannot_show());
    }
    let make = |seed: u64, trial: u64| {
        let made = make_robot(&RobotOrder { seed, setting, filter }, trial);
        let RobotMade { study, truth } = made.ok_or_else(cannot_show)?;
        Ok((study, truth))
    };
    run_with(args, "blind-robot", &make, |run, truths, progress| {
        let diagnose = |truth: &RobotTruth| {
            let began = Instant::now();
            let study = study_folder(run.workshop, truth.trial).join("study.toml");
            let is_arm = truth.scenario == Setting::Arm.word();
            let answer = if is_arm { diagnose_arm(&study) } else { diagnose_one(&study) };
            let wall_s = began.elapsed().as_secs_f64();
            if let Ok(answer) = &answer {
                write_diagnosis(run.workshop, truth.trial, answer)?;
            }
            Ok(RobotTrial { truth: truth.clone(), answer, wall_s })
        };
        let trials = one_by_one(args, truths, progress, &diagnose)?;
        progress.say("opening and scoring");
        let report = run.open(trials, score_robots)?;
        let drawn = Drawn { figures: robot_blind_figures(&report)?, page: robot_blind_html(&report)? };
        let page = run.write(&report, drawn, RobotJudgement::of, counted)?;
        Ok((robot_blind_text(&report), page))
    })
}

fn diagnose_one(study: &Path) -> Result<RobotAnswered, String> {
    let case = RobotCase::of_study(study).map_err(|error| error.to_string())?;
    let diagnosis = diagnose_robot(&case, &RobotOptions::default(), &|_| {}).map_err(|error| error.to_string())?;
    Ok(RobotAnswered::of(&diagnosis))
}

fn diagnose_arm(study: &Path) -> Result<RobotAnswered, String> {
    let setup = ClampedSetup::read(study).map_err(|error| error.to_string())?;
    let diagnosed = diagnose_motion(&setup, &GapOptions::default(), &Silent);
    let (_, diagnosis) = diagnosed.map_err(|error| error.to_string())?;
    Ok(RobotAnswered::of_arm(&diagnosis))
}

fn counted<'a>(answer: &'a RobotAnswered, judgement: &RobotJudgement) -> (&'a str, bool) {
    (&answer.standing, judgement.set)
}
