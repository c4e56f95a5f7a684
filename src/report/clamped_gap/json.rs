//! `gap --json` of a robot with a clamped base: the keys of a joint's document for the whole, and every joint's document.

use super::ClampedGapReport;
use crate::gap::clamped::{BodyCause, BodyName};
use crate::joint::EffectId;
use crate::report::gap::{NEXT_FILE, quantities};
use crate::report::{SCHEMA, gap_json};
use serde_json::{Map, Value, json};

/// The diagnosis for programs.
///
/// # Errors
/// Where a joint's document cannot be written down, which does not depend on the data.
pub fn clamped_gap_json(report: &ClampedGapReport) -> Result<Value, serde_json::Error> {
    let ClampedGapReport { diagnosis, joints, provenance, .. } = report;
    let mut documents = Map::new();
    let mut effects: Vec<Value> = diagnosis.bodies.iter().map(|body| of_body(body, diagnosis.gap.after)).collect();
    for (_, joint) in joints {
        let mut document = serde_json::to_value(gap_json(joint))?;
        // The joint alone has no bodies.
        if let Some(Value::Array(withheld)) = document.get_mut("withheld") {
            withheld.extend(report.options.withheld_bodies().iter().map(|kind| json!(kind)));
        }
        if let Some(Value::Array(own)) = document.get("effects") {
            effects.extend(own.iter().cloned());
        }
        documents.insert(joint.diagnosis.joint.clone(), document);
    }
    let still: Vec<&str> =
        diagnosis.joints.iter().filter(|joint| joint.diagnosis.is_none()).map(|joint| joint.joint.as_str()).collect();
    let answer = &diagnosis.answer;
    let of_bodies = diagnosis.bodies.first().map(|body| &body.joints);
    let worst = of_bodies.or(diagnosis.causes.first().map(|cause| &cause.joints));
    let mut gap = serde_json::to_value(diagnosis.gap)?;
    if let Some(gap) = gap.as_object_mut() {
        let rows = report.rows().into_iter().filter(|row| documents.contains_key(&row.file));
        gap.insert("per_joint".to_owned(), rows.map(|row| (row.file.clone(), json!(row))).collect());
    }
    if let (Some(gap), Some(Ok(whole))) = (gap.as_object_mut(), &report.whole) {
        let whole = json!({
            "before": whole.before, "after": whole.after, "per_joint": whole.joints, "left_out": whole.left_out,
        });
        gap.insert("whole".to_owned(), whole);
    }
    let mut document = json!({
        "schema": SCHEMA,
        "name": diagnosis.robot,
        "verdict": answer.verdict,
        "effect": answer.effect,
        "second": answer.second,
        "probability": answer.probability,
        "sentence": answer.sentence,
        "where": { "joints": worst },
        "equivalent": equivalent(report, &documents),
        "ranking": ranking(&documents),
        "detectable": detectable(&documents),
        "gap": gap,
        "effects": named_first(effects, [answer.effect, answer.second]),
        "causes": diagnosis.causes,
        "pooled": diagnosis.pooled,
        "joints": documents,
        "still": still,
        "model": report.model,
        "found": report.found.numbers,
        "cannot_say": report.found.cannot_say,
        "undetermined": report.undetermined(),
        "next": next(report, &documents),
        "doubts": report.doubts(),
        "notes": diagnosis.notes,
        "version": provenance.version,
        "command": provenance.command,
        "inputs": provenance.hashed(),
    });
    if let (Some(document), Some(spent)) = (document.as_object_mut(), &diagnosis.budget) {
        document.insert("budget".to_owned(), json!(spent));
    }
    Ok(document)
}

/// Causes, those that the answer names before the others; of one on several joints that of the joint described first.
fn named_first(mut effects: Vec<Value>, named: [Option<&str>; 2]) -> Vec<Value> {
    let mut first = Vec::with_capacity(effects.len());
    for id in named.into_iter().flatten() {
        let at = effects.iter().position(|effect| effect["id"] == id);
        first.extend(at.map(|at| effects.remove(at)));
    }
    first.append(&mut effects);
    first
}

