//! `gap --json` of a robot study: the contract of the specification's section 6, every key always there, and what goes
//! beyond it.

use super::RobotGapReport;
use crate::deadline::Spent;
use crate::gap::robot::{
    Cause, Change, Found, GaitCell, GaitPhase, RobotCandidate, RobotDetectable, RobotGap, RobotStage, RobotWhere,
};
use crate::gap::{BeliefFound, Variable, Verdict};
use crate::report::gap::json::{Proposal, Threshold};
use crate::report::gap::quantities;
use crate::report::{HashedInput, JointFit, Quantity, SCHEMA};
use serde::Serialize;
use std::collections::BTreeMap;

/// The diagnosis for programs. A number that is not finite becomes null.
pub fn robot_gap_json(report: &RobotGapReport) -> impl Serialize + '_ {
    let RobotGapReport { diagnosis, options, joints, logs, provenance, .. } = report;
    let answer = &diagnosis.answer;
    let id = |found: &Option<Found>| found.as_ref().map(|found| found.cause);
    let health = |row: &super::LogRow| Health {
        file: row.file.clone(),
        role: row.role.clone(),
        samples: row.samples,
        duration_s: row.duration_s,
        joints: row.joints,
    };
    Document {
        schema: SCHEMA,
        name: &diagnosis.robot,
        scenario: diagnosis.scenario.word(),
        verdict: answer.verdict,
        effect: id(&answer.first),
        second: id(&answer.second),
        second_joints: answer.second.as_ref().map(|found| found.joints.as_slice()),
        equivalent: &answer.equivalent,
        places: &answer.places,
        probability: answer.probability,
        sentence: &answer.sentence,
        place: Place::of(&diagnosis.location),
        gap: Gap { found: &diagnosis.gap, outer: None },
        ranking: diagnosis.ranking.iter().map(Ranked::of).collect(),
        detectable: diagnosis.detectable.iter().map(|d| (d.cause.id(), threshold(d))).collect(),
        law: None,
        undetermined: [],
        joint: JointFit::of(&[]),
        next: diagnosis.next.as_ref().map(Proposal::of),
        probability_source: &answer.probability_source,
        standing: &answer.standing,
        partial: id(&answer.partial),
        partial_joints: answer.partial.as_ref().map(|found| found.joints.as_slice()),
        intervals_trusted: answer.intervals_trusted,
        effects: answer.first.iter().chain(&answer.second).map(Effect::of).collect(),
        beliefs: diagnosis.beliefs.iter().map(|belief| (belief.name.as_str(), belief)).collect(),
        changes: diagnosis.changes.iter().map(|change| Changed::of(change, joints)).collect(),
        repaired: Repaired { file: report.repaired_file(), rms: diagnosis.repaired_rms_rad() },
        confusion: None,
        notes: &diagnosis.notes,
        health: logs.iter().map(health).collect(),
        withheld: &diagnosis.withheld,
        only: &options.only,
        twins: 0,
        seed: 0,
        budget: diagnosis.budget.as_ref(),
        version: &provenance.version,
        command: &provenance.command,
        inputs: provenance.hashed(),
    }
}

fn threshold(detectable: &RobotDetectable) -> Threshold {
    Threshold { value: detectable.value, unit: detectable.unit, parameter: detectable.name }
}

