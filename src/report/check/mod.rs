//! What logs are like and what they can tell, before any diagnosis: text for a terminal, JSON, and one page.

mod html;
mod json;
mod plot;
mod text;

pub use html::check_html;
pub use json::{check_json, checks_json};
pub use text::{check_text, checks_text};

use super::data_health::health_rows;
use super::number::mrad;
use super::{LogHealthRow, Provenance};
use crate::gap::Checkup;
use crate::identify::{Case, Item};
use crate::log::Nominal;

/// A rest above so many times the sensor's own noise is worth a remark.
const MUCH: f64 = 2.0;
/// No link swings like a pendulum longer than this \[m\].
const LONGEST_M: f64 = 10.0;
/// What is to be kept in mind where the recalibrated joint leaves a rest.
const LEFT: &str = "The recalibrated joint leaves more than noise: these sizes hold beside what is still to be explained, once it \
     is; `gap` looks for it.";
/// What a log without a study leaves open.
const NO_STUDY: &str = "What these logs can determine depends on what is believed of the joint: give a study (STUDY.toml with \
     [joint] inertia, moment, coulomb and viscous, and the logs), and `check` says it.";

/// The health of logs, and what they can tell where a study says what is believed.
#[derive(Clone, Debug)]
pub struct CheckReport {
    /// The joint's name.
    pub joint: String,
    /// One row per log.
    pub health: Vec<LogHealthRow>,
    /// `None` without a study.
    pub checkup: Option<Checkup>,
    /// Numbers of the study that cannot be right, in sentences.
    pub doubts: Vec<String>,
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
        // A robot's link is computed from its description, and may well hang on an axis that stands upright.
        let is_stated = case.items.iter().flat_map(|item| &item.experiments).all(|e| e.carriage.is_none());
        let stated = case.joint.nominal.filter(|_| is_stated);
        let doubts = stated.and_then(|nominal| long_lever(&nominal)).into_iter().collect();
        let series = case.items.iter().map(LogSeries::of).collect();
        Self { joint: case.joint.name.clone(), health: health_rows(case), checkup, doubts, series, provenance }
    }
}

/// How far the model is off.
fn sizes(joint: &str, checkup: &Checkup) -> String {
    let [given, calibrated, floor] = [checkup.given_rad, checkup.calibrated_rad, checkup.floor_rad].map(mrad);
    format!(
        "{joint}: over the logs to be fitted the model as given leaves {given}, with its numbers refitted within their \
         beliefs {calibrated}; the sensor's own noise is {floor}."
    )
}

/// Whether the recalibrated joint leaves more than noise.
fn left(checkup: &Checkup) -> bool {
    checkup.calibrated_rad > MUCH * checkup.floor_rad
}

/// What a link's inertia would say of its length, where no link is that long.
fn long_lever(nominal: &Nominal) -> Option<String> {
    let length_m = nominal.inertia_kg_m2 / nominal.moment_kg_m;
    (length_m.is_finite() && length_m > LONGEST_M).then(|| {
        format!(
            "The stated inertia and moment are those of a pendulum of {length_m:.0} m (inertia / moment): is the inertia in \
             kg m^2 and the moment in kg m, or is a geared rotor in it (`armature` in [motor])?"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inertia_that_no_link_has_is_doubted() {
        let nominal =
            |inertia_kg_m2| Nominal { inertia_kg_m2, moment_kg_m: 5e-3, coulomb_nm: 0.0, viscous_nm_s_rad: 0.0 };
        assert_eq!(long_lever(&nominal(9e-4)), None);
        let doubt = long_lever(&nominal(1.0)).unwrap();
        assert!(doubt.contains("200 m"), "{doubt}");
        assert_eq!(long_lever(&Nominal { moment_kg_m: 0.0, ..nominal(1.0) }), None);
    }
}
