//! Chapter 3 as one page that opens without a network.

use minijinja::{Value, context};

use super::sections::{Shown, sections, verdict};
use super::words::explanations;
use super::{ThesisReport, thesis_figures};
use crate::report::ReportError;
use crate::report::html::{both, figure_views, render};
use crate::report::rows::typeset_unit;

/// Puts tables, explanation and figures into one HTML page.
///
/// The page holds its figures, its font and its script, and loads nothing; it can be read without the script. Same report,
/// same bytes.
///
/// # Errors
/// [`ReportError::Draw`] or [`ReportError::Font`] from the figures, [`ReportError::Page`] from the template; none depends
/// on the data.
pub fn thesis_html(report: &ThesisReport) -> Result<String, ReportError> {
    let all = sections(&report.tables);
    let tables: Vec<Value> = all
        .iter()
        .filter(|section| !section.rows.is_empty())
        .map(|section| context! { title => section.title, words => section.words, ..grid(&section.shown()) })
        .collect();
    let answers: Vec<Value> = explanations(report)
        .iter()
        .map(|answer| {
            context! {
                question => answer.question.as_str(),
                sentences => answer.sentences.clone(),
                table => answer.table.as_ref().map(grid),
            }
        })
        .collect();
    let values = context! {
        data => report.data.as_str(),
        verdict => verdict(&all),
        tables,
        answers,
        figures => figure_views(both(|| thesis_figures(report))?.each_ref()),
        version => report.provenance.version.as_str(),
        command => report.provenance.command.as_str(),
        inputs => report.provenance.inputs.clone(),
    };
    render("thesis.html", include_str!("../templates/thesis.html"), values)
}

fn grid(shown: &Shown) -> Value {
    let rows: Vec<Vec<String>> =
        shown.rows.iter().map(|cells| cells.iter().map(|cell| typeset_unit(cell)).collect()).collect();
    context! { columns => shown.columns.clone(), words_first => shown.words, rows, remarks => shown.remarks.clone() }
}