#[derive(Serialize)]
struct Document<'a> {
    schema: u32,
    name: &'a str,
    scenario: &'static str,
    verdict: Verdict,
    effect: Option<Cause>,
    second: Option<Cause>,
    second_joints: Option<&'a [String]>,
    equivalent: &'a [Cause],
    places: &'a [Vec<String>],
    probability: Option<f64>,
    sentence: &'a str,
    #[serde(rename = "where")]
    place: Place<'a>,
    gap: Gap<'a>,
    ranking: Vec<Ranked<'a>>,
    detectable: BTreeMap<&'static str, Threshold>,
    /// Laws, and what logs cannot determine, are told of joints and arms.
    law: Option<()>,
    undetermined: [(); 0],
    joint: JointFit,
    next: Option<Proposal<'a>>,
    probability_source: &'a str,
    standing: &'a str,
    partial: Option<Cause>,
    partial_joints: Option<&'a [String]>,
    intervals_trusted: bool,
    effects: Vec<Effect<'a>>,
    beliefs: BTreeMap<&'a str, &'a BeliefFound>,
    changes: Vec<Changed<'a>>,
    repaired: Repaired,
    /// Twins are of joint studies.
    confusion: Option<()>,
    notes: &'a [String],
    health: Vec<Health>,
    withheld: &'a [Cause],
    only: &'a [Cause],
    twins: usize,
    seed: u64,
    /// What became of the time, where that was limited: of all keys the one that is there only then.
    #[serde(skip_serializing_if = "Option::is_none")]
    budget: Option<&'a Spent>,
    version: &'a str,
    command: &'a str,
    inputs: Vec<HashedInput<'a>>,
}

#[derive(Serialize)]
struct Gap<'a> {
    #[serde(flatten)]
    found: &'a RobotGap,
    /// Told of joints and arms.
    outer: Option<bool>,
}

#[derive(Serialize)]
struct Place<'a> {
    joints: &'a [String],
    stage: Option<RobotStage>,
    variable: Option<Variable>,
    range: Option<[f64; 2]>,
    phase: Option<GaitPhase>,
    logs: &'a [String],
    share: f64,
    cells: &'a [GaitCell],
}

impl<'a> Place<'a> {
    fn of(location: &'a RobotWhere) -> Self {
        Self {
            joints: &location.joints,
            stage: location.stage,
            variable: location.variable,
            range: location.range.filter(|ends| ends.iter().all(|end| end.is_finite())),
            phase: location.phase,
            logs: &location.logs,
            share: location.share,
            cells: &location.cells,
        }
    }
}

#[derive(Serialize)]
struct Ranked<'a> {
    effect: Cause,
    joints: &'a [String],
    probability: f64,
    after: f64,
    closed: Option<f64>,
    parameters: BTreeMap<String, Quantity>,
    /// In units of a noise variance.
    behind: f64,
}

impl<'a> Ranked<'a> {
    fn of(candidate: &'a RobotCandidate) -> Self {
        let Found { cause, joints, parameters } = &candidate.found;
        Self {
            effect: *cause,
            joints,
            probability: candidate.probability,
            after: candidate.after,
            closed: candidate.closed,
            parameters: quantities(parameters),
            behind: candidate.behind,
        }
    }
}

#[derive(Serialize)]
struct Effect<'a> {
    id: Cause,
    /// A robot that walks has effects in their default forms, and its causes are not taken out one by one.
    form: Option<()>,
    joints: &'a [String],
    parameters: BTreeMap<String, Quantity>,
    alone: Option<f64>,
    last: Option<f64>,
    after: Option<f64>,
}

impl<'a> Effect<'a> {
    fn of(found: &'a Found) -> Self {
        Self {
            id: found.cause,
            form: None,
            joints: &found.joints,
            parameters: quantities(&found.parameters),
            alone: None,
            last: None,
            after: None,
        }
    }
}

/// What the repaired robot has that the study's has not.
#[derive(Serialize)]
struct Changed<'a> {
    id: Cause,
    joints: Vec<&'a str>,
    values: BTreeMap<&'static str, f64>,
}

impl<'a> Changed<'a> {
    fn of(change: &Change, names: &'a [String]) -> Self {
        let named = change.cause.named().into_iter().map(|(name, _)| name);
        Self {
            id: change.cause,
            joints: change.place.joints.iter().filter_map(|joint| names.get(*joint).map(String::as_str)).collect(),
            values: named.zip(change.values.iter().copied()).collect(),
        }
    }
}

/// The repaired robot's file, where there is one, and what that robot leaves over the held-out samples \[rad RMS\]: with the changes and nothing adapted.
#[derive(Serialize)]
struct Repaired {
    file: Option<&'static str>,
    rms: Option<f64>,
}

#[derive(Serialize)]
struct Health {
    file: String,
    role: String,
    samples: usize,
    duration_s: f64,
    joints: usize,
}
