//! A row of the fleet's table.

use crate::log::Day;
use serde::{Deserialize, Serialize};

/// Where the day of a log is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DayFrom {
    /// `[about] day` of the study.
    Study,
    /// The log's name, or that of a folder.
    Path,
    /// The log's own stamps.
    Stamps,
    /// When the file was last written.
    File,
}

impl DayFrom {
    /// As JSON and Parquet have it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Study => "study",
            Self::Path => "path",
            Self::Stamps => "stamps",
            Self::File => "file",
        }
    }
}

/// How large a cause is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FleetSize {
    /// The parameter of the cause, `T` of a delay; of a calibration the number's name.
    pub parameter: String,
    /// In `unit`.
    pub value: f64,
    /// 95 %; `None`: the logs do not determine it.
    pub interval: Option<[f64; 2]>,
    /// Of value and interval.
    pub unit: String,
}

/// A joint in a log of a study; of a study without an answer the study alone.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FleetRow {
    /// As the user named it.
    pub study: String,
    /// The robot.
    pub robot: Option<String>,
    /// The joint; of a cause of a body that body, of a robot that is judged as a whole its name.
    pub joint: Option<String>,
    /// Whether `joint` is a body, which may have a joint's name.
    #[serde(skip)]
    pub is_body: bool,
    /// The log.
    pub log: Option<String>,
    /// When the log was taken.
    pub day: Option<Day>,
    /// Where that is from.
    pub day_from: Option<DayFrom>,
    /// Since when the joint parts from its model without a day between; `None`: it does not.
    pub since: Option<Day>,
    /// Of the gaps: `rad` or `N m`.
    pub unit: Option<String>,
    /// RMS error of the model as given.
    pub gap_before: Option<f64>,
    /// RMS error with what was found.
    pub gap_after: Option<f64>,
    /// `effect`, `none`, `calibration` or `unexplained`.
    pub verdict: Option<String>,
    /// The causes that were found, by their ids, or the verdict where none has a name.
    pub cause: Option<String>,
    /// How large the first of them is.
    pub size: Option<FleetSize>,
    /// The measured rate at which answers like this were right.
    pub probability: Option<f64>,
    /// What a colleague would say.
    pub sentence: Option<String>,
    /// Why there is no answer.
    pub error: Option<String>,
}

impl FleetRow {
    /// Whether the model as given is not enough.
    pub fn is_off(&self) -> bool {
        self.verdict.as_deref().is_some_and(|verdict| verdict != "none")
    }
}
