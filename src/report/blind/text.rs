//! The report of sealed trials for a terminal.

use comfy_table::{Cell, CellAlignment, ContentArrangement, Table, TableComponent, presets};

use super::BlindReport;
use super::rows::{Row, counts, interval, numbers, percent, rates, sentence, share};
use crate::blind::{Score, Table as Confusion};

/// Columns of the text.
const WIDTH: u16 = 118;

/// Writes the report as plain text, as a rule at most 118 columns wide, ending in a newline.
pub fn blind_text(report: &BlindReport) -> String {
    let score = &report.score;
    let seal = if report.seal_holds { "as stated before the first diagnosis" } else { "WHICH IS NOT WHAT WAS SEALED" };
    let head =
        format!("{} studies, seed {}; answers opened: SHA-256 {}, {seal}.", score.trials, report.seed, report.sha256);
    let mut blocks = vec![head, sentence(score), rate_table(score), number_table(score), confusion(&score.confusion)];
    blocks.push(causes(score));
    if !score.sizes.is_empty() {
        blocks.push(sizes(score));
    }
    blocks.push(stated(score));
    if score.coverage.iter().any(|c| c.textbook.of + c.variant.of > 0) {
        blocks.push(coverage(score));
    }
    blocks.join("\n\n") + "\n"
}

fn rate_table(score: &Score) -> String {
    let mut table = table(&["", "how often", "share", "95 %"]);
    for Row { what, count, share, interval } in rates(score) {
        table.add_row([Cell::new(what), number(count), number(share), number(interval)]);
    }
    finish(&table)
}

fn number_table(score: &Score) -> String {
    let lines: Vec<String> = numbers(score).into_iter().map(|(what, value)| format!("{what}: {value}")).collect();
    lines.join("\n")
}

/// Columns are named by numbers, so that twenty fit; rows that are answers bear the same numbers.
fn confusion(counts: &Confusion) -> String {
    let number_of = |name: &str| counts.columns.iter().position(|column| *column == name).map(|at| at + 1);
    let headings: Vec<String> = (1..=counts.columns.len()).map(|k| k.to_string()).collect();
    let mut header = vec!["there \\ answered"];
    header.extend(headings.iter().map(String::as_str));
    let mut table = table(&header);
    // names must not be broken; where there are that many columns, a wide terminal is asked for
    table.set_content_arrangement(ContentArrangement::Disabled);
    for (name, row) in counts.rows.iter().zip(&counts.counts) {
        let label = number_of(name).map_or_else(|| format!("   {name}"), |at| format!("{at:>2} {name}"));
        let cells = row.iter().zip(&counts.columns).map(|(count, column)| {
            let is_empty = *count == 0 && !Confusion::is_right(name, column);
            number(if is_empty { "·".to_owned() } else { count.to_string() })
        });
        table.add_row(std::iter::once(Cell::new(label)).chain(cells));
    }
    let others = counts.columns.iter().enumerate().filter(|(_, column)| !counts.rows.contains(column));
    let others: Vec<String> = others.map(|(at, column)| format!("{} {column}", at + 1)).collect();
    let key = if others.is_empty() { String::new() } else { format!("\nfurther answers: {}", others.join(", ")) };
    format!("What was there (rows) and what was answered (columns, by the rows' numbers)\n{}{key}", finish(&table))
}

fn causes(score: &Score) -> String {
    let mut table = table(&["cause", "right", "in the set", "stage", "else taken for"]);
    for cause in &score.causes {
        let taken = cause.taken_for.as_ref().map_or_else(String::new, |(name, count)| format!("{name} ({count})"));
        table.add_row([
            Cell::new(&cause.cause),
            number(counts(&cause.top)),
            number(counts(&cause.set)),
            number(if cause.stage.of > 0 { counts(&cause.stage) } else { String::new() }),
            Cell::new(taken),
        ]);
    }
    finish(&table)
}

fn sizes(score: &Score) -> String {
    let mut table = table(&["one effect; left after recalibration", "named", "in the set", "not seen"]);
    for size in &score.sizes {
        let range = match size.to {
            Some(to) => format!("{} to {to} times the noise", size.from),
            None => format!("more than {} times the noise", size.from),
        };
        table.add_row([
            Cell::new(range),
            number(counts(&size.top)),
            number(counts(&size.set)),
            number(counts(&size.missed)),
        ]);
    }
    finish(&table)
}

fn stated(score: &Score) -> String {
    let mut table = table(&["stated probability", "mean stated", "right", "share", "95 %"]);
    for bin in score.stated.bins.iter().filter(|bin| bin.right.of > 0) {
        let [low, high] = bin.range;
        table.add_row([
            Cell::new(format!("{low} to {high}")),
            number(bin.stated.map_or_else(String::new, percent)),
            number(counts(&bin.right)),
            number(share(&bin.right)),
            number(interval(&bin.right)),
        ]);
    }
    finish(&table)
}

fn coverage(score: &Score) -> String {
    let mut table = table(&["95 % intervals that cover", "robust", "naive", "robust, formulas varied"]);
    for row in score.coverage.iter().filter(|c| c.textbook.of + c.variant.of > 0) {
        table.add_row([
            Cell::new(&row.name),
            number(counts(&row.textbook)),
            number(counts(&row.textbook_naive)),
            number(counts(&row.variant)),
        ]);
    }
    finish(&table)
}

fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    let cells = header.iter().enumerate().map(|(at, name)| {
        let words = at == 0 || *name == "else taken for";
        Cell::new(name).set_alignment(if words { CellAlignment::Left } else { CellAlignment::Right })
    });
    table
        .load_preset(presets::NOTHING)
        .set_style(TableComponent::HeaderLines, '-')
        .set_style(TableComponent::MiddleHeaderIntersections, '-')
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(WIDTH)
        .set_header(cells);
    for column in table.column_iter_mut() {
        column.set_padding((0, 1));
    }
    table
}

fn number(text: String) -> Cell {
    Cell::new(text).set_alignment(CellAlignment::Right)
}

/// The table without blanks at the ends of its lines.
fn finish(table: &Table) -> String {
    table.lines().map(|line| line.trim_end().to_owned()).collect::<Vec<_>>().join("\n")
}
