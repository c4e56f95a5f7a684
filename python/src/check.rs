//! What logs are like and what they can tell, as `aibo-fit check` says it.

use crate::answer::{Answer, json_text};
use crate::ask::{Asked, Question, Subject, provenance};
use crate::errors::Failed;
use crate::run::{Listener, run};
use aibo_fit::gap::clamped::{ClampedCase, ClampedSetup};
use aibo_fit::gap::{GapError, check as checked};
use aibo_fit::identify::Case;
use aibo_fit::log::Predict;
use aibo_fit::progress::{Progress, Step};
use aibo_fit::report::{
    CheckReport, PREDICTS_TORQUES, Provenance, check_html, check_json, check_text, checks_json, checks_text,
};
use pyo3::prelude::*;

#[pyfunction]
#[pyo3(signature = (question, progress=None))]
pub fn check(py: Python<'_>, question: Question<'_>, progress: Option<Py<PyAny>>) -> PyResult<Answer> {
    let asked = Asked::new(question)?;
    let command = format!("aibo-fit check {}", asked.words());
    run(py, progress, move |listener| match asked.read()? {
        Subject::Joint(case) => joint(&case, provenance(command, case.inputs())?, listener),
        Subject::Clamped(setup) => joints(&setup, &provenance(command, setup.inputs())?, listener),
        Subject::Robot(_) => Err(Failed::of(
            "the study of a walking robot; check looks at the study of a joint or of a robot with scenario = \"fixed\"",
        )),
    })
}

fn moves(case: &Case) -> bool {
    case.items.iter().any(|item| !item.experiments.is_empty())
}

fn report(case: &Case, predict: Predict, provenance: Provenance) -> Result<CheckReport, Failed> {
    let predicts_torques = predict == Predict::Torque;
    // A joint that moved in none of the logs to be fitted has no model to check.
    let checkup = match (!predicts_torques).then(|| checked(case)) {
        None | Some(Err(GapError::NeverMoved)) => None,
        Some(checkup) => Some(checkup?),
    };
    Ok(CheckReport { predicts_torques, ..CheckReport::new(case, checkup, provenance) })
}

fn answer(json: String, html: String, text: String) -> Answer {
    Answer { verdict: None, sentence: None, probability: None, percent: None, json, html, text }
}

fn joint(case: &Case, provenance: Provenance, listener: &Listener) -> Result<Answer, Failed> {
    if !moves(case) {
        return Err(Failed::NeverMoved(format!("{}: nothing to check: the joint never moves", case.joint.name)));
    }
    listener.go_on(Step::stage("what the logs can tell"))?;
    let report = report(case, Predict::Motion, provenance)?;
    let (json, text) = (json_text(&check_json(&report))?, check_text(&report));
    let name = report.joint.clone();
    Ok(answer(json, check_html(&name, &[report], &[])?, text))
}

fn joints(setup: &ClampedSetup, provenance: &Provenance, listener: &Listener) -> Result<Answer, Failed> {
    let ClampedCase { robot, joints, mut notes, .. } = ClampedCase::of(setup)?;
    let predict = setup.study.predict;
    notes.extend((predict == Predict::Torque).then(|| PREDICTS_TORQUES.to_owned()));
    let mut found = Vec::with_capacity(joints.len());
    for (done, joint) in joints.iter().enumerate() {
        listener.go_on(Step { stage: "what the logs can tell", done, of: joints.len() })?;
        let report = moves(&joint.case).then(|| report(&joint.case, predict, provenance.clone())).transpose()?;
        found.push((joint.name.as_str(), report));
    }
    if found.iter().all(|(_, report)| report.is_none()) {
        return Err(Failed::NeverMoved(format!("{robot}: nothing to check: no joint moves")));
    }
    let told: Vec<(&str, Option<&CheckReport>)> = found.iter().map(|(name, report)| (*name, report.as_ref())).collect();
    let (json, text) = (json_text(&checks_json(&robot, &told, &notes))?, checks_text(&told, &notes));
    let reports: Vec<CheckReport> = found.into_iter().filter_map(|(_, report)| report).collect();
    Ok(answer(json, check_html(&robot, &reports, &notes)?, text))
}
