//! A robot's diagnosis as text for a terminal.

use comfy_table::Cell;

use super::{ClampedGapReport, step_by_step, summary, sure};
use crate::gap::Diagnosis;
use crate::report::data_health::robot_health_text;
use crate::report::gap::text::{HOW_FAR, WIDTH, paragraph, undetermined};
use crate::report::measure::Measure;
use crate::report::text::{finish, number, one_line, table, wrap};

/// Writes a robot's diagnosis as plain text, as a rule at most 100 columns wide, ending in a newline: what was found in
/// short, the joints at a glance, the next experiment, every joint's own sentence, the health of the logs, what cannot be
/// determined, notes.
pub fn clamped_gap_text(report: &ClampedGapReport) -> String {
    let diagnosis = &report.diagnosis;
    let mut blocks = vec![paragraph(&diagnosis.answer.sentence)];
    blocks.push(joints(report));
    blocks.extend(report.next().map(|words| wrap(WIDTH, &words, "", "  ")));
    blocks.extend(report.joints.iter().map(|(_, joint)| sentence(report, &joint.diagnosis)));
    let health = report.health();
    if !health.is_empty() {
        blocks.push(format!("Data health:\n{}", robot_health_text(&health)));
    }
    blocks.extend(undetermined(&report.undetermined()));
    blocks.extend(report.whole_words().map(|words| paragraph(&words)));
    let still: Vec<&str> =
        diagnosis.joints.iter().filter(|joint| joint.diagnosis.is_none()).map(|joint| joint.joint.as_str()).collect();
    if !still.is_empty() {
        blocks.push(paragraph(&format!("Never moved: {}.", still.join(", "))));
    }
    let notes: Vec<String> = report.notes().iter().map(|note| wrap(WIDTH, note, "- ", "  ")).collect();
    if !notes.is_empty() {
        blocks.push(notes.join("\n"));
    }
    blocks.join("\n\n") + "\n"
}

fn joints(report: &ClampedGapReport) -> String {
    let measure = Measure::of(report.diagnosis.gap.unit);
    let names = HOW_FAR.map(|name| measure.over(name));
    let numbers: Vec<&str> = names.iter().map(|name| &**name).chain(["sure"]).collect();
    let mut table = table(WIDTH, &["joint", "verdict", "what"], &numbers);
    let rows = report.rows();
    let answers = report.joints.iter().map(|(_, joint)| Some(&joint.diagnosis)).chain([None]);
    for (row, diagnosis) in rows.iter().zip(answers) {
        let verdict = diagnosis.map_or_else(String::new, |d| d.answer.verdict.name().to_owned());
        let sure = diagnosis.map_or_else(String::new, sure);
        let name = Cell::new(one_line(&row.file));
        let mut cells =
            vec![name, Cell::new(verdict), Cell::new(diagnosis.map_or_else(String::new, |own| summary(report, own)))];
        cells.extend([row.before, row.calibrated, row.after, row.floor].map(|error| number(measure.number(error))));
        cells.push(number(sure));
        table.add_row(cells);
    }
    format!("{}\n{}", finish(&mut table), paragraph(&report.columns()))
}

/// A joint's own sentence, and its error step by step.
fn sentence(report: &ClampedGapReport, diagnosis: &Diagnosis) -> String {
    let steps = step_by_step(diagnosis).map(|steps| format!("\n{}", paragraph(&steps)));
    paragraph(report.own_sentence(diagnosis)) + &steps.unwrap_or_default()
}
