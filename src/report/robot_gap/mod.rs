//! The report of a robot's diagnosis: which joint or which part of the floor, in which phase of the gait, which cause,
//! how far the gap closes.
//!
//! The same report as for a joint (`report::gap`), for a whole robot: [`robot_gap_json`] has every key of the
//! specification's section 6 and more, [`robot_gap_text`] is for a terminal, [`robot_gap_html`] is one page with the map
//! drawn on the robot.

mod animation;
mod html;
mod json;
mod plot;
mod repaired;
#[cfg(test)]
pub(super) mod sample;
#[cfg(test)]
mod tests;
mod text;
mod waterfall;
mod words;

pub use animation::robot_gap_animation;
pub use html::robot_gap_html;
pub use json::robot_gap_json;
pub use plot::{Sketch, robot_gap_figures};
pub use repaired::{REPAIRED_FILE, repaired_robot};
pub use text::robot_gap_text;

use super::Provenance;
use crate::gap::robot::{RobotCase, RobotDiagnosis, RobotOptions};
use crate::log::Role;

/// A robot's diagnosis with what was asked and where it comes from.
#[derive(Clone, Debug)]
pub struct RobotGapReport {
    /// What was found.
    pub diagnosis: RobotDiagnosis,
    /// What was asked.
    pub options: RobotOptions,
    /// Names of the robot's joints, in its order.
    pub joints: Vec<String>,
    /// Logs in the study's order.
    pub logs: Vec<LogRow>,
    /// The robot from above.
    pub sketch: Sketch,
    /// Files that stand beside the page, each with what it is.
    pub beside: Vec<(String, String)>,
    /// Half a step of the position sensors \[rad\]; 0 where it is unknown.
    pub half_step_rad: f64,
    /// Where the report comes from.
    pub provenance: Provenance,
}

/// What there is to say of a log before it is compared.
#[derive(Clone, Debug, PartialEq)]
pub struct LogRow {
    /// As the study names it.
    pub file: String,
    /// `fit` or `validate`.
    pub role: String,
    /// Number of samples.
    pub samples: usize,
    /// Last time less first \[s\].
    pub duration_s: f64,
    /// Joints that are compared.
    pub joints: usize,
}

impl RobotGapReport {
    /// The repaired robot's file, where one stands beside the page.
    pub fn repaired_file(&self) -> Option<&'static str> {
        self.beside.iter().any(|(file, _)| file == REPAIRED_FILE).then_some(REPAIRED_FILE)
    }

    /// The report of a case's diagnosis.
    pub fn new(case: &RobotCase, diagnosis: RobotDiagnosis, options: RobotOptions, provenance: Provenance) -> Self {
        let row = |entry: &crate::log::RobotStudyLog| {
            let traces: Vec<_> = diagnosis.traces.iter().filter(|trace| trace.file == entry.file).collect();
            let t_s = traces.first().map_or(&[][..], |trace| &trace.t_s);
            LogRow {
                file: entry.file.clone(),
                role: if entry.role == Role::Validate { "validate" } else { "fit" }.to_owned(),
                samples: t_s.len(),
                duration_s: t_s.last().zip(t_s.first()).map_or(0.0, |(last, first)| last - first),
                joints: traces.len(),
            }
        };
        Self {
            joints: case.names.clone(),
            logs: case.study.logs.iter().map(row).collect(),
            sketch: Sketch::of(&case.nominal.model),
            beside: Vec::new(),
            half_step_rad: 0.5 * case.study.sensor.resolution_rad.unwrap_or(0.0),
            diagnosis,
            options,
            provenance,
        }
    }
}
