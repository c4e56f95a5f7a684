//! `gap --json`: the contract of the specification's section 6, every key always there, and what goes beyond it.

use super::GapReport;
use super::fit::{joint, quantities};
use super::waterfall::{Step, steps};
use super::words::ids;
use crate::deadline::Spent;
use crate::gap::{
    BeliefFound, Candidate, CauseShare, Confusion, Detectable, Diagnosis, Differs, Gap, LawFound, MapCell, Next, Phase,
    ProfileBin, Variable, Verdict, Where,
};
use crate::identify::Directives;
use crate::joint::{EffectId, LawTable, Stage};
use crate::report::beliefs::by_number;
use crate::report::{HashedInput, JointFit, LogHealthRow, Quantity, SCHEMA};
use serde::Serialize;
use std::collections::BTreeMap;

/// The diagnosis for programs. A number that is not finite becomes null.
pub fn gap_json(report: &GapReport) -> impl Serialize + '_ {
    let GapReport { diagnosis, options, health, provenance, .. } = report;
    let joint = joint(report);
    let answer = &diagnosis.answer;
    Document {
        schema: SCHEMA,
        name: &diagnosis.joint,
        verdict: answer.verdict,
        effect: answer.effect.as_deref(),
        second: answer.second,
        equivalent: &answer.equivalent,
        probability: answer.probability,
        sentence: &answer.sentence,
        place: Place::of(&diagnosis.joint, &diagnosis.location),
        gap: Closing::of(diagnosis),
        ranking: diagnosis.ranking.iter().map(Ranked::of).collect(),
        detectable: diagnosis.detectable.iter().map(|d| (d.effect.id(), Threshold::of(d))).collect(),
        joint,
        next: diagnosis.next.as_ref().map(Proposal::of),
        probability_source: &answer.probability_source,
        standing: &answer.standing,
        partial: answer.partial,
        intervals_trusted: answer.intervals_trusted,
        effects: effects(diagnosis),
        law: diagnosis.law.as_ref().map(Law::of),
        undetermined: &diagnosis.undetermined,
        beliefs: by_number(&diagnosis.beliefs),
        differs: &diagnosis.differs,
        confusion: diagnosis.confusion.as_ref(),
        notes: &diagnosis.notes,
        health,
        doubts: &diagnosis.doubts,
        withheld: &diagnosis.withheld,
        only: ids(&options.only, &options.only_bodies),
        twins: options.twins,
        seed: options.seed,
        demands: Demands::of(&diagnosis.demands),
        budget: diagnosis.budget.as_ref(),
        version: &provenance.version,
        command: &provenance.command,
        inputs: provenance.hashed(),
    }
}

#[derive(Serialize)]
struct Document<'a> {
    schema: u32,
    name: &'a str,
    verdict: Verdict,
    effect: Option<&'a str>,
    second: Option<EffectId>,
    equivalent: &'a [EffectId],
    probability: Option<f64>,
    sentence: &'a str,
    #[serde(rename = "where")]
    place: Place<'a>,
    gap: Closing<'a>,
    ranking: Vec<Ranked>,
    detectable: BTreeMap<&'static str, Threshold>,
    joint: JointFit,
    next: Option<Proposal<'a>>,
    probability_source: &'a str,
    standing: &'a str,
    partial: Option<EffectId>,
    intervals_trusted: bool,
    effects: Vec<Found<'a>>,
    /// A cause without a name.
    law: Option<Law<'a>>,
    undetermined: &'a [String],
    beliefs: BTreeMap<&'a str, &'a BeliefFound>,
    differs: &'a [Differs],
    confusion: Option<&'a Confusion>,
    notes: &'a [String],
    health: &'a [LogHealthRow],
    doubts: &'a [String],
    withheld: &'a [EffectId],
    only: Vec<&'static str>,
    twins: usize,
    seed: u64,
    demands: Demands<'a>,
    /// What became of the time, where that was limited: of all keys the one that is there only then.
    #[serde(skip_serializing_if = "Option::is_none")]
    budget: Option<&'a Spent>,
    version: &'a str,
    command: &'a str,
    inputs: Vec<HashedInput<'a>>,
}

