//! What logs are like and what they can tell, before any diagnosis: text for a terminal, JSON, and one page.

mod html;
mod json;
mod plot;
mod summary;
mod text;

pub use html::check_html;
pub use json::{check_json, checks_json};
pub use text::{check_text, checks_text};

use super::data_health::health_rows;
use super::number::mrad;
use super::{LogHealthRow, Provenance};
use crate::gap::Checkup;
use crate::identify::{Case, Item};

/// A rest above so many times the sensor's own noise is worth a remark.
const MUCH: f64 = 2.0;
/// What is to be kept in mind where the recalibrated joint leaves a rest.
const LEFT: &str = "The recalibrated joint leaves more than noise: these sizes hold beside what is still to be explained, once it \
     is; `gap` looks for it.";
/// What a study that predicts torques leaves to `gap`.
pub const PREDICTS_TORQUES: &str = "This study predicts torques: no motion is simulated here, and `gap` compares the torques \
     that the measured motion asks for with those that were logged.";
/// What is said where no log has a remark.
const SOUND: &str = "Nothing to remark on these logs: no sample is lost, and stamps are even.";
/// What stands for the numbers of a joint that the fitted logs do not move.
const STILL: &str = "It moved in none of the logs to be fitted: they tell nothing of its numbers.";
/// What a log without a study leaves open.
const NO_STUDY: &str = "What these logs can determine depends on what is believed of the joint: give a study \
     (`aibo-fit init` writes one from the log, to be filled in), and `check` says it.";

/// What is said besides where all that was read are angles.
const UNDRIVEN: &str = "Neither setpoints nor torques were read, only angles: such a log tells of a joint that moves freely. Where a motor \
     moved it, name the column of its setpoint or torque under [columns].";

/// The health of logs, and what they can tell where a study says what is believed.
#[derive(Clone, Debug)]
pub struct CheckReport {
    /// The joint's name.
    pub joint: String,
    /// One row per log.
    pub health: Vec<LogHealthRow>,
    /// `None` without a study, and where the study predicts torques.
    pub checkup: Option<Checkup>,
    /// Whether the study predicts torques along the measured motion, so that no motion is simulated.
    pub predicts_torques: bool,
    /// Numbers of the study that are far from any joint that moves like its logs, in sentences.
    pub doubts: Vec<String>,
    /// Whether a log has setpoints or torques.
    pub is_driven: bool,
    /// What was read and asked, to be drawn; one for each log.
    pub series: Vec<LogSeries>,
    /// Where the report comes from.
    pub provenance: Provenance,
}

/// Readings and setpoints of a log.
#[derive(Clone, Debug)]
pub struct LogSeries {
    /// Stamps of the readings \[s\].
    pub t_s: Vec<f64>,
    /// Readings \[rad\].
    pub q_rad: Vec<f64>,
    /// Stamps of the setpoints \[s\]; empty: none.
    pub asked_s: Vec<f64>,
    /// Setpoints \[rad\].
    pub asked_rad: Vec<f64>,
}

impl LogSeries {
    fn of(item: &Item) -> Self {
        let log = &item.log;
        let (asked_s, asked_rad) = match (&log.setpoints, &log.q_ref_rad) {
            (Some(own), _) => (own.t_s.clone(), own.values.clone()),
            (None, Some(q_ref)) => (log.t_s.clone(), q_ref.clone()),
            (None, None) => (Vec::new(), Vec::new()),
        };
        Self { t_s: log.t_s.clone(), q_rad: log.q_rad.clone(), asked_s, asked_rad }
    }
}

impl CheckReport {
    /// The report of a case.
    pub fn new(case: &Case, checkup: Option<Checkup>, provenance: Provenance) -> Self {
        let series = case.items.iter().map(LogSeries::of).collect();
        let simulated = checkup.iter().flat_map(|checkup| checkup.doubts.iter().cloned());
        let doubts = case.doubts().into_iter().chain(simulated).collect();
        Self {
            joint: case.joint.name.clone(),
            health: health_rows(case),
            checkup,
            predicts_torques: false,
            doubts,
            is_driven: case.items.iter().any(|item| item.log.q_ref_rad.is_some() || item.log.tau_nm.is_some()),
            series,
            provenance,
        }
    }

    /// Whether it is that of a study: not of a log alone, nor of a joint that moved in none of the logs to be fitted.
    pub fn is_of_study(&self) -> bool {
        self.checkup.is_some() || self.predicts_torques
    }
}

/// Whether no log has a remark, nor anything of the study is to be questioned.
fn are_sound(joints: &[(&str, Option<&CheckReport>)]) -> bool {
    joints.iter().filter_map(|(_, report)| *report).all(|report| {
        report.doubts.is_empty() && report.health.iter().all(|log| log.remarks.is_empty() && log.lost == 0)
    })
}

/// What logs without a study leave open.
fn without_study<'a>(mut reports: impl Iterator<Item = &'a CheckReport>) -> String {
    if reports.any(|report| report.is_driven) { NO_STUDY.to_owned() } else { format!("{UNDRIVEN} {NO_STUDY}") }
}

/// How far the model is off.
fn sizes(joint: &str, checkup: &Checkup) -> String {
    let [given, calibrated, floor] = [checkup.given_rad, checkup.calibrated_rad, checkup.floor_rad].map(mrad);
    let given = if checkup.given_rad.is_finite() {
        format!("leaves {given}, with its numbers refitted within their beliefs")
    } else {
        "runs away; with its numbers refitted within their beliefs it leaves".to_owned()
    };
    format!(
        "{joint}: over the logs to be fitted the model as given {given} {calibrated}; the sensor's own noise is {floor}."
    )
}

/// Whether the recalibrated joint leaves more than noise.
fn left(checkup: &Checkup) -> bool {
    checkup.calibrated_rad > MUCH * checkup.floor_rad
}
