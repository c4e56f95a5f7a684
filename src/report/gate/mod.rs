//! Whether realism got worse: the error of models as given, log by log and joint by joint, against a bound or an earlier
//! measurement.
//!
//! What is judged is the gap as given, `gap.before` of a diagnosis: what a simulation with the study's numbers would be off
//! by. What was found as its cause is told beside it.

mod json;
mod markdown;
mod text;
mod xml;

pub use json::{gate_baseline, gate_json};
pub use markdown::gate_markdown;
pub use text::gate_text;
pub use xml::gate_junit;

use super::measure::Measure;
use serde_json::Value;

/// What may not be exceeded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GateBounds {
    /// Of the RMS error \[rad, or N m where torques are predicted\].
    pub max_gap: Option<f64>,
    /// Of its growth over the baseline, relative: 0.1 is ten percent.
    pub max_growth: Option<f64>,
}

/// One joint in one log.
#[derive(Clone, Debug, PartialEq)]
pub struct GateRow {
    /// The study as the user named it.
    pub study: String,
    /// The joint; of a robot that is judged as a whole its name.
    pub joint: String,
    /// The log.
    pub log: String,
    /// `rad` or `N m`.
    pub unit: String,
    /// RMS error of the model as given.
    pub gap: f64,
    /// The same of the baseline; `None`: it has no such log.
    pub baseline: Option<f64>,
    /// The causes that were found, by their ids, or the verdict where none has a name.
    pub cause: String,
    /// What a colleague would say.
    pub sentence: String,
    /// What is exceeded, in words; `None`: nothing.
    pub exceeds: Option<String>,
}

impl GateRow {
    /// Growth over the baseline, relative.
    pub fn growth(&self) -> Option<f64> {
        self.baseline.filter(|before| *before > 0.0).map(|before| self.gap / before - 1.0)
    }

    fn measure(&self) -> Measure {
        Measure::of(&self.unit)
    }

    fn judged(self, bounds: &GateBounds) -> Self {
        let measure = self.measure();
        let too_large = bounds
            .max_gap
            .filter(|most| !(self.gap <= *most))
            .map(|most| format!("{} is more than {}", measure.quantity(self.gap), measure.quantity(most)));
        let grown = self.growth().zip(bounds.max_growth).filter(|(growth, most)| !(growth <= most));
        let grown = grown.map(|(growth, most)| {
            let before = measure.quantity(self.baseline.unwrap_or_default());
            let [growth, most] = [growth, most].map(|share| format!("{:.1} %", 100.0 * share));
            format!("{} has grown by {growth} from {before}, more than {most}", measure.quantity(self.gap))
        });
        let exceeds: Vec<String> = too_large.into_iter().chain(grown).collect();
        Self { exceeds: (!exceeds.is_empty()).then(|| exceeds.join("; ")), ..self }
    }
}

/// A study that was judged.
#[derive(Clone, Debug, PartialEq)]
pub struct GateStudy {
    /// As the user named it.
    pub study: String,
    /// Its rows; empty where nothing moved.
    pub rows: Vec<GateRow>,
    /// Why it has no answer; `None`: it has one.
    pub error: Option<String>,
}

impl GateStudy {
    /// The rows of a diagnosis, as `gap --json` writes it. `earlier` gives the error of joint and log in the baseline.
    pub fn of(study: &str, document: &Value, bounds: &GateBounds, earlier: &dyn Fn(&str, &str) -> Option<f64>) -> Self {
        let rows = match document.get("joints").and_then(Value::as_object) {
            Some(joints) => joints.iter().flat_map(|(joint, own)| rows(study, joint, own)).collect(),
            None => rows(study, text_of(document, "name"), document),
        };
        let judged = |row: GateRow| {
            let baseline = earlier(&row.joint, &row.log);
            GateRow { baseline, ..row }.judged(bounds)
        };
        Self { study: study.to_owned(), rows: rows.into_iter().map(judged).collect(), error: None }
    }

    /// A study without an answer.
    pub fn failed(study: &str, why: String) -> Self {
        Self { study: study.to_owned(), rows: Vec::new(), error: Some(why) }
    }

    /// Whether it passes: it has an answer, and nothing is exceeded.
    pub fn passes(&self) -> bool {
        self.error.is_none() && self.rows.iter().all(|row| row.exceeds.is_none())
    }
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
        exceeds: None,
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