/// What the user demanded, by name; a number that is held as given has null.
#[derive(Serialize)]
struct Demands<'a> {
    fix: BTreeMap<&'a str, Option<f64>>,
    free: &'a [String],
    bound: BTreeMap<&'a str, [f64; 2]>,
    start: BTreeMap<&'a str, f64>,
}

impl<'a> Demands<'a> {
    fn of(demands: &'a Directives) -> Self {
        Self {
            fix: demands.fix.iter().map(|(name, value)| (name.as_str(), *value)).collect(),
            free: &demands.free,
            bound: demands.bound.iter().map(|(name, range)| (name.as_str(), *range)).collect(),
            start: demands.start.iter().map(|(name, value)| (name.as_str(), *value)).collect(),
        }
    }
}

/// A law with what it leaves.
#[derive(Serialize)]
struct Law<'a> {
    #[serde(flatten)]
    table: &'a LawTable,
    /// Standard deviations of the table's values.
    sd: Option<&'a [f64]>,
    after: f64,
}

impl<'a> Law<'a> {
    fn of(law: &'a LawFound) -> Self {
        Self { table: &law.table, sd: law.sd.as_deref(), after: law.after }
    }
}

#[derive(Serialize)]
struct Place<'a> {
    joints: [&'a str; 1],
    stage: Option<Stage>,
    variable: Option<Variable>,
    range: Option<[f64; 2]>,
    phase: Option<Phase>,
    logs: &'a [String],
    share: f64,
    cells: &'a [MapCell],
    variables: Vec<Explained>,
    profile: &'a [ProfileBin],
}

/// What a variable explains of the residual torque's variance.
#[derive(Serialize)]
struct Explained {
    variable: Variable,
    unit: &'static str,
    share: f64,
}

impl<'a> Place<'a> {
    fn of(joint: &'a str, location: &'a Where) -> Self {
        Self {
            joints: [joint],
            stage: location.stage,
            variable: location.variable,
            range: location.range.filter(|ends| ends.iter().all(|end| end.is_finite())),
            phase: location.phase,
            logs: &location.logs,
            share: location.share,
            cells: &location.cells,
            variables: location
                .variables
                .iter()
                .map(|&(variable, share)| Explained { variable, unit: variable.unit(), share })
                .collect(),
            profile: &location.profile,
        }
    }
}

/// How far the gap closes, with the steps of the waterfall.
#[derive(Serialize)]
struct Closing<'a> {
    #[serde(flatten)]
    gap: &'a Gap,
    waterfall: Vec<Rung>,
}

/// RMS after a step, in the gap's unit.
#[derive(Serialize)]
struct Rung {
    step: &'static str,
    rms: f64,
}

impl<'a> Closing<'a> {
    fn of(diagnosis: &'a Diagnosis) -> Self {
        let rung = |step: Step<'_>| Rung { step: step.name, rms: step.rms };
        Self { gap: &diagnosis.gap, waterfall: steps(diagnosis).into_iter().map(rung).collect() }
    }
}

/// All causes: those of the waterfall, and the drive's gain where it is named.
fn effects(diagnosis: &Diagnosis) -> Vec<Found<'_>> {
    let causes = diagnosis.causes.iter().map(|cause| Found::of(&diagnosis.joint, cause));
    causes.chain(Found::gain(diagnosis)).collect()
}

/// One cause, in the order of the waterfall.
#[derive(Serialize)]
struct Found<'a> {
    id: EffectId,
    /// Null where the family has one form only.
    form: Option<&'static str>,
    joints: [&'a str; 1],
    parameters: BTreeMap<String, Quantity>,
    alone: Option<f64>,
    last: Option<f64>,
    after: f64,
    equivalent: &'a [EffectId],
    /// Absent where it holds in all logs.
    #[serde(skip_serializing_if = "Option::is_none")]
    logs: Option<&'a [String]>,
}

