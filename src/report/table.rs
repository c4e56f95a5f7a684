//! The report as text for a terminal.

use comfy_table::{Cell, CellAlignment, ContentArrangement, Table, TableComponent, presets};

use super::number::significant;
use super::rows::{ParameterCells, shorten};
use super::{DropReport, ModelSummary, ParameterRow};

/// Columns of the text.
const WIDTH: usize = 108;
/// Characters of a file name.
const NAME: usize = 36;

/// Writes a drop report as plain text, as a rule at most 108 columns wide, ending in a newline.
///
/// The sentence, one line per log, the parameters of each model with both intervals, then the notes.
pub fn drop_text(report: &DropReport) -> String {
    let mut blocks = vec![wrap(&report.sentence, "", "")];
    if !report.logs.is_empty() {
        blocks.push(logs(report));
    }
    blocks.extend(report.models.iter().map(model));
    if !report.notes.is_empty() {
        blocks.push(report.notes.iter().map(|note| wrap(note, "- ", "  ")).collect::<Vec<_>>().join("\n"));
    }
    blocks.join("\n\n") + "\n"
}

fn logs(report: &DropReport) -> String {
    let mut table =
        table(&["log", "role"], &["fitted\nsamples", "release\n[s]", "RMS simple\n[mrad]", "RMS extensive\n[mrad]"]);
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
        return wrap(&headline, "", "");
    }
    let mut table = table(&["parameter", "unit"], &["estimate", "95 % interval", "naive interval", "nominal"]);
    table.add_rows(model.parameters.iter().map(parameter));
    format!("{}\n{}", wrap(&headline, "", ""), finish(&mut table))
}

fn parameter(row: &ParameterRow) -> [Cell; 6] {
    let cells = ParameterCells::from(row);
    let [label, unit] = [shorten(&one_line(&cells.label), 30), shorten(&one_line(&cells.unit), 14)];
    [
        Cell::new(label),
        Cell::new(unit),
        number(cells.estimate),
        number(cells.interval),
        number(cells.naive),
        number(cells.nominal),
    ]
}

fn table(words: &[&str], numbers: &[&str]) -> Table {
    let mut table = Table::new();
    let header = words.iter().map(Cell::new).chain(numbers.iter().map(|name| number((*name).to_owned())));
    table
        .load_preset(presets::NOTHING)
        .set_style(TableComponent::HeaderLines, '-')
        .set_style(TableComponent::MiddleHeaderIntersections, '-')
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(WIDTH as u16)
        .set_header(header);
    for column in table.column_iter_mut() {
        column.set_padding((0, 1));
    }
    table
}

fn number(text: String) -> Cell {
    Cell::new(text).set_alignment(CellAlignment::Right)
}

/// The table without blanks at the ends of its lines.
fn finish(table: &mut Table) -> String {
    table.lines().map(|line| line.trim_end().to_owned()).collect::<Vec<_>>().join("\n")
}

/// Control characters would break the table's lines.
fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

/// Breaks a text at blanks; the first line begins with `first`, the others with `rest`.
fn wrap(text: &str, first: &str, rest: &str) -> String {
    let mut lines = vec![first.to_owned()];
    let mut length = first.chars().count();
    let mut is_fresh = true;
    for word in text.split_whitespace() {
        let count = word.chars().count();
        if !is_fresh && length + 1 + count > WIDTH {
            lines.push(rest.to_owned());
            length = rest.chars().count();
            is_fresh = true;
        }
        if let Some(line) = lines.last_mut() {
            line.push_str(if is_fresh { "" } else { " " });
            line.push_str(word);
        }
        length += count + usize::from(!is_fresh);
        is_fresh = false;
    }
    lines.join("\n")
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

    #[test]
    fn wrapping_breaks_at_blanks_and_indents() {
        let text = wrap(&"word ".repeat(40), "- ", "  ");
        assert!(text.lines().all(|line| line.len() <= WIDTH) && text.lines().count() == 2);
        assert!(text.starts_with("- word") && text.contains("\n  word"));
    }
}
