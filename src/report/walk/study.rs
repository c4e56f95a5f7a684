//! A study of several runs: a sentence, a table, what it means, figures.

use crate::report::html::{figure_views, render};
use crate::report::text::{finish, number, table, wrap};
use crate::report::{Figure, Provenance, ReportError};
use comfy_table::Cell;
use minijinja::context;
use serde::Serialize;

const WIDTH: usize = 118;

/// Several runs beside each other; `R` is what the JSON has for each.
#[derive(Clone, Debug, Serialize)]
pub struct StudyReport<R: Serialize> {
    /// The layout's version.
    pub schema: u32,
    /// `integrators`, `frames` or `falls`.
    pub study: String,
    /// Headline.
    pub title: String,
    /// One sentence a colleague would say.
    pub sentence: String,
    /// What it means, and how it was measured.
    pub notes: Vec<String>,
    /// The runs.
    pub rows: Vec<R>,
    /// The runs as a table.
    #[serde(skip)]
    pub table: StudyTable,
    /// The figures.
    #[serde(skip)]
    pub figures: Vec<Figure>,
    /// Where it comes from.
    #[serde(skip)]
    pub provenance: Provenance,
}

/// A table: columns of words, then of numbers.
#[derive(Clone, Debug, Default)]
pub struct StudyTable {
    /// Heads of the columns of words.
    pub words: Vec<&'static str>,
    /// Heads of the columns of numbers.
    pub numbers: Vec<&'static str>,
    /// Cells, words first.
    pub rows: Vec<Vec<String>>,
    /// What is said of each row under it; may be shorter than the rows.
    pub remarks: Vec<String>,
}

/// The study as text.
pub fn study_text<R: Serialize>(report: &StudyReport<R>) -> String {
    let shown = &report.table;
    let mut rows = table(WIDTH, &shown.words, &shown.numbers);
    for row in &shown.rows {
        let cell = |(k, text): (usize, &String)| match k < shown.words.len() {
            true => Cell::new(text),
            false => number(text.clone()),
        };
        rows.add_row(row.iter().enumerate().map(cell));
    }
    let mut text = format!("{}\n\n{}\n\n", wrap(WIDTH, &report.sentence, "", ""), finish(&mut rows));
    for (row, remark) in shown.rows.iter().zip(&shown.remarks).filter(|(_, remark)| !remark.is_empty()) {
        text.push_str(&wrap(WIDTH, &format!("{}: {remark}", row[..shown.words.len()].join(" ")), "- ", "  "));
        text.push('\n');
    }
    if !shown.remarks.is_empty() {
        text.push('\n');
    }
    for note in &report.notes {
        text.push_str(&wrap(WIDTH, note, "", ""));
        text.push('\n');
    }
    text
}

/// The study as one page that loads nothing.
///
/// # Errors
/// [`ReportError::Page`] from the template.
pub fn study_html<R: Serialize>(report: &StudyReport<R>) -> Result<String, ReportError> {
    let shown = &report.table;
    let row = |(k, row): (usize, &Vec<String>)| {
        let (words, numbers) = row.split_at(shown.words.len().min(row.len()));
        context! { words => words.to_vec(), numbers => numbers.to_vec(), remark => shown.remarks.get(k) }
    };
    let values = context! {
        title => report.title.as_str(),
        sentence => report.sentence.as_str(),
        notes => report.notes.clone(),
        words => shown.words.clone(),
        numbers => shown.numbers.clone(),
        rows => shown.rows.iter().enumerate().map(row).collect::<Vec<_>>(),
        columns => shown.words.len() + shown.numbers.len(),
        figures => figure_views([&report.figures, &report.figures]),
        version => report.provenance.version.as_str(),
        command => report.provenance.command.as_str(),
        inputs => report.provenance.inputs.clone(),
    };
    render("study.html", include_str!("../templates/study.html"), values)
}
