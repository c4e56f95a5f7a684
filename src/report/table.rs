//! The report as text for a terminal.

use comfy_table::Cell;

use super::beliefs::belief_table;
use super::full::full_text;
use super::number::significant;
use super::rows::shorten;
use super::text::{finish, number, one_line, parameter_table, table, wrap};
use super::{DropReport, ModelSummary};

/// Columns of the text.
const WIDTH: usize = 108;
/// Characters of a file name.
const NAME: usize = 36;

/// Writes a drop report as plain text, as a rule at most 108 columns wide, ending in a newline.
///
/// The sentence, one line per log, the parameters of each model with both intervals, what is
/// believed of the numbers, then the notes.
pub fn drop_text(report: &DropReport) -> String {
    let mut blocks = vec![wrap(WIDTH, &report.sentence, "", "")];
    if !report.logs.is_empty() {
        blocks.push(logs(report));
    }
    blocks.extend(report.models.iter().map(model));
    if !report.beliefs.is_empty() {
        blocks.push(belief_table(WIDTH, &report.beliefs, |belief| report.interval(&belief.name)));
    }
    if let Some(full) = &report.full {
        blocks.push(full_text(full, WIDTH));
    }
    if !report.notes.is_empty() {
        blocks.push(report.notes.iter().map(|note| wrap(WIDTH, note, "- ", "  ")).collect::<Vec<_>>().join("\n"));
    }
    blocks.join("\n\n") + "\n"
}

fn logs(report: &DropReport) -> String {
    let numbers = ["fitted\nsamples", "release\n[s]", "RMS simple\n[mrad]", "RMS extensive\n[mrad]"];
    let mut table = table(WIDTH, &["log", "role"], &numbers);
    for log in &report.logs {
        let release = report.health.iter().find(|row| row.file == log.file).and_then(|row| row.release_s);
        table.add_row([
            Cell::new(shorten(&one_line(&log.file), NAME)),
            Cell::new(&log.role),
            number(log.t_s.len().saturating_sub(log.first_fitted).to_string()),
            number(release.map_or("-".to_owned(), |release| format!("{release:.3}"))),
            number(significant(1e3 * log.simple_rms_rad, 3)),
            number(significant(1e3 * log.extensive_rms_rad, 3)),
        ]);
    }
    finish(&mut table)
}

fn model(model: &ModelSummary) -> String {
    let headline = format!(
        "{}: RMS {} mrad, J {} rad^2 s; {} ({}), {} evaluations",
        model.name,
        significant(1e3 * model.rms_rad, 3),
        significant(model.criterion_rad2_s, 3),
        model.method,
        model.stop,
        model.evaluations
    );
    if model.parameters.is_empty() {
        return wrap(WIDTH, &headline, "", "");
    }
    format!("{}\n{}", wrap(WIDTH, &headline, "", ""), parameter_table(WIDTH, &model.parameters))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample;

    #[test]
    fn text_of_a_report_with_held_and_undetermined_parameters() {
        insta::assert_snapshot!(drop_text(&sample::troubled()));
    }

    #[test]
    fn no_line_is_wider_than_the_page() {
        for report in [sample::single(), sample::troubled(), sample::many(12), sample::empty()] {
            let text = drop_text(&report);
            let widest = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
            assert!(widest <= WIDTH, "{widest} columns:\n{text}");
            assert!(text.ends_with('\n') && !text.contains(" \n"));
        }
    }

    #[test]
    fn undetermined_value_is_nowhere_in_the_text() {
        let text = drop_text(&sample::troubled());
        assert!(text.contains("not determined") && !text.contains(sample::SECRET), "{text}");
    }
}
