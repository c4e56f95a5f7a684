//! Text for a terminal: tables and paragraphs of a given width.

use comfy_table::{Cell, CellAlignment, ColumnConstraint, ContentArrangement, Table, TableComponent, Width, presets};

use std::sync::atomic::{AtomicUsize, Ordering};

use super::ParameterRow;
use super::rows::{ParameterCells, shorten};

/// Columns of the terminal, where there is one.
static COLUMNS: AtomicUsize = AtomicUsize::new(usize::MAX);
/// Columns of a list.
const LIST: usize = 100;
/// Nothing can be read that is narrower.
const NARROWEST: usize = 40;

/// Keeps all text that is written from now on to the columns of a terminal.
pub fn limit_width(columns: usize) {
    COLUMNS.store(columns.max(NARROWEST), Ordering::Relaxed);
}

/// The width that is meant, or the terminal's where that is less.
pub(super) fn at_most(width: usize) -> usize {
    width.min(COLUMNS.load(Ordering::Relaxed))
}

/// Parameters with both intervals and the nominal value.
pub(super) fn parameter_table<'a>(width: usize, rows: impl IntoIterator<Item = &'a ParameterRow>) -> String {
    let numbers = ["estimate", "95 % interval", "naive interval", "nominal"];
    let mut table = table(width, &["parameter", "unit"], &numbers);
    table.add_rows(rows.into_iter().map(parameter));
    finish(&mut table)
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

/// A table of columns of words, then of numbers, which stand to the right.
pub(super) fn table(width: usize, words: &[&str], numbers: &[&str]) -> Table {
    let mut table = Table::new();
    let right = |name: &&str| Cell::new(name).set_alignment(CellAlignment::Right);
    let header = words.iter().map(Cell::new).chain(numbers.iter().map(right));
    table
        .load_preset(presets::NOTHING)
        .set_style(TableComponent::HeaderLines, '-')
        .set_style(TableComponent::MiddleHeaderIntersections, '-')
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(u16::try_from(at_most(width)).unwrap_or(u16::MAX))
        .set_header(header);
    table.column_iter_mut().for_each(|column| {
        column.set_padding((0, 1));
    });
    table
}

/// Characters of the longest word.
fn longest_word(text: &str) -> usize {
    text.split_ascii_whitespace().map(|word| word.chars().count()).max().unwrap_or(0)
}

/// A cell whose text stands to the right.
pub(super) fn number(text: impl ToString) -> Cell {
    cell(text).set_alignment(CellAlignment::Right)
}

/// A cell whose numbers keep their units beside them.
pub(super) fn cell(text: impl ToString) -> Cell {
    Cell::new(glued(&text.to_string()))
}

/// The table without blanks at the ends of its lines.
pub(super) fn finish(table: &mut Table) -> String {
    keep_words_whole(table);
    table.lines().map(|line| unglued(&line).trim_end().to_owned()).collect::<Vec<_>>().join("\n")
}

/// Lets no word be broken: columns stand closer where they have to. Where even that is too wide, heads stay whole and names
/// give way.
fn keep_words_whole(table: &mut Table) {
    let heads: Vec<usize> = table
        .header()
        .into_iter()
        .flat_map(|head| head.cell_iter())
        .map(|cell| longest_word(&cell.content()))
        .collect();
    let mut least = heads.clone();
    for row in table.row_iter() {
        for (least, cell) in least.iter_mut().zip(row.cell_iter()) {
            *least = longest_word(&cell.content()).max(*least);
        }
    }
    let width = table.width().map_or(usize::MAX, usize::from);
    let needs = |gap: usize| least.iter().map(|least| least + gap).sum::<usize>();
    let (least, gap) = match () {
        () if needs(2) <= width + 2 => (least, 1),
        () if needs(1) <= width + 1 => (least, 0),
        () => (heads, 1),
    };
    for (column, least) in table.column_iter_mut().zip(least) {
        let least = u16::try_from(least + usize::from(gap)).unwrap_or(u16::MAX);
        column.set_padding((0, gap)).set_constraint(ColumnConstraint::LowerBoundary(Width::Fixed(least)));
    }
}

/// What must not be parted at the end of a line, and does not begin with a number.
const TOGETHER: [&str; 4] = [" %", "N m", "kg m", "m s/rad"];

/// The text with no-break spaces within units and before `%`.
fn glued(text: &str) -> String {
    TOGETHER.iter().fold(text.to_owned(), |text, unit| text.replace(unit, &unit.replace(' ', "\u{a0}")))
}

fn unglued(text: &str) -> String {
    text.replace('\u{a0}', " ")
}

/// Control characters would break the table's lines.
pub(super) fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

/// A sentence of a list, as wide as reports are.
pub fn list_item(text: &str) -> String {
    wrap(LIST, text, "- ", "  ")
}

/// Breaks a text at blanks, but not within a unit nor before a `%`, so that it is `width` columns wide; the first line
/// begins with `first`, the others with `rest`.
pub(super) fn wrap(width: usize, text: &str, first: &str, rest: &str) -> String {
    let width = at_most(width);
    let mut lines = vec![first.to_owned()];
    let mut length = first.chars().count();
    let mut is_fresh = true;
    let glued = glued(text);
    for word in glued.split_ascii_whitespace() {
        let count = word.chars().count();
        if !is_fresh && length + 1 + count > width {
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
    unglued(&lines.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_are_not_broken_within_a_word() {
        let mut table = table(30, &["log"], &["duration\n[s]", "jitter\n[ms]", "samples"]);
        table.add_row(["a-rather-long-name-of-a-file.csv", "1.00", "0.1", "12"].map(Cell::new));
        let text = finish(&mut table);
        assert!(["duration", "jitter", "samples"].iter().all(|word| text.contains(word)), "{text}");
    }

    #[test]
    fn wrapping_breaks_at_blanks_and_indents() {
        let text = wrap(80, &"word ".repeat(40), "- ", "  ");
        assert!(text.lines().all(|line| line.len() <= 80) && text.lines().count() == 3);
        assert!(text.starts_with("- word") && text.contains("\n  word"));
        assert_eq!(wrap(10, "closed: 93 % of it", "", ""), "closed:\n93 % of it");
    }
}
