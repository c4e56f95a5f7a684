//! What logs are like and what they can tell, before any diagnosis: text for a terminal and JSON.

use comfy_table::Cell;
use serde::Serialize;
use std::collections::BTreeMap;

use super::assemble::{health_rows, row};
use super::beliefs::{belief_table, by_number};
use super::gap::json::Threshold;
use super::gap::text::{WIDTH, detectable, paragraph, undetermined};
use super::gap::words::UNDETERMINED;
use super::number::{mrad, significant};
use super::rows::shorten;
use super::text::{finish, number, one_line, table, wrap};
use super::{HashedInput, JointFit, LogHealthRow, Provenance, SCHEMA};
use crate::gap::{BeliefFound, Checkup};
use crate::identify::Case;
use crate::log::Nominal;

/// Characters of a file name.
const NAME: usize = 28;
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
    /// Where the report comes from.
    pub provenance: Provenance,
}

impl CheckReport {
    /// The report of a case.
    pub fn new(case: &Case, checkup: Option<Checkup>, provenance: Provenance) -> Self {
        // A robot's link is computed from its description, and may well hang on an axis that stands upright.
        let is_stated = case.items.iter().flat_map(|item| &item.experiments).all(|e| e.carriage.is_none());
        let stated = case.joint.nominal.filter(|_| is_stated);
        let doubts = stated.and_then(|nominal| long_lever(&nominal)).into_iter().collect();
        Self { joint: case.joint.name.clone(), health: health_rows(case), checkup, doubts, provenance }
    }
}

/// Writes a check as plain text, at most 100 columns wide where file names allow it, ending in a newline.
pub fn check_text(report: &CheckReport) -> String {
    let mut blocks = vec![health(&report.health)];
    blocks.extend(report.doubts.iter().map(|doubt| paragraph(doubt)));
    match &report.checkup {
        None => blocks.push(paragraph(NO_STUDY)),
        Some(checkup) => {
            blocks.push(paragraph(&format!(
                "{}: over the logs to be fitted the model as given leaves {}, with its numbers refitted within their \
                 beliefs {}; the sensor's own noise is {}.",
                report.joint,
                mrad(checkup.given_rad),
                mrad(checkup.calibrated_rad),
                mrad(checkup.floor_rad)
            )));
            blocks.push(numbers(checkup));
            blocks.push(undetermined(&checkup.undetermined).unwrap_or_else(|| {
                paragraph(&format!("{UNDETERMINED}: nothing; of every number they say more than is believed of it."))
            }));
            blocks.extend(detectable(&checkup.detectable));
            if checkup.calibrated_rad > MUCH * checkup.floor_rad {
                blocks.push(paragraph(LEFT));
            }
        }
    }
    blocks.join("\n\n") + "\n"
}

