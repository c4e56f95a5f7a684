//! The tables as text for a terminal.

use comfy_table::Cell;

use super::ThesisReport;
use super::sections::{COLUMNS, Section, cells, sections};
use crate::report::text::{finish, number, one_line, table, wrap};

/// Columns of the text.
const WIDTH: usize = 100;

/// Writes the tables as plain text at most 100 columns wide, ending in a newline.
pub fn thesis_text(report: &ThesisReport) -> String {
    let mut blocks = Vec::new();
    for section in sections(&report.tables).iter().filter(|section| !section.rows.is_empty()) {
        blocks.push(block(section));
    }
    blocks.join("\n\n") + "\n"
}

fn block(section: &Section<'_>) -> String {
    let used: Vec<usize> = used_columns(section);
    let words = used.iter().filter(|k| **k < 4).map(|k| COLUMNS[*k]).collect::<Vec<_>>();
    let numbers = used.iter().filter(|k| **k >= 4).map(|k| COLUMNS[*k]).collect::<Vec<_>>();
    let mut table = table(WIDTH, &words, &numbers);
    let mut remarks: Vec<String> = Vec::new();
    for row in &section.rows {
        let cells = cells(row);
        table.add_row(used.iter().map(|k| match k {
            0..4 => Cell::new(one_line(&cells[*k])),
            _ => number(cells[*k].clone()),
        }));
        if !row.remark.is_empty() && row.ours.is_some() && row.interval.is_some() {
            remarks.push(format!("{} {}: {}.", row.of.name(), row.quantity, row.remark));
        }
    }
    let mut text = format!("{}\n{}\n{}", section.title, wrap(WIDTH, section.words, "", ""), finish(&mut table));
    for remark in remarks {
        text += &format!("\n{}", wrap(WIDTH, &remark, "- ", "  "));
    }
    text
}

/// Columns in which some row has something to say.
fn used_columns(section: &Section<'_>) -> Vec<usize> {
    let all: Vec<[String; 9]> = section.rows.iter().map(|row| cells(row)).collect();
    (0..COLUMNS.len()).filter(|k| all.iter().any(|cells| !cells[*k].is_empty())).collect()
}
