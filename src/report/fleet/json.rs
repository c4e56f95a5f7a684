//! `fleet --json`.

use super::FleetReport;
use crate::report::SCHEMA;
use serde_json::{Value, json};

/// The whole table for programs, the joints through time, and the studies without an answer.
///
/// # Errors
/// Where it cannot be written down, which does not depend on the data.
pub fn fleet_json(report: &FleetReport) -> Result<Value, serde_json::Error> {
    let failed: Vec<Value> = report.failed().map(|(study, error)| json!({ "study": study, "error": error })).collect();
    Ok(json!({
        "schema": SCHEMA,
        "sentence": report.sentence(),
        "studies": report.studies,
        "failed": failed,
        "joints": serde_json::to_value(&report.joints)?,
        "rows": serde_json::to_value(&report.rows)?,
        "version": report.version,
        "command": report.command,
    }))
}
