//! The diagnosis, as `aibo-fit gap` makes it.

use crate::answer::{Answer, json_text};
use crate::ask::{Asked, Question, Subject, provenance};
use crate::demands::{self, Demands};
use crate::errors::Failed;
use crate::run::{Listener, run};
use aibo_fit::deadline::{Deadline, budget};
use aibo_fit::gap::clamped::{ClampedSetup, NamedCause};
use aibo_fit::gap::inverse::{TorqueError, diagnose_setup};
use aibo_fit::gap::robot::{Cause, RobotCase, RobotGapError, RobotOptions, UnknownCause, diagnose_robot};
use aibo_fit::gap::{GapError, GapOptions, diagnose};
use aibo_fit::identify::{Case, Directives};
use aibo_fit::report::{
    ClampedGapReport, GapReport, RobotGapReport, clamped_gap_html, clamped_gap_json, clamped_gap_text, gap_json,
    gap_text, render_gap_html, robot_gap_html, robot_gap_json, robot_gap_text,
};
use pyo3::prelude::*;

/// Keywords of the Python half.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Keywords {
    without: Vec<String>,
    only: Vec<String>,
    twins: u32,
    seed: u64,
    demands: Demands,
    budget_s: Option<f64>,
}

/// What is asked beside the study.
struct Options {
    without: Vec<String>,
    only: Vec<String>,
    twins: u32,
    seed: u64,
    demands: Directives,
    deadline: Deadline,
    command: String,
}

#[pyfunction]
#[pyo3(signature = (question, keywords, progress=None))]
pub fn gap(
    py: Python<'_>,
    question: Question<'_>,
    keywords: Keywords,
    progress: Option<Py<PyAny>>,
) -> PyResult<Answer> {
    let Keywords { without, only, twins, seed, demands, budget_s } = keywords;
    let demands = demands.directives()?;
    let deadline = budget_s.map(deadline).transpose()?.unwrap_or_default();
    let asked = Asked::new(question)?;
    let named = |option: &str, ids: &[String]| match ids {
        [] => String::new(),
        ids => format!(" --{option} {}", ids.join(",")),
    };
    let number = |option: &str, value: u64| if value == 0 { String::new() } else { format!(" --{option} {value}") };
    let command = format!(
        "aibo-fit gap {}{}{}{}{}{}{}",
        asked.words(),
        named("without", &without),
        named("only", &only),
        number("twins", u64::from(twins)),
        number("seed", seed),
        demands::words(&demands),
        budget_s.map_or_else(String::new, |time_s| format!(" --budget {time_s}s"))
    );
    let options = Options { without, only, twins, seed, demands, deadline, command };
    run(py, progress, move |listener| {
        if let Some(both) = options.only.iter().find(|id| options.without.contains(id)) {
            return Err(Failed::of(format!("`{both}` stands in without and in only; leave it out of one")));
        }
        match asked.read()? {
            Subject::Joint(case) => joint(&case, &options, listener),
            Subject::Clamped(setup) => clamped(&setup, &options, listener),
            Subject::Robot(case) => whole(&case, &options, listener),
        }
    })
}

/// So many seconds from now on.
fn deadline(time_s: f64) -> Result<Deadline, Failed> {
    budget(time_s).map(Deadline::within).map_err(|error| Failed::of(format!("budget: {time_s} s, {error}")))
}

fn named(ids: &[String]) -> Result<Vec<NamedCause>, UnknownCause> {
    ids.iter().map(|id| id.parse()).collect()
}

fn of_whole_robot(ids: &[String]) -> Result<Vec<Cause>, Failed> {
    named(ids)?.into_iter().map(|cause| Ok(cause.of_whole_robot()?)).collect()
}

impl Options {
    fn of_joint(&self) -> Result<GapOptions, Failed> {
        Ok(self.with(GapOptions::of_joint(&named(&self.without)?, &named(&self.only)?)?))
    }

    fn of_clamped(&self) -> Result<GapOptions, Failed> {
        Ok(self.with(GapOptions::of_arm(&named(&self.without)?, &named(&self.only)?)?))
    }

    /// The rest of what is asked, beside the causes that are looked for.
    fn with(&self, causes: GapOptions) -> GapOptions {
        let (demands, deadline) = (self.demands.clone(), self.deadline.clone());
        GapOptions { twins: self.twins as usize, seed: self.seed, demands, deadline, ..causes }
    }
}

fn joint(case: &Case, options: &Options, listener: &Listener) -> Result<Answer, Failed> {
    let asked = options.of_joint()?;
    let diagnosis = diagnose(case, &asked, listener).map_err(|error| match error {
        GapError::NeverMoved => Failed::NeverMoved(format!("{}: {error}", case.joint.name)),
        error => Failed::of(error),
    })?;
    let report = GapReport::new(case, diagnosis, asked, provenance(options.command.clone(), case.inputs())?);
    let answer = &report.diagnosis.answer;
    let said = (answer.verdict.name(), answer.sentence.as_str(), answer.probability);
    Ok(Answer::of_diagnosis(said, json_text(&gap_json(&report))?, render_gap_html(&report)?, gap_text(&report)))
}

fn clamped(setup: &ClampedSetup, options: &Options, listener: &Listener) -> Result<Answer, Failed> {
    let asked = options.of_clamped()?;
    let provenance = provenance(options.command.clone(), setup.inputs())?;
    let failed = |error: TorqueError| match error {
        TorqueError::Gap(GapError::NeverMoved) => Failed::NeverMoved(error.to_string()),
        error => Failed::of(error),
    };
    let found = diagnose_setup(setup, &asked, listener).map_err(failed)?;
    let report = ClampedGapReport::new(setup, found, &asked, &provenance);
    let answer = &report.diagnosis.answer;
    let said = (answer.verdict.name(), answer.sentence.as_str(), answer.probability);
    Ok(Answer::of_diagnosis(
        said,
        json_text(&clamped_gap_json(&report)?)?,
        clamped_gap_html(&report)?,
        clamped_gap_text(&report),
    ))
}

fn whole(case: &RobotCase, options: &Options, listener: &Listener) -> Result<Answer, Failed> {
    if options.twins > 0 {
        return Err(Failed::of("twins are for the study of a joint; leave them out"));
    }
    if !options.demands.is_empty() {
        return Err(Failed::of("fix, free, bound and start are for the study of a joint; leave them out"));
    }
    let (without, only) = (of_whole_robot(&options.without)?, of_whole_robot(&options.only)?);
    let asked = RobotOptions { without, only, deadline: options.deadline.clone() };
    let diagnosis = diagnose_robot(case, &asked, &|what| listener.say(what)).map_err(|error| match error {
        RobotGapError::NeverMoved => Failed::NeverMoved(format!("{}: no diagnosis: {error}.", case.robot())),
        error => Failed::of(error),
    })?;
    let report = RobotGapReport::new(case, diagnosis, asked, provenance(options.command.clone(), case.inputs())?);
    let answer = &report.diagnosis.answer;
    let said = (answer.verdict.name(), answer.sentence.as_str(), answer.probability);
    Ok(Answer::of_diagnosis(
        said,
        json_text(&robot_gap_json(&report))?,
        robot_gap_html(&report)?,
        robot_gap_text(&report),
    ))
}
