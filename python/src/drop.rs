//! The fit of swings, as `aibo-fit drop` makes it.

use crate::answer::{Answer, json_text};
use crate::ask::{Asked, Question, Subject, provenance};
use crate::demands::{self, Demands};
use crate::errors::Failed;
use crate::run::run;
use aibo_fit::fit::Method;
use aibo_fit::gap::neighbours::Repeated;
use aibo_fit::identify::{Case, DropError, DropOptions, fit_drop};
use aibo_fit::progress::{Progress, Step};
use aibo_fit::report::{FitFile, FullDrop, drop_report, drop_text, render_html};
use aibo_fit::robot::Model;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Keywords of the Python half.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Keywords {
    joint: Option<String>,
    method: String,
    stribeck: bool,
    lump: bool,
    demands: Demands,
}

#[pyfunction]
#[pyo3(signature = (paths, question, keywords, progress=None))]
pub fn drop(
    py: Python<'_>,
    paths: Vec<PathBuf>,
    question: Question<'_>,
    keywords: Keywords,
    progress: Option<Py<PyAny>>,
) -> PyResult<Answer> {
    let Keywords { joint, method, stribeck, lump, demands } = keywords;
    let directives = demands.directives()?;
    let search = match method.as_str() {
        "lm" => Method::Lm,
        "bfgs" => Method::Bfgs,
        "dfp" => Method::Dfp,
        other => return Err(Failed::of(format!("method `{other}`: expected lm, bfgs or dfp")).into()),
    };
    let asked = if paths.is_empty() { Some(Asked::new(question)?) } else { None };
    let about = match &asked {
        Some(asked) => format!("--study {}", asked.words()),
        None => paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(" "),
    };
    let mut command = format!("aibo-fit drop {about}");
    let more = [
        (joint.is_some(), format!(" --joint {}", joint.as_deref().unwrap_or_default())),
        (method != "lm", format!(" --method {method}")),
        (stribeck, " --stribeck".to_owned()),
        (lump, " --lump".to_owned()),
        (!directives.is_empty(), demands::words(&directives)),
    ];
    command.extend(more.into_iter().filter(|(is_asked, _)| *is_asked).map(|(_, words)| words));
    let options = DropOptions { method: search, stribeck, lump, directives, ..DropOptions::default() };
    run(py, progress, move |listener| {
        let case = match &asked {
            None => Case::of_logs(&paths, joint.as_deref())?,
            Some(asked) => match asked.read()? {
                Subject::Joint(case) => *case,
                _ => return Err(Failed::of("drop fits one joint, and this is the study of a robot")),
            },
        };
        let fit = fit_drop(&case, &options, listener).map_err(|error| match error {
            DropError::NeverMoved => Failed::NeverMoved(format!("{}: {error}", case.joint.name)),
            error => Failed::of(error),
        })?;
        listener.step(Step::stage("the same drop in the whole robot"));
        let repeated = Repeated::of(&case, &fit, Model::ers7())?;
        let mut report = drop_report(&case, &fit, provenance(command, case.inputs())?);
        report.full = repeated.map(FullDrop::of);
        Ok(Answer {
            verdict: None,
            sentence: Some(report.sentence.clone()),
            probability: None,
            percent: None,
            json: json_text(&FitFile::of_drop(&fit, &report))?,
            html: render_html(&report)?,
            text: drop_text(&report),
        })
    })
}
