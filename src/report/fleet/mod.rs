//! Many studies together: which joints of which robots part from their models, since when.
//!
//! A [`FleetRow`] is a joint in a log of a study, told from what `gap --json` says; a [`JointTrend`] is a joint through
//! time. Nothing is computed here but what the table holds.

mod html;
mod json;
mod parquet;
mod read;
mod rows;
#[cfg(test)]
mod tests;
mod text;
mod trend;

pub use html::fleet_html;
pub use json::fleet_json;
pub use parquet::fleet_parquet;
pub use rows::{DayFrom, FleetRow, FleetSize};
pub use text::fleet_text;
pub use trend::{JointTrend, TrendPoint};

use serde_json::Value;
use std::collections::BTreeMap;

use crate::log::Day;

/// A study with its answer.
#[derive(Clone, Debug)]
pub struct FleetStudy {
    /// As the user named it.
    pub study: String,
    /// The robot, where its study, its folder or its description names one.
    pub robot: Option<String>,
    /// Days of its logs by name, and where they are from.
    pub days: BTreeMap<String, (Day, DayFrom)>,
    /// What `gap --json` says, or why there is no answer.
    pub answer: Result<Value, String>,
    /// Its own page, relative to the fleet's.
    pub page: Option<String>,
}

/// Everything that the fleet's table, page and text show.
#[derive(Clone, Debug)]
pub struct FleetReport {
    /// A row for each joint in each log, and one for each study without an answer.
    pub rows: Vec<FleetRow>,
    /// Joints through time, those that part from their models first, the largest gap first.
    pub joints: Vec<JointTrend>,
    /// The studies' own pages, relative to the fleet's, by study.
    pub pages: BTreeMap<String, String>,
    /// How many studies there are.
    pub studies: usize,
    /// Version of the program.
    pub version: String,
    /// The command that asks the same.
    pub command: String,
}

impl FleetReport {
    /// Puts the answers of studies together.
    pub fn new(studies: &[FleetStudy], version: &str, command: &str) -> Self {
        let mut rows: Vec<FleetRow> = studies.iter().flat_map(read::rows).collect();
        let other_bodies: Vec<FleetRow> = studies.iter().filter_map(read::of_other_bodies).collect();
        let joints = trend::joints(&rows, &other_bodies);
        for row in &mut rows {
            row.since = joints.iter().find(|joint| joint.has(row)).and_then(|joint| joint.since);
        }
        let pages = studies.iter().filter_map(|study| Some((study.study.clone(), study.page.clone()?))).collect();
        Self { rows, joints, pages, studies: studies.len(), version: version.to_owned(), command: command.to_owned() }
    }

    /// Studies without an answer, and why.
    pub fn failed(&self) -> impl Iterator<Item = (&str, &str)> {
        self.rows.iter().filter_map(|row| Some((row.study.as_str(), row.error.as_deref()?)))
    }

    /// Joints whose latest study parts from the model.
    pub fn off(&self) -> impl Iterator<Item = &JointTrend> {
        self.joints.iter().filter(|joint| joint.is_off())
    }

    /// What a colleague would say.
    pub fn sentence(&self) -> String {
        let (failed, off) = (self.failed().count(), self.off().count());
        let answered = match failed {
            0 if self.studies == 1 => "1 study is answered".to_owned(),
            0 => format!("{} studies are answered", self.studies),
            failed => format!("{} of {} studies are answered", self.studies - failed, self.studies),
        };
        let robots = |joints: &mut dyn Iterator<Item = &JointTrend>| {
            let names: std::collections::BTreeSet<_> = joints.map(|joint| &joint.robot).collect();
            names.len()
        };
        let of = match robots(&mut self.joints.iter()) {
            0 => return format!("{answered}."),
            1 if self.joints.len() == 1 => "1 joint".to_owned(),
            1 => format!("{} joints", self.joints.len()),
            all => format!("{} joints of {all} robots", self.joints.len()),
        };
        match off {
            0 => format!("{answered}; none of {of} parts from its model."),
            1 => format!("{answered}; 1 of {of} parts from its model."),
            off => format!("{answered}; {off} of {of} part from their models."),
        }
    }
}
