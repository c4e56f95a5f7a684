//! `aibo-fit blind --robot`: sealed trials of the diagnosis of a whole robot.

use super::{BlindArgs, add_rates, one_by_one, opened, run_with, study_folder, write_diagnosis};
use crate::blind::robot::{
    RobotAnswered, RobotFilter, RobotJudgement, RobotMade, RobotOrder, RobotRunRecord, RobotTrial, RobotTrialRecord,
    RobotTruth, UnknownRobotCause, make_robot, score_robots,
};
use crate::blind::{Sealed, TRUTHS_FILE};
use crate::cli::CliError;
use crate::cli::common::json_text;
use crate::cli::provenance::provenance;
use crate::gap::Rates;
use crate::gap::robot::{RobotCase, RobotOptions, diagnose_robot};
use crate::log::{Outputs, RobotScenario};
use crate::report::{RobotBlindReport, robot_blind_figures, robot_blind_html, robot_blind_text};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Runs the command.
pub(super) fn run(args: &BlindArgs) -> Result<u8, CliError> {
    let usage = |error: UnknownRobotCause| CliError::Usage(error.to_string());
    let filter: RobotFilter = args.cause.parse().map_err(usage)?;
    let scenarios = [RobotScenario::Air, RobotScenario::Floor, RobotScenario::Drop];
    let scenario = scenarios.into_iter().find(|scenario| args.scenario.as_deref() == Some(scenario.word()));
    let cannot_show = || {
        let place = args.scenario.as_deref().unwrap_or("any");
        CliError::Usage(format!("--cause {}: no log of scenario `{place}` shows it; choose another", args.cause))
    };
    if scenario.is_some_and(|scenario| !filter.shows_in(scenario)) {
        return Err(cannot_show());
    }
    let make = |seed: u64, trial: u64| {
        let made = make_robot(&RobotOrder { seed, scenario, filter }, trial);
        let RobotMade { study, truth } = made.ok_or_else(cannot_show)?;
        Ok((study, truth))
    };
    run_with(args, "blind-robot", &make, |seed, folder, truths, sealed, progress| {
        let diagnose = |truth: &RobotTruth| {
            let began = Instant::now();
            let answer = diagnose_one(&study_folder(folder, truth.trial).join("study.toml"));
            let wall_s = began.elapsed().as_secs_f64();
            if let Ok(answer) = &answer {
                write_diagnosis(folder, truth.trial, answer)?;
            }
            Ok(RobotTrial { truth: truth.clone(), answer, wall_s })
        };
        let trials = one_by_one(args, truths, progress, &diagnose)?;
        progress.say("opening and scoring");
        let truths: Vec<RobotTruth> = trials.iter().map(|trial| trial.truth.clone()).collect();
        let (sha256, seal_holds) = opened(folder, &truths)?;
        let (score, provenance) = (score_robots(&trials), provenance([])?);
        let report = RobotBlindReport { seed, sha256, seal_holds, score, trials, provenance };
        let page = write(args, folder, &report, sealed)?;
        Ok((robot_blind_text(&report), page))
    })
}

fn diagnose_one(study: &Path) -> Result<RobotAnswered, String> {
    let case = RobotCase::of_study(study).map_err(|error| error.to_string())?;
    let diagnosis = diagnose_robot(&case, &RobotOptions::default(), &|_| {}).map_err(|error| error.to_string())?;
    Ok(RobotAnswered::of(&diagnosis))
}

fn write(args: &BlindArgs, folder: &Path, report: &RobotBlindReport, sealed: &Sealed) -> Result<PathBuf, CliError> {
    let record = RobotRunRecord {
        schema: 1,
        version: &report.provenance.version,
        command: &report.provenance.command,
        seed: report.seed,
        sha256: &report.sha256,
        seal_holds: report.seal_holds,
        score: &report.score,
        trials: report.trials.iter().map(RobotTrialRecord::of).collect(),
    };
    let mut outputs = Outputs::default();
    outputs.add(folder.join(TRUTHS_FILE), sealed.text.as_str());
    for figure in robot_blind_figures(report)? {
        outputs.add(folder.join(figure.file_name), figure.svg);
    }
    outputs.add(folder.join("score.json"), json_text(&record)?);
    let page = folder.join("report.html");
    outputs.add(&page, robot_blind_html(report)?);
    args.common.add_json(&mut outputs, &record)?;
    if args.rates.is_some() {
        let answered = report.trials.iter().filter_map(|t| Some((t.answer.as_ref().ok()?, RobotJudgement::of(t))));
        let counted = answered.map(|(answer, judgement)| (answer.standing.as_str(), judgement.set));
        add_rates(args, &mut outputs, Rates::count(report.provenance.command.clone(), counted))?;
    }
    outputs.write()?;
    Ok(page)
}
