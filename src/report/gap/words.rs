//! What the report says in words, the same on the page and in the terminal.

use super::GapReport;
use super::rows::number_row;
use crate::gap::{Detectable, Number, Phase, Variable, Where};
use crate::report::number::{percent, significant};
use crate::report::rows::ParameterCells;
use crate::report::{WithUncertainty, format_with_uncertainty};

/// What stands beside intervals that cannot be believed.
pub(super) const UNTRUSTED: &str = "Something is left in these logs that the model does not explain: the intervals allow \
    for its correlation but not for the bias that comes with it, so do not trust them.";

/// What stands above the sizes that would have been seen.
pub(super) const DETECTABLE: &str = "Smallest size of each effect that these logs would have shown:";

/// A variable in a sentence.
pub(super) fn variable(variable: Variable) -> &'static str {
    match variable {
        Variable::Speed => "speed",
        Variable::Direction => "direction of motion",
        Variable::Angle => "angle",
        Variable::Load => "gravity load",
        Variable::Time => "time in the log",
        Variable::SetpointRate => "slope of the setpoint",
        Variable::Torque => "motor torque",
        Variable::Amplitude => "amplitude of the swing",
    }
}

/// A phase in a sentence.
fn phase(phase: Phase) -> &'static str {
    match phase {
        Phase::Hold => "while the joint is held",
        Phase::Stick => "while the joint sticks",
        Phase::Reversal => "around reversals",
        Phase::Run => "while the joint moves",
        Phase::Saturation => "near the motor's largest torque",
        Phase::Stop => "at a stop",
    }
}

/// Where the gap lies, in a few sentences.
pub(super) fn location(location: &Where) -> String {
    let mut sentences = vec![match location.stage {
        Some(stage) => format!("The gap lies in the stage `{}`.", stage.name()),
        None => "There is no gap to place.".to_owned(),
    }];
    if let Some(variable_of) = location.variable {
        let range = location.range.map(|ends| format!(", {}", range(variable_of, ends))).unwrap_or_default();
        sentences.push(format!("The torque that is missing depends most on the {}{range}.", variable(variable_of)));
    }
    if location.stage.is_some() {
        let when = location.phase.map(|p| format!(", most of it {}", phase(p))).unwrap_or_default();
        sentences.push(format!("{} of the gap is there{when}.", percent(location.share)));
        if !location.logs.is_empty() {
            sentences.push(format!("Logs with more than their share: {}.", location.logs.join(", ")));
        }
    }
    sentences.join(" ")
}

/// `between 0 and 0.40 rad/s`; a direction in words.
fn range(variable: Variable, [low, high]: [f64; 2]) -> String {
    match (variable, low, high) {
        (Variable::Direction, _, high) if high <= 0.0 => "in the negative direction".to_owned(),
        (Variable::Direction, low, _) if low >= 0.0 => "in the positive direction".to_owned(),
        (Variable::Direction, ..) => "in both directions".to_owned(),
        _ => format!("between {} and {} {}", significant(low, 2), significant(high, 2), variable.unit()),
    }
}

/// A unit beside a number; a dash or a one stands for none.
fn spoken(unit: &str) -> &str {
    if matches!(unit, "-" | "1") { "" } else { unit }
}

/// `mu_st 0.0120 [0.0110, 0.0130] N m`
pub(super) fn parameter(number: &Number) -> String {
    match number.interval {
        Some(interval) if number.value.is_finite() => {
            let WithUncertainty { value, low, high } = format_with_uncertainty(number.value, interval);
            format!("{} {value} [{low}, {high}] {}", number.name, spoken(&number.unit)).trim_end().to_owned()
        }
        _ => format!("{} {}", number.name, ParameterCells::from(&number_row(number)).estimate),
    }
}

/// `mu_st 0.0031 N m`, or that the logs cannot show it.
pub(super) fn threshold(detectable: &Detectable) -> String {
    match detectable.value {
        Some(value) => {
            format!("{} {} {}", detectable.name, significant(value, 2), spoken(detectable.unit)).trim_end().to_owned()
        }
        None => "not at any size".to_owned(),
    }
}

/// `0.93 [0.90, 0.95]` as percentages.
pub(super) fn closed(closed: Option<f64>, interval: Option<[f64; 2]>) -> String {
    match (closed, interval) {
        (Some(closed), Some([low, high])) => format!("{} [{}, {}]", percent(closed), percent(low), percent(high)),
        (Some(closed), None) => percent(closed),
        (None, _) => "there was none above the sensor's noise".to_owned(),
    }
}

/// The notes of the diagnosis, then what is odd about a log, then what was left out by demand.
pub(super) fn notes(report: &GapReport) -> Vec<String> {
    let mut notes = report.diagnosis.notes.clone();
    notes.extend(
        report
            .health
            .iter()
            .filter(|row| !row.remarks.is_empty())
            .map(|row| format!("{}: {}.", row.file, row.remarks.join("; "))),
    );
    if !report.diagnosis.withheld.is_empty() {
        let ids: Vec<&str> = report.diagnosis.withheld.iter().map(|effect| effect.id()).collect();
        notes.push(format!("Withheld from the catalogue on demand: {}.", ids.join(", ")));
    }
    notes
}
