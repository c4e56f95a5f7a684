//! `gate --json`, and what an earlier one says.

use super::gate_study;
use crate::gap::gate::{GateBounds, GateRow, GateStudy};
use crate::report::SCHEMA;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// The answer for programs, and the baseline of a later gate.
pub fn gate_json(studies: &[GateStudy], bounds: &GateBounds, version: &str, command: &str) -> Value {
    let row = |row: &GateRow| {
        json!({
            "joint": row.joint, "log": row.log, "unit": row.unit, "gap": row.gap, "baseline": row.baseline,
            "growth": row.growth(), "cause": row.cause, "sentence": row.sentence, "exceeds": row.exceeds(),
        })
    };
    let study = |study: &GateStudy| {
        json!({
            "study": study.study, "passed": study.passes(), "error": study.error,
            "rows": study.rows.iter().map(row).collect::<Vec<_>>(),
        })
    };
    json!({
        "schema": SCHEMA,
        "passed": studies.iter().all(GateStudy::passes),
        "max_gap": bounds.max_gap,
        "max_growth": bounds.max_growth,
        "studies": studies.iter().map(study).collect::<Vec<_>>(),
        "version": version,
        "command": command,
    })
}

/// Errors by study, joint and log, of a document of `gate --json` or `gap --json`; the latter's study is not known and is
/// an empty name. `None`: it is neither.
pub fn gate_baseline(document: &Value) -> Option<BTreeMap<(String, String, String), f64>> {
    let (none, nothing) = (GateBounds::default(), |_: &str, _: &str| None);
    if document.get("gap").is_some() {
        let rows = gate_study("", document, &none, &nothing).rows;
        return Some(rows.into_iter().map(|row| ((row.study, row.joint, row.log), row.gap)).collect());
    }
    let mut found = BTreeMap::new();
    for study in document.get("studies")?.as_array()? {
        let name = study.get("study")?.as_str()?;
        for row in study.get("rows")?.as_array()? {
            let (joint, log) = (row.get("joint")?.as_str()?, row.get("log")?.as_str()?);
            if let Some(gap) = row.get("gap").and_then(Value::as_f64) {
                found.insert((name.to_owned(), joint.to_owned(), log.to_owned()), gap);
            }
        }
    }
    Some(found)
}