impl<'a> Found<'a> {
    /// A gain that is named: what it closes is among what refitted numbers close, so that it has no share of its own.
    fn gain(diagnosis: &'a Diagnosis) -> Option<Self> {
        const GAIN: EffectId = EffectId::MotorGain;
        let (_, numbers) = diagnosis.effect_parameters.iter().find(|(effect, _)| *effect == GAIN)?;
        if diagnosis.causes.iter().any(|cause| cause.effect == GAIN) {
            return None;
        }
        let answer = &diagnosis.answer;
        Some(Self {
            id: GAIN,
            form: None,
            joints: [&diagnosis.joint],
            parameters: quantities(numbers),
            alone: None,
            last: None,
            after: diagnosis.gap.after,
            equivalent: if diagnosis.causes.is_empty() { &answer.equivalent } else { &[GAIN] },
            logs: None,
        })
    }

    fn of(joint: &'a str, cause: &'a CauseShare) -> Self {
        Self {
            id: cause.effect,
            form: Some(cause.form).filter(|form| !form.is_empty()),
            joints: [joint],
            parameters: quantities(&cause.parameters),
            alone: cause.alone,
            last: cause.last,
            after: cause.after,
            equivalent: &cause.equivalent,
            logs: cause.only.as_ref().map(|set| &set.files[..]),
        }
    }
}

#[derive(Serialize)]
struct Ranked {
    effect: EffectId,
    probability: f64,
    after: f64,
    closed: Option<f64>,
    parameters: BTreeMap<String, Quantity>,
    behind_sd: f64,
    refitted: bool,
}

impl Ranked {
    fn of(candidate: &Candidate) -> Self {
        Self {
            effect: candidate.effect,
            probability: candidate.probability,
            after: candidate.after,
            closed: candidate.closed,
            parameters: quantities(&candidate.parameters),
            behind_sd: candidate.behind_sd,
            refitted: candidate.refitted,
        }
    }
}

/// The smallest size that would have been seen.
#[derive(Serialize)]
pub(in crate::report) struct Threshold {
    pub value: Option<f64>,
    pub unit: &'static str,
    pub parameter: &'static str,
}

impl Threshold {
    pub fn of(detectable: &Detectable) -> Self {
        Self { value: detectable.value, unit: detectable.unit, parameter: detectable.name }
    }
}

/// The next experiment.
#[derive(Serialize)]
pub(in crate::report) struct Proposal<'a> {
    what: &'a str,
    power: f64,
    /// File of the motion, beside the report.
    motion: Option<&'static str>,
}

