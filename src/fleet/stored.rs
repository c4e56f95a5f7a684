//! The file of an answer.

use super::find::Found;
use super::inputs::Inputs;
use super::{FleetOptions, Outcome, whose};
use crate::log::Day;
use crate::report::DayFrom;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Of the file's form.
const SCHEMA: u32 = 1;

/// What came of a study, and what it depends on.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Stored {
    schema: u32,
    study: String,
    /// Version, options and inputs in one number.
    key: String,
    version: String,
    /// After `aibo-fit gap STUDY`.
    options: Vec<String>,
    inputs: Inputs,
    /// Days of the logs by name.
    pub days: BTreeMap<String, (Day, DayFrom)>,
    pub failed: Option<Failed>,
    pub answer: Option<Value>,
}

/// Why there is no answer.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Failed {
    pub why: String,
    /// Whether another try may have another outcome.
    pub again: bool,
}

impl Stored {
    pub fn of(found: &Found, options: &FleetOptions, inputs: &Inputs, outcome: Outcome) -> Self {
        let failed = |why, again| (None, Some(Failed { why, again }));
        let (answer, failed) = match outcome {
            Outcome::Answer(document) => (Some(*document), None),
            Outcome::None(why) => failed(why, false),
            Outcome::Lost(why) => failed(why, true),
        };
        let inputs = answer.as_ref().map_or_else(|| inputs.clone(), |document| inputs.with_read(document));
        let (version, options) = (env!("CARGO_PKG_VERSION").to_owned(), options.words());
        Self {
            schema: SCHEMA,
            study: found.path.display().to_string(),
            key: crate::log::sha256(format!("{version}\0{}\0{}", options.join(" "), inputs.digest()).as_bytes()),
            version,
            options,
            inputs,
            days: answer.as_ref().map(|document| whose::days(found, document)).unwrap_or_default(),
            failed,
            answer,
        }
    }

    /// The file of an answer; `None`: there is none, or nothing that can be read.
    pub fn read(file: &Path) -> Option<Self> {
        serde_json::from_slice(&std::fs::read(file).ok()?).ok()
    }

    /// Whether it is still the answer to this study.
    pub fn holds(&self, study: &Path, options: &FleetOptions, now: &Inputs) -> bool {
        self.schema == SCHEMA
            && self.study == study.display().to_string()
            && self.version == env!("CARGO_PKG_VERSION")
            && self.options == options.words()
            && !self.failed.as_ref().is_some_and(|failed| failed.again)
            && (self.failed.is_some() || self.answer.is_some())
            && self.inputs.hold(now)
    }
}
