//! `check --json`.

use serde::Serialize;
use std::collections::BTreeMap;

use super::CheckReport;
use crate::gap::Checkup;
use crate::identify::BeliefFound;
use crate::report::assemble::row;
use crate::report::beliefs::by_number;
use crate::report::gap::json::Threshold;
use crate::report::{HashedInput, JointFit, LogHealthRow, SCHEMA};

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

/// The checks of several joints of a robot, by name; `None`: one that never moved.
pub fn checks_json<'a>(
    name: &'a str,
    joints: &[(&'a str, Option<&'a CheckReport>)],
    notes: &'a [String],
) -> impl Serialize + 'a {
    let checked = joints.iter().filter_map(|(name, report)| Some((*name, check_json((*report)?))));
    let still = joints.iter().filter(|(_, report)| report.is_none()).map(|(name, _)| *name).collect();
    Several { schema: SCHEMA, name, joints: checked.collect::<BTreeMap<_, _>>(), still, notes }
}

#[derive(Serialize)]
struct Several<'a, T> {
    schema: u32,
    name: &'a str,
    joints: BTreeMap<&'a str, T>,
    still: Vec<&'a str>,
    notes: &'a [String],
}

#[derive(Serialize)]
struct Document<'a> {
    schema: u32,
    name: &'a str,
    health: &'a [LogHealthRow],
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