/// What these logs cannot tell from the first cause, itself included: a body's, or those of the joint that has most of it.
fn equivalent(report: &ClampedGapReport, documents: &Map<String, Value>) -> Value {
    let diagnosis = &report.diagnosis;
    if let Some(body) = diagnosis.bodies.first() {
        return json!(ids(&body.equivalent));
    }
    let Some(cause) = diagnosis.causes.first() else { return json!([]) };
    let of = |joint: &String| {
        let document = documents.get(joint)?;
        let effects = document["effects"].as_array()?;
        let own = effects.iter().find(|effect| effect["id"] == cause.effect.id())?;
        Some(own["equivalent"].clone()).filter(Value::is_array)
    };
    cause.joints.iter().find_map(of).unwrap_or_else(|| json!([cause.effect]))
}

/// The next experiment of the whole, with its joint, its file as it lies in the robot's report.
fn next(report: &ClampedGapReport, documents: &Map<String, Value>) -> Value {
    let Some((folder, own)) = report.to_ask_next() else { return Value::Null };
    let (joint, file) = (&own.diagnosis.joint, format!("{folder}/{NEXT_FILE}"));
    let mut next = documents.get(joint).map_or(Value::Null, |document| document["next"].clone());
    if let Some(next) = next.as_object_mut() {
        for words in next.values_mut() {
            if let Value::String(words) = words {
                *words = words.replace(NEXT_FILE, &file);
            }
        }
        next.insert("joint".to_owned(), json!(joint));
    }
    next
}

/// The joints' candidates, each with its joint, the most probable first.
fn ranking(documents: &Map<String, Value>) -> Vec<Value> {
    let of = |(joint, document): (&String, &Value)| {
        let own = document["ranking"].as_array().cloned().unwrap_or_default();
        let joint = joint.clone();
        own.into_iter().map(move |mut candidate| {
            candidate["joint"] = json!(joint);
            candidate
        })
    };
    let mut all: Vec<Value> = documents.iter().flat_map(of).collect();
    let probability = |candidate: &Value| candidate["probability"].as_f64().unwrap_or(0.0);
    all.sort_by(|a, b| probability(b).total_cmp(&probability(a)));
    all
}

/// The smallest size of each effect that these logs would have shown, with the joint on which it shows best.
fn detectable(documents: &Map<String, Value>) -> Map<String, Value> {
    let mut all: Map<String, Value> = Map::new();
    for (joint, document) in documents {
        for (effect, own) in document["detectable"].as_object().into_iter().flatten() {
            // Of limits and springs the larger is the lesser effect.
            let id: Option<EffectId> = effect.parse().ok();
            let is_infinite = id.and_then(|id| id.named_parameters().first()).is_some_and(|p| !p.zero.is_finite());
            let size = |threshold: &Value| {
                let value = threshold["value"].as_f64().map_or(f64::INFINITY, f64::abs);
                if is_infinite { 1.0 / value } else { value }
            };
            let is_better = match all.get(effect) {
                None => true,
                Some(known) if known["value"].is_null() => !own["value"].is_null(),
                Some(known) => !own["value"].is_null() && size(own) < size(known),
            };
            if is_better {
                let mut own = own.clone();
                own["joint"] = if own["value"].is_null() { Value::Null } else { json!(joint) };
                all.insert(effect.clone(), own);
            }
        }
    }
    all
}

fn ids(names: &[BodyName]) -> Vec<String> {
    names.iter().map(BodyName::id).collect()
}

/// A cause of a body, with the keys of a joint's.
fn of_body(body: &BodyCause, after: f64) -> Value {
    json!({
        "id": body.kind,
        "form": null,
        "body": body.body,
        "joints": body.joints,
        "parameters": quantities(&body.parameters),
        "alone": null,
        "last": null,
        "after": after,
        "saved": body.saved,
        "equivalent": ids(&body.equivalent),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_that_the_answer_names_come_first_and_the_rest_as_joints_are_described() {
        let on = |joint: &str, id: &str| json!({ "id": id, "joints": [joint] });
        let effects = || vec![on("hip", "stribeck"), on("hip", "delay"), on("knee", "backlash"), on("knee", "delay")];
        let ordered = named_first(effects(), [Some("delay"), Some("backlash")]);
        assert_eq!(ordered, [on("hip", "delay"), on("knee", "backlash"), on("hip", "stribeck"), on("knee", "delay")]);
        assert_eq!(named_first(effects(), [None, None]), effects());
        let bodies = vec![on("lower", "payload"), on("upper", "payload"), on("hip", "delay")];
        assert_eq!(named_first(bodies.clone(), [Some("payload"), Some("payload")]), bodies);
    }
}
