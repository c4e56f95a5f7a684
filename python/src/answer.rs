//! An answer as the program gives it.

use crate::errors::Failed;
use aibo_fit::report::percent_of_answer;
use pyo3::prelude::*;
use serde::Serialize;

/// What was found, in the program's own JSON, page and text.
#[pyclass(frozen, module = "aibo_fit._core")]
pub struct Answer {
    /// `effect`, `none`, `calibration` or `unexplained`; `None` of a fit and a check.
    #[pyo3(get)]
    pub verdict: Option<String>,
    /// What a colleague would say.
    #[pyo3(get)]
    pub sentence: Option<String>,
    /// The measured rate at which an answer like this was right.
    #[pyo3(get)]
    pub probability: Option<f64>,
    /// The same in whole percent, as page and text have it.
    #[pyo3(get)]
    pub percent: Option<String>,
    /// The document, as `--json` writes it.
    #[pyo3(get)]
    pub json: String,
    /// The page, as `report.html` has it.
    #[pyo3(get)]
    pub html: String,
    /// What the program prints.
    #[pyo3(get)]
    pub text: String,
}

impl Answer {
    /// Of a diagnosis: verdict, sentence and probability, document, page and text.
    pub fn of_diagnosis(said: (&str, &str, Option<f64>), json: String, html: String, text: String) -> Self {
        let (verdict, sentence, probability) = said;
        let (verdict, sentence) = (Some(verdict.to_owned()), Some(sentence.to_owned()));
        let percent = probability.map(percent_of_answer);
        Self { verdict, sentence, probability, percent, json, html, text }
    }
}

/// A document as the program writes it.
pub fn json_text(document: &impl Serialize) -> Result<String, Failed> {
    Ok(serde_json::to_string_pretty(document)? + "\n")
}
