//! What a gate judges, read from diagnoses as `gap --json` writes them, and its answer for terminals, CI and programs.

mod json;
mod markdown;
mod text;
mod xml;

pub use json::{gate_baseline, gate_json};
pub use markdown::gate_markdown;
pub use text::gate_text;
pub use xml::gate_junit;

use super::measure::Measure;
use crate::gap::gate::{Exceeded, GateBounds, GateRow, GateStudy};
use serde_json::Value;

impl GateRow {
    fn measure(&self) -> Measure {
        Measure::of(&self.unit)
    }

    /// What is exceeded, in words; `None`: nothing.
    fn exceeds(&self) -> Option<String> {
        let measure = self.measure();
        let gap = measure.quantity(self.gap);
        let words = |exceeded: &Exceeded| match *exceeded {
            Exceeded::Gap { most } => format!("{gap} is more than {}", measure.quantity(most)),
            Exceeded::Growth { growth, most } => {
                let before = measure.quantity(self.baseline.unwrap_or_default());
                let [growth, most] = [growth, most].map(|share| format!("{:.1} %", 100.0 * share));
                format!("{gap} has grown by {growth} from {before}, more than {most}")
            }
        };
        let all: Vec<String> = self.exceeded.iter().map(words).collect();
        (!all.is_empty()).then(|| all.join("; "))
    }
}

/// The rows of a diagnosis, as `gap --json` writes it, judged. `earlier` gives the error of joint and log in the baseline.
pub fn gate_study(
    study: &str,
    document: &Value,
    bounds: &GateBounds,
    earlier: &dyn Fn(&str, &str) -> Option<f64>,
) -> GateStudy {
    let rows = match document.get("joints").and_then(Value::as_object) {
        Some(joints) => joints.iter().flat_map(|(joint, own)| rows(study, joint, own)).collect(),
        None => rows(study, text_of(document, "name"), document),
    };
    let judged = |row: GateRow| {
        let baseline = earlier(&row.joint, &row.log);
        GateRow { baseline, ..row }.judged(bounds)
    };
    GateStudy { study: study.to_owned(), rows: rows.into_iter().map(judged).collect(), error: None }
}

pub(in crate::report) fn text_of<'a>(document: &'a Value, key: &str) -> &'a str {
    document.get(key).and_then(Value::as_str).unwrap_or_default()
}

/// One joint's rows, one for each log.
fn rows(study: &str, joint: &str, document: &Value) -> Vec<GateRow> {
    let gap = document.get("gap");
    let unit = gap.map_or("rad", |gap| text_of(gap, "unit"));
    let logs = gap.and_then(|gap| gap.get("per_log")).and_then(Value::as_array);
    let row = |log: &Value| GateRow {
        study: study.to_owned(),
        joint: joint.to_owned(),
        log: text_of(log, "file").to_owned(),
        unit: unit.to_owned(),
        // What is not finite is null, and exceeds every bound.
        gap: log.get("before").and_then(Value::as_f64).unwrap_or(f64::NAN),
        baseline: None,
        cause: cause(document),
        sentence: text_of(document, "sentence").to_owned(),
        exceeded: Vec::new(),
        is_new: false,
    };
    logs.into_iter().flatten().map(row).collect()
}

/// The causes of a diagnosis by their ids, or its verdict.
pub(in crate::report) fn cause(document: &Value) -> String {
    let effects = document.get("effects").and_then(Value::as_array);
    let ids: Vec<&str> = effects.into_iter().flatten().map(|effect| text_of(effect, "id")).collect();
    match (text_of(document, "verdict"), text_of(document, "effect")) {
        (verdict, _) if !ids.is_empty() && verdict != "unexplained" => ids.join(", "),
        ("calibration", number) if !number.is_empty() => format!("calibration ({number})"),
        (verdict, _) => verdict.to_owned(),
    }
}

#[cfg(test)]
mod tests;
