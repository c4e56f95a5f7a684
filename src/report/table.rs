//! The report as text for a terminal.

use super::beliefs::belief_table;
use super::full::full_text;
use super::grid::Grid;
use super::number::significant;
use super::text::{parameter_table, wrap};
use super::{DropReport, LogCurves, ModelSummary};

/// Columns of the text.
const WIDTH: usize = 108;

/// Writes a drop report as plain text, as a rule at most 108 columns wide, ending in a newline.
///
/// The sentence, one line per log, the parameters of each model with both intervals, what is
/// believed of the numbers, then the notes.
pub fn drop_text(report: &DropReport) -> String {
    let mut blocks = vec![wrap(WIDTH, &report.sentence, "", "")];
    if !report.logs.is_empty() {
        blocks.push(logs(report).text(WIDTH));
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

/// What each log gave to the fit and what the models leave of it.
pub(super) fn logs(report: &DropReport) -> Grid {
    let row = |log: &LogCurves| {
        let numbers = vec![
            log.t_s.len().saturating_sub(log.first_fitted).to_string(),
            log.release_s.map_or("-".to_owned(), |release| format!("{release:.3}")),
            significant(1e3 * log.simple_rms_rad, 3),
            significant(1e3 * log.extensive_rms_rad, 3),
        ];
        (format!("{} ({})", log.file, log.role), numbers)
    };
    Grid {
        name: "log",
        numbers: vec!["fitted\nsamples", "release\n[s]", "RMS simple\n[mrad]", "RMS extensive\n[mrad]"],
        rows: report.logs.iter().map(row).collect(),
    }
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
    fn a_log_with_holes_has_its_release() {
        let mut report = sample::single();
        report.logs[0].file += " (part 1)";
        assert_eq!(logs(&report).rows[0].1[1], "0.400");
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
