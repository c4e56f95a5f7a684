//! The gate for a terminal.

use crate::gap::gate::GateStudy;
use crate::report::gap::text::{WIDTH, paragraph};
use crate::report::text::{finish, number, one_line, table};
use comfy_table::Cell;

/// Writes the answer as plain text: the rows, what is exceeded with its cause, the verdict in the last line.
pub fn gate_text(studies: &[GateStudy]) -> String {
    let mut blocks = Vec::new();
    let rows: Vec<_> = studies.iter().flat_map(|study| &study.rows).collect();
    if !rows.is_empty() {
        // One study needs no name.
        let of_study: &[&str] = if studies.len() > 1 { &["study"] } else { &[] };
        let names = [of_study, &["joint", "log", "cause"]].concat();
        let mut table = table(WIDTH, &names, &["gap", "baseline", "growth", ""]);
        for row in &rows {
            let measure = row.measure();
            let mut cells: Vec<Cell> = of_study.iter().map(|_| Cell::new(one_line(&row.study))).collect();
            cells.extend([
                Cell::new(one_line(&row.joint)),
                Cell::new(one_line(&row.log)),
                Cell::new(&row.cause),
                number(measure.quantity(row.gap)),
                number(row.baseline.map_or_else(|| "-".to_owned(), |before| measure.quantity(before))),
                number(row.growth().map_or_else(|| "-".to_owned(), |growth| format!("{:+.1} %", 100.0 * growth))),
                Cell::new(match (row.passes(), row.is_new) {
                    (false, _) => "FAIL",
                    (true, true) => "new",
                    (true, false) => "ok",
                }),
            ]);
            table.add_row(cells);
        }
        blocks.push(finish(&mut table));
    }
    for row in &rows {
        if let Some(exceeds) = row.exceeds() {
            blocks.push(paragraph(&format!(
                "{}, joint {}, log {}: {exceeds}. {}",
                row.study, row.joint, row.log, row.sentence
            )));
        }
    }
    for study in studies {
        if let Some(error) = &study.error {
            blocks.push(format!("{}: no answer: {error}", study.study));
        }
    }
    blocks.push(verdict(studies));
    blocks.join("\n\n") + "\n"
}

/// How many passed.
pub(super) fn verdict(studies: &[GateStudy]) -> String {
    let rows = studies.iter().flat_map(|study| &study.rows);
    let (all, failed) = (rows.clone().count(), rows.filter(|row| !row.passes()).count());
    let errors = studies.iter().filter(|study| study.error.is_some()).count();
    let without = if errors > 0 { format!(", {errors} studies without an answer") } else { String::new() };
    let new = studies.iter().flat_map(|study| &study.rows).filter(|row| row.is_new).count();
    let unknown = if new > 0 { format!(", {new} are not in the baseline") } else { String::new() };
    let word = if failed + errors == 0 { "passed" } else { "failed" };
    format!("gate {word}: {failed} of {all} logs exceed what they may{unknown}{without}")
}