impl<'a> Proposal<'a> {
    pub fn of(next: &'a Next) -> Self {
        Self { what: &next.what, power: next.power, motion: next.motion.as_ref().map(|_| super::NEXT_FILE) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{GapReport, sample};
    use super::gap_json;
    use crate::report::FitFile;
    use serde_json::Value;

    fn written(report: &GapReport) -> Value {
        serde_json::to_value(gap_json(report)).expect("a diagnosis can be written")
    }

    /// What a key may hold.
    fn is(value: &Value, kinds: &str) -> bool {
        kinds.split('|').any(|kind| match kind {
            "null" => value.is_null(),
            "number" => value.is_number(),
            "text" => value.is_string(),
            "list" => value.is_array(),
            "object" => value.is_object(),
            "flag" => value.is_boolean(),
            "pair" => value.as_array().is_some_and(|ends| ends.len() == 2 && ends.iter().all(Value::is_number)),
            _ => false,
        })
    }

    fn check(name: &str, object: &Value, keys: &[(&str, &str)]) {
        for (key, kinds) in keys {
            let value = object.get(key).unwrap_or_else(|| panic!("{name}: `{key}` is missing in {object}"));
            assert!(is(value, kinds), "{name}: `{key}` is {value}, expected {kinds}");
        }
    }

    const QUANTITY: [(&str, &str); 4] =
        [("value", "number|null"), ("unit", "text"), ("interval", "pair|null"), ("interval_naive", "pair|null")];

    #[test]
    fn every_key_of_the_contract_is_there_with_its_type() {
        for (name, report) in sample::all() {
            let json = written(&report);
            check(
                name,
                &json,
                &[
                    ("schema", "number"),
                    ("verdict", "text"),
                    ("effect", "text|null"),
                    ("second", "text|null"),
                    ("equivalent", "list"),
                    ("probability", "number"),
                    ("sentence", "text"),
                    ("where", "object"),
                    ("gap", "object"),
                    ("ranking", "list"),
                    ("detectable", "object"),
                    ("joint", "object"),
                    ("next", "object|null"),
                    ("probability_source", "text"),
                    ("standing", "text"),
                    ("withheld", "list"),
                    ("health", "list"),
                    ("inputs", "list"),
                    ("seed", "number"),
                    ("demands", "object"),
                    ("effects", "list"),
                    ("law", "null"),
                    ("undetermined", "list"),
                    ("beliefs", "object"),
                    ("differs", "list"),
                ],
            );
            assert_eq!(json["schema"], 1);
            check(
                name,
                &json["where"],
                &[
                    ("joints", "list"),
                    ("stage", "text|null"),
                    ("variable", "text|null"),
                    ("range", "pair|null"),
                    ("phase", "text|null"),
                    ("logs", "list"),
                    ("share", "number"),
                ],
            );
            let mut gap = vec![("unit", "text"), ("closed", "number|null"), ("closed_interval", "list|null")];
            gap.extend(["before", "calibrated", "after_first", "after", "floor"].map(|key| (key, "number")));
            gap.extend([("outer", "flag"), ("held_out", "text"), ("waterfall", "list")]);
            check(name, &json["gap"], &gap);
            for step in json["gap"]["waterfall"].as_array().expect("a list") {
                check(name, step, &[("step", "text"), ("rms", "number|null")]);
            }
            for effect in json["effects"].as_array().expect("a list") {
                let keys = [
                    ("id", "text"),
                    ("form", "text|null"),
                    ("joints", "list"),
                    ("parameters", "object"),
                    ("alone", "number|null"),
                    ("last", "number|null"),
                    ("after", "number|null"),
                    ("equivalent", "list"),
                ];
                check(name, effect, &keys);
                for parameter in effect["parameters"].as_object().expect("an object").values() {
                    check(name, parameter, &QUANTITY);
                }
            }
            for belief in json["beliefs"].as_object().expect("an object").values() {
                let numbers = ["believed", "sd", "found", "moved_sd"].map(|key| (key, "number"));
                check(name, belief, &[&[("unit", "text")], &numbers[..]].concat());
            }
            for log in json["gap"]["per_log"].as_array().expect("a list") {
                let numbers = ["before", "calibrated", "after", "floor"].map(|key| (key, "number|null"));
                check(name, log, &[&[("file", "text")], &numbers[..]].concat());
            }
            for candidate in json["ranking"].as_array().expect("a list") {
                let keys = [
                    ("effect", "text"),
                    ("probability", "number"),
                    ("after", "number|null"),
                    ("closed", "number|null"),
                    ("parameters", "object"),
                ];
                check(name, candidate, &keys);
                for parameter in candidate["parameters"].as_object().expect("an object").values() {
                    check(name, parameter, &QUANTITY);
                }
            }
            for size in json["detectable"].as_object().expect("an object").values() {
                check(name, size, &[("value", "number|null"), ("unit", "text")]);
            }
            for key in ["inertia", "moment", "coulomb", "viscous"] {
                check(name, &json["joint"][key], &QUANTITY);
            }
            if !json["next"].is_null() {
                check(name, &json["next"], &[("what", "text"), ("power", "number")]);
            }
        }
    }

    #[test]
    fn words_are_those_of_the_contract() {
        let json = written(&sample::two_effects());
        assert_eq!((&json["verdict"], &json["effect"]), (&"effect".into(), &"torque_limit".into()));
        assert_eq!((&json["second"], &json["equivalent"][0]), (&"delay".into(), &"torque_limit".into()));
        let place = &json["where"];
        assert_eq!((&place["stage"], &place["variable"]), (&"motor".into(), &"torque".into()));
        assert_eq!((&place["phase"], &place["joints"][0]), (&"saturation".into(), &"q2".into()));
        assert_eq!(json["effects"][1]["parameters"]["T"]["value"], 0.0161);
        let verdicts = sample::all().map(|(_, report)| written(&report)["verdict"].clone());
        assert_eq!(verdicts, ["effect", "none", "calibration", "unexplained", "effect", "effect", "none"]);
    }

    #[test]
    fn effects_and_waterfall_stand_in_the_same_order() {
        let json = written(&sample::two_effects());
        let ids: Vec<&Value> = json["effects"].as_array().expect("a list").iter().map(|effect| &effect["id"]).collect();
        assert_eq!(ids, ["torque_limit", "delay"]);
        let waterfall = json["gap"]["waterfall"].as_array().expect("a list");
        let steps: Vec<&Value> = waterfall.iter().map(|step| &step["step"]).collect();
        assert_eq!(steps, ["as given", "recalibrated", "torque_limit", "delay", "floor"]);
        assert_eq!((&waterfall[0]["rms"], &waterfall[4]["rms"]), (&json["gap"]["before"], &json["gap"]["floor"]));
        assert_eq!((&json["effects"][0]["form"], &json["effects"][1]["form"]), (&"hard".into(), &Value::Null));
        assert_eq!(json["effects"][1]["after"], json["gap"]["after"]);
        assert_eq!(json["beliefs"]["gain"]["found"], 0.93);
    }

    #[test]
    fn fit_of_a_diagnosis_can_be_read_again() {
        for (name, report) in sample::all() {
            let file = FitFile::of_diagnosis(&report);
            let text = serde_json::to_string(&file).expect("a fit can be written");
            let read: FitFile = serde_json::from_str(&text).expect(name);
            assert_eq!((read.effects.len(), read.logs.len()), (file.effects.len(), file.logs.len()), "{name}");
        }
        let report = sample::two_effects();
        let file = FitFile::of_diagnosis(&report);
        assert_eq!(file.effects.iter().map(|effect| effect.id.as_str()).collect::<Vec<_>>(), ["torque_limit", "delay"]);
        assert_eq!(file.effects[0].form.as_deref(), Some("hard"));
        assert_eq!(file.joint.coulomb.value, Some(7.1e-3));
        assert_eq!(file.joint.gain.and_then(|gain| gain.value), Some(0.93));
        let mut named = sample::two_effects().diagnosis;
        named.effect_parameters.push((crate::joint::EffectId::MotorGain, Vec::new()));
        let gain = &super::effects(&named)[2];
        assert_eq!(
            (gain.id.id(), gain.alone, gain.equivalent.len()),
            ("motor_gain", None, 1),
            "it has no share of its own"
        );
        let named = FitFile::of_diagnosis(&GapReport { diagnosis: named, ..sample::two_effects() });
        assert_eq!((named.joint.gain, named.effects.len()), (None, 3), "a gain with a name is an effect alone");
        let free = sample::set_of_two();
        assert_eq!(FitFile::of_diagnosis(&free).joint.gain, None);
        assert!(file.logs.iter().all(|log| log.rms_held_out.is_some() == (log.role == "validate")));
        assert_eq!(file.joint.armature, None);
    }

    #[test]
    fn a_fit_states_the_armature_that_goes_with_its_inertia() {
        let stated_kg_m2 = 0.02;
        let report = GapReport { armature_kg_m2: Some(stated_kg_m2), ..sample::two_effects() };
        let inertia = &report.diagnosis.parameters[0];
        let expected_kg_m2 = stated_kg_m2 * inertia.value / inertia.nominal.unwrap();
        assert_ne!(expected_kg_m2, stated_kg_m2);
        let armature = FitFile::of_diagnosis(&report).joint.armature.unwrap();
        approx::assert_relative_eq!(armature.value.unwrap(), expected_kg_m2, max_relative = 1e-12);
        assert_eq!(armature.unit, "kg m^2");
        let json = serde_json::to_value(gap_json(&report)).unwrap();
        assert_eq!(json["joint"]["armature"]["value"].as_f64(), armature.value);
    }
}