/// The checks of several joints one after the other, each with its name above it; `None`: one that never moved.
pub fn checks_text(joints: &[(&str, Option<&CheckReport>)], notes: &[String]) -> String {
    let mut text = String::new();
    for (name, report) in joints {
        text += &format!("== {name} ==\n");
        text += &match report {
            None => "It never moved: nothing to check.\n".to_owned(),
            Some(CheckReport { health: rows, checkup: None, .. }) => health(rows) + "\n",
            Some(report) => check_text(report),
        };
        text += "\n";
    }
    if joints.iter().any(|(_, report)| report.is_some_and(|report| report.checkup.is_none())) {
        text += &paragraph(NO_STUDY);
        text += "\n";
    }
    notes.iter().for_each(|note| text += &(wrap(WIDTH, note, "- ", "  ") + "\n"));
    text
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

/// One line for each log, then what is odd about it.
fn health(rows: &[LogHealthRow]) -> String {
    let columns = [
        "samples",
        "duration\n[s]",
        "period\n[ms]",
        "jitter\n[ms]",
        "lost",
        "step\n[mrad]",
        "noise\n[mrad]",
        "rests from\n[s]",
    ];
    let mut table = table(WIDTH, &["log", "role"], &columns);
    let milli = |value: f64| number(if value < 1e-9 { "0".to_owned() } else { significant(1e3 * value, 3) });
    let dash = || number("-".to_owned());
    for row in rows {
        table.add_row([
            Cell::new(shorten(&one_line(&row.file), NAME)),
            Cell::new(&row.role),
            number(row.samples.to_string()),
            number(format!("{:.2}", row.duration_s)),
            milli(row.period_s),
            milli(row.jitter_s),
            number(row.lost.to_string()),
            if row.resolution_rad > 0.0 { milli(row.resolution_rad) } else { dash() },
            row.noise_rad.map_or_else(dash, milli),
            row.rest_from_s.map_or_else(dash, |rest| number(format!("{rest:.2}"))),
        ]);
    }
    let mut text = finish(&mut table);
    for row in rows.iter().filter(|row| !row.remarks.is_empty()) {
        let remark = format!("{}: {}.", one_line(&row.file), row.remarks.join("; "));
        text += "\n";
        text += &wrap(WIDTH, &remark, "- ", "  ");
    }
    text
}

/// What is believed of each number, and what these logs make of it.
fn numbers(checkup: &Checkup) -> String {
    let table = belief_table(WIDTH, &checkup.beliefs, |belief| interval(checkup, belief));
    let words = "No effect is added yet: these numbers also take up what one would explain.";
    format!("{table}\n{}", paragraph(words))
}

fn interval(checkup: &Checkup, belief: &BeliefFound) -> Option<[f64; 2]> {
    checkup.parameters.iter().find(|p| p.name == belief.name).and_then(|p| p.interval)
}

/// The check for programs. A number that is not finite becomes null.
pub fn check_json(report: &CheckReport) -> impl Serialize + '_ {
    let provenance = &report.provenance;
    Document {
        schema: SCHEMA,
        name: &report.joint,
        health: &report.health,
        doubts: &report.doubts,
        can_tell: report.checkup.as_ref().map(CanTell::of),
        version: &provenance.version,
        command: &provenance.command,
        inputs: provenance.hashed(),
    }
}

/// The checks of several joints of a robot, by name.
pub fn checks_json<'a>(name: &'a str, reports: &'a [CheckReport]) -> impl Serialize + 'a {
    let joints: BTreeMap<&str, _> = reports.iter().map(|report| (report.joint.as_str(), check_json(report))).collect();
    Several { schema: SCHEMA, name, joints }
}

#[derive(Serialize)]
struct Several<'a, T> {
    schema: u32,
    name: &'a str,
    joints: BTreeMap<&'a str, T>,
}

#[derive(Serialize)]
struct Document<'a> {
    schema: u32,
    name: &'a str,
    health: &'a [LogHealthRow],
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    doubts: &'a [String],
    #[serde(flatten)]
    can_tell: Option<CanTell<'a>>,
    version: &'a str,
    command: &'a str,
    inputs: Vec<HashedInput<'a>>,
}

/// What only a study makes possible to say.
#[derive(Serialize)]
struct CanTell<'a> {
    gap: Sizes,
    joint: JointFit,
    beliefs: BTreeMap<&'a str, &'a BeliefFound>,
    undetermined: &'a [String],
    detectable: BTreeMap<&'static str, Threshold>,
}

/// RMS over the logs to be fitted.
#[derive(Serialize)]
struct Sizes {
    unit: &'static str,
    before: f64,
    calibrated: f64,
    floor: f64,
}

impl<'a> CanTell<'a> {
    fn of(checkup: &'a Checkup) -> Self {
        let rows: Vec<_> = checkup.parameters.iter().map(row).collect();
        Self {
            gap: Sizes {
                unit: "rad",
                before: checkup.given_rad,
                calibrated: checkup.calibrated_rad,
                floor: checkup.floor_rad,
            },
            joint: JointFit::of(&rows),
            beliefs: by_number(&checkup.beliefs),
            undetermined: &checkup.undetermined,
            detectable: checkup.detectable.iter().map(|d| (d.effect.id(), Threshold::of(d))).collect(),
        }
    }
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
