//! The diagnosis, as `aibo-fit gap` makes it.

use crate::answer::{Answer, json_text};
use crate::ask::{Asked, Question, Subject, provenance};
use crate::errors::Failed;
use crate::run::{Listener, run};
use aibo_fit::gap::clamped::{BodyKind, ClampedSetup};
use aibo_fit::gap::inverse::{TorqueError, diagnose_motion, diagnose_torques};
use aibo_fit::gap::robot::{Cause, RobotCase, RobotGapError, RobotOptions, diagnose_robot};
use aibo_fit::gap::{GapError, GapOptions, diagnose};
use aibo_fit::identify::Case;
use aibo_fit::joint::EffectId;
use aibo_fit::log::Predict;
use aibo_fit::report::{
    ClampedGapReport, GapReport, RobotGapReport, clamped_gap_html, clamped_gap_json, clamped_gap_text, gap_json,
    gap_text, render_gap_html, robot_gap_html, robot_gap_json, robot_gap_text,
};
use pyo3::prelude::*;

/// What is asked beside the study.
struct Options {
    without: Vec<String>,
    only: Vec<String>,
    twins: u32,
    seed: u64,
    command: String,
}

#[pyfunction]
#[pyo3(signature = (question, without=vec![], only=vec![], twins=0, seed=0, progress=None))]
pub fn gap(
    py: Python<'_>,
    question: Question<'_>,
    without: Vec<String>,
    only: Vec<String>,
    twins: u32,
    seed: u64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Answer> {
    let asked = Asked::new(question)?;
    let named = |option: &str, ids: &[String]| match ids {
        [] => String::new(),
        ids => format!(" --{option} {}", ids.join(",")),
    };
    let number = |option: &str, value: u64| if value == 0 { String::new() } else { format!(" --{option} {value}") };
    let command = format!(
        "aibo-fit gap {}{}{}{}{}",
        asked.words(),
        named("without", &without),
        named("only", &only),
        number("twins", u64::from(twins)),
        number("seed", seed)
    );
    let options = Options { without, only, twins, seed, command };
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

fn effects(ids: &[String]) -> Result<Vec<EffectId>, Failed> {
    let effect = |id: &String| match id.parse::<Cause>()? {
        Cause::Effect(effect) => Ok(effect),
        other => {
            Err(Failed::of(format!("`{}` is a cause of a whole robot, and this is the study of a joint", other.id())))
        }
    };
    ids.iter().map(effect).collect()
}

impl Options {
    fn of_joint(&self) -> Result<GapOptions, Failed> {
        Ok(GapOptions {
            without: effects(&self.without)?,
            only: effects(&self.only)?,
            twins: self.twins as usize,
            seed: self.seed,
            ..GapOptions::default()
        })
    }

    fn of_clamped(&self) -> Result<GapOptions, Failed> {
        let kinds = [BodyKind::Payload, BodyKind::BodyMass, BodyKind::BodyCom];
        let body = |id: &String| kinds.into_iter().find(|kind| kind.id() == id);
        let without: Vec<String> = self.without.iter().filter(|id| body(id).is_none()).cloned().collect();
        Ok(GapOptions {
            without: effects(&without)?,
            only: effects(&self.only)?,
            without_bodies: self.without.iter().filter_map(body).collect(),
            twins: self.twins as usize,
            seed: self.seed,
            ..GapOptions::default()
        })
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
    let report = match setup.study.predict {
        Predict::Motion => {
            let (case, diagnosis) = diagnose_motion(setup, &asked, listener).map_err(failed)?;
            ClampedGapReport::new(setup, &case, diagnosis, &asked, &provenance)
        }
        Predict::Torque => {
            let diagnosis = diagnose_torques(setup, &asked, listener).map_err(failed)?;
            ClampedGapReport::of_torques(setup, diagnosis, &asked, &provenance)
        }
    };
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
    let causes = |ids: &[String]| ids.iter().map(|id| Ok(id.parse::<Cause>()?)).collect::<Result<Vec<_>, Failed>>();
    let asked =
        RobotOptions { without: causes(&options.without)?, only: causes(&options.only)?, ..RobotOptions::default() };
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
