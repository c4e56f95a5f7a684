//! The joints of a robot at a glance, before the checks of each.

use super::CheckReport;
use crate::gap::Checkup;
use crate::report::by_joint::by_joint;
use crate::report::grid::Grid;
use crate::report::number::significant;

/// What the columns mean.
pub(super) const COLUMNS: &str = "As given, recalibrated: error of the model over the logs to be fitted, with the study's numbers and \
     with numbers refitted within their beliefs. Noise: the sensor's own. Remarks: how many there are on its logs, below. Not \
     told: numbers, or combinations of them, that these logs do not determine, below.";

/// One row for each joint; `None` where there is one joint only, or nothing is believed of any.
pub(super) fn summary(joints: &[(&str, Option<&CheckReport>)]) -> Option<Grid> {
    let is_told = joints.iter().any(|(_, report)| report.is_some_and(|report| report.checkup.is_some()));
    (is_told && joints.len() > 1).then(|| Grid {
        name: "joint",
        numbers: vec!["as given\n[mrad]", "recalibrated\n[mrad]", "noise\n[mrad]", "remarks", "not\ntold"],
        rows: joints.iter().map(|(name, report)| ((*name).to_owned(), row(*report))).collect(),
    })
}

fn row(report: Option<&CheckReport>) -> Vec<String> {
    let checkup = report.and_then(|report| report.checkup.as_ref());
    let size = |of: fn(&Checkup) -> f64| checkup.map_or_else(dash, |checkup| mrad_or_away(of(checkup)));
    let remarks = |report: &CheckReport| report.health.iter().map(|log| log.remarks.len()).sum::<usize>().to_string();
    let given = if report.is_none() { "never moved".to_owned() } else { size(|checkup| checkup.given_rad) };
    vec![
        given,
        size(|checkup| checkup.calibrated_rad),
        size(|checkup| checkup.floor_rad),
        report.map_or_else(dash, remarks),
        checkup.map_or_else(dash, |checkup| checkup.undetermined.len().to_string()),
    ]
}

fn mrad_or_away(rad: f64) -> String {
    if rad.is_finite() { significant(1e3 * rad, 3) } else { "runs away".to_owned() }
}

fn dash() -> String {
    "–".to_owned()
}

/// What is to be questioned of the study, each once, with the joints that it is true of.
pub(super) fn doubts(joints: &[(&str, Option<&CheckReport>)]) -> Vec<String> {
    let told = joints.iter().filter_map(|(name, report)| Some((*name, (*report)?)));
    by_joint(told.flat_map(|(name, report)| report.doubts.iter().map(move |doubt| (name, doubt.as_str()))))
}
