//! The tables as text for a terminal.

use comfy_table::Cell;

use super::ThesisReport;
use super::sections::{Section, sections, verdict};
use super::words::explanations;
use crate::report::text::{finish, number, one_line, table, wrap};

/// Columns of the text.
const WIDTH: usize = 100;

/// Writes the tables and the explanation as plain text at most 100 columns wide, ending in a newline.
pub fn thesis_text(report: &ThesisReport) -> String {
    let sections = sections(&report.tables);
    let opening = verdict(&sections).map(|words| wrap(WIDTH, &words, "", ""));
    let mut blocks: Vec<String> = opening.into_iter().chain(summary(&sections)).collect();
    blocks.extend(sections.iter().filter(|s| !s.rows.is_empty()).map(block));
    for answer in explanations(report) {
        let mut text = wrap(WIDTH, &answer.question, "", "");
        for sentence in &answer.sentences {
            text += &format!("\n{}", wrap(WIDTH, sentence, "- ", "  "));
        }
        if let Some(rows) = &answer.table {
            let mut lines = table(WIDTH, &rows.columns[..rows.words], &rows.columns[rows.words..]);
            add_rows(&mut lines, rows.words, &rows.rows);
            text += &format!("\n{}", finish(&mut lines));
        }
        blocks.push(text);
    }
    blocks.join("\n\n") + "\n"
}

/// How many of the printed numbers the swings agree with, table by table.
fn summary(sections: &[Section<'_>]) -> Option<String> {
    let printed = sections.iter().filter(|section| section.beside == "thesis").filter_map(|section| {
        let judged: Vec<bool> = section.rows.iter().filter_map(|row| row.inside()).collect();
        let inside = judged.iter().filter(|inside| **inside).count();
        (!judged.is_empty()).then(|| vec![section.title.to_owned(), format!("{inside} of {}", judged.len())])
    });
    let printed: Vec<Vec<String>> = printed.collect();
    (!printed.is_empty()).then(|| {
        let mut lines = table(WIDTH, &["printed numbers"], &["inside the 95 % interval of these swings"]);
        add_rows(&mut lines, 1, &printed);
        finish(&mut lines)
    })
}

fn add_rows(table: &mut comfy_table::Table, words: usize, rows: &[Vec<String>]) {
    for cells in rows {
        table.add_row(cells.iter().enumerate().map(|(k, cell)| match k < words {
            true => Cell::new(one_line(cell)),
            false => number(one_line(cell)),
        }));
    }
}

fn block(section: &Section<'_>) -> String {
    let shown = section.shown();
    let mut table = table(WIDTH, &shown.columns[..shown.words], &shown.columns[shown.words..]);
    add_rows(&mut table, shown.words, &shown.rows);
    let mut text = format!("{}\n{}\n{}", section.title, wrap(WIDTH, section.words, "", ""), finish(&mut table));
    for remark in &shown.remarks {
        text += &format!("\n{}", wrap(WIDTH, remark, "- ", "  "));
    }
    text
}
