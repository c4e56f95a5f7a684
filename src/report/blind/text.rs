//! The report of sealed trials for a terminal.

use comfy_table::{Cell, ContentArrangement};

use super::BlindReport;
use super::rows::{Row, counts, interval, numbers, percent, rates, sentence, share};
use crate::blind::{ByCause, Score, Stated, Table as Confusion};
use crate::report::text::{finish, number, table, wrap};

/// Columns of the text.
const WIDTH: usize = 108;

/// A heading that is not broken.
const IN_THE_SET: &str = "in\u{a0}the\u{a0}set";

/// Writes the report as plain text, as a rule at most 108 columns wide, ending in a newline.
pub fn blind_text(report: &BlindReport) -> String {
    let score = &report.score;
    let seal = if report.seal_holds { "as stated before the first diagnosis" } else { "WHICH IS NOT WHAT WAS SEALED" };
    let head =
        format!("{} studies, seed {}; answers opened: SHA-256 {}, {seal}.", score.trials, report.seed, report.sha256);
    let mut blocks = vec![
        wrap(WIDTH, &head, "", ""),
        wrap(WIDTH, &sentence(score), "", ""),
        rate_table(rates(score)),
        number_table(score),
        confusion_table(&score.confusion),
    ];
    blocks.push(cause_table(&score.causes, "stage"));
    if !score.sets.is_empty() {
        blocks.push(sets(score));
    }
    blocks.push(noises(score));
    if !score.sizes.is_empty() {
        blocks.push(sizes(score));
    }
    blocks.push(stated_table(&score.stated));
    if score.coverage.iter().any(|c| c.textbook.of + c.variant.of > 0) {
        blocks.push(coverage(score));
    }
    blocks.join("\n\n") + "\n"
}

pub(super) fn rate_table(rows: Vec<Row>) -> String {
    let mut table = table(WIDTH, &[""], &["how often", "share", "95 %"]);
    for Row { what, count, share, interval } in rows {
        table.add_row([Cell::new(what), number(count), number(share), number(interval)]);
    }
    finish(&mut table)
}

fn number_table(score: &Score) -> String {
    let line = |(what, value)| wrap(WIDTH, &format!("{what}: {value}"), "", "  ");
    let lines: Vec<String> = numbers(score).into_iter().map(line).collect();
    lines.join("\n")
}

/// Columns are named by numbers, so that twenty fit; rows that are answers bear the same numbers.
pub(super) fn confusion_table(counts: &Confusion) -> String {
    let number_of = |name: &str| counts.columns.iter().position(|column| *column == name).map(|at| at + 1);
    let headings: Vec<String> = (1..=counts.columns.len()).map(|k| k.to_string()).collect();
    let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
    let mut table = table(WIDTH, &["there \\ answered"], &headings);
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
    format!("What was there (rows) and what was answered (columns, by the rows' numbers)\n{}{key}", finish(&mut table))
}

pub(super) fn cause_table(causes: &[ByCause], stage: &str) -> String {
    let mut table = table(WIDTH, &["cause", "else taken for"], &["right", IN_THE_SET, stage]);
    for cause in causes {
        let taken = cause.taken_for.as_ref().map_or_else(String::new, |(name, count)| format!("{name} ({count})"));
        table.add_row([
            Cell::new(&cause.cause),
            Cell::new(taken),
            number(counts(&cause.top)),
            number(counts(&cause.set)),
            number(if cause.stage.of > 0 { counts(&cause.stage) } else { String::new() }),
        ]);
    }
    finish(&mut table)
}

fn sets(score: &Score) -> String {
    let headings = ["all, only they", "all", "half", "none needless", "stage", "needless"];
    let mut table = table(WIDTH, &["there at once; named"], &headings);
    for set in &score.sets {
        let mut row = vec![Cell::new(set.what)];
        row.extend([&set.exact, &set.all, &set.half, &set.clean, &set.stage].map(|rate| number(counts(rate))));
        row.push(number(format!("{:.2}", set.needless)));
        table.add_row(row);
    }
    finish(&mut table)
}

fn noises(score: &Score) -> String {
    let mut table = table(WIDTH, &["noise of the logs"], &["false alarms", "wholly right"]);
    for noise in &score.noises {
        table.add_row([Cell::new(noise.what), number(counts(&noise.false_alarms)), number(counts(&noise.top))]);
    }
    finish(&mut table)
}

fn sizes(score: &Score) -> String {
    let mut table = table(WIDTH, &["one effect; left after recalibration"], &["named", IN_THE_SET, "not seen"]);
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
    finish(&mut table)
}

pub(super) fn stated_table(stated: &Stated) -> String {
    let mut table = table(WIDTH, &["stated probability"], &["mean stated", "right", "share", "95 %"]);
    for bin in stated.bins.iter().filter(|bin| bin.right.of > 0) {
        let [low, high] = bin.range;
        table.add_row([
            Cell::new(format!("{low} to {high}")),
            number(bin.stated.map_or_else(String::new, percent)),
            number(counts(&bin.right)),
            number(share(&bin.right)),
            number(interval(&bin.right)),
        ]);
    }
    finish(&mut table)
}

fn coverage(score: &Score) -> String {
    let mut table = table(WIDTH, &["95 % intervals that cover"], &["robust", "naive", "robust, formulas varied"]);
    for row in score.coverage.iter().filter(|c| c.textbook.of + c.variant.of > 0) {
        table.add_row([
            Cell::new(&row.name),
            number(counts(&row.textbook)),
            number(counts(&row.textbook_naive)),
            number(counts(&row.variant)),
        ]);
    }
    finish(&mut table)
}
