//! `gap --json` of a robot with a clamped base: the keys of a joint's document for the whole, and every joint's document.

use super::ClampedGapReport;
use crate::gap::clamped::BodyCause;
use crate::report::gap::quantities;
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
        let document = serde_json::to_value(gap_json(joint))?;
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
    Ok(json!({
        "schema": SCHEMA,
        "name": diagnosis.robot,
        "verdict": answer.verdict,
        "effect": answer.effect,
        "second": answer.second,
        "probability": answer.probability,
        "sentence": answer.sentence,
        "where": { "joints": worst },
        "gap": gap,
        "effects": effects,
        "causes": diagnosis.causes,
        "pooled": diagnosis.pooled,
        "joints": documents,
        "still": still,
        "model": report.model,
        "found": report.found.numbers,
        "cannot_say": report.found.cannot_say,
        "notes": diagnosis.notes,
        "version": provenance.version,
        "command": provenance.command,
        "inputs": provenance.hashed(),
    }))
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
        "equivalent": body.equivalent,
    })
}
