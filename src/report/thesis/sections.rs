//! The tables as headed blocks of rows and cells, the same in text, Markdown and on the page.

use crate::report::number::{as_given, format_with_uncertainty, significant};
use crate::thesis::{Row, Tables};

/// A table with what to know of it.
pub(super) struct Section<'a> {
    /// e.g. `Table 3.1, from the swings`.
    pub title: &'static str,
    /// How to read it.
    pub words: &'static str,
    /// Which key its rows have in JSON and CSV.
    pub key: &'static str,
    /// What stands in the column of printed numbers.
    pub beside: &'static str,
    /// Its rows.
    pub rows: Vec<&'a Row>,
}

/// How many columns of words come first.
pub(super) const WORDS: usize = 3;

/// A table as it is shown: headings and cells of the columns that say something.
pub(super) struct Shown {
    pub columns: Vec<&'static str>,
    /// How many of the columns are words.
    pub words: usize,
    pub rows: Vec<Vec<String>>,
    /// Remarks on rows, as sentences.
    pub remarks: Vec<String>,
}

/// How many of the masses and frictions that matter lie inside; `None` where these swings determine none.
pub(super) fn verdict(sections: &[Section<'_>]) -> Option<String> {
    let rows = sections.iter().filter(|s| ["table_3_2", "table_3_3"].contains(&s.key)).flat_map(|s| &s.rows);
    let judged: Vec<bool> = rows.filter_map(|row| row.inside()).collect();
    let inside = judged.iter().filter(|inside| **inside).count();
    (!judged.is_empty()).then(|| {
        format!(
            "{inside} of the {} masses and frictions of Tables 3.2 and 3.3 that these swings determine lie, as printed, \
             inside their 95 % intervals.",
            judged.len()
        )
    })
}

/// The tables in the thesis's order.
pub(super) fn sections(tables: &Tables) -> Vec<Section<'_>> {
    let (ratios, weighed) = (&tables.ratios, &tables.weighed);
    vec![
        Section {
            title: "Table 3.1: arithmetic",
            words: "Mass (3.5) and friction (3.6) from the printed ratios. The interval is what the rounding of the \
                    printed digits leaves open.",
            key: "table_3_1_arithmetic",
            beside: "thesis",
            rows: ratios.iter().flat_map(|t| &t.arithmetic).collect(),
        },
        Section {
            title: "Table 3.1: from the swings, g/L fitted",
            words: "The simple pendulum (3.2) fitted to all swings with one extra mass. The printed ratios come from \
                    another robot's swings; the columns compare the procedure, not the robot.",
            key: "table_3_1",
            beside: "thesis",
            rows: tables.table_3_1(),
        },
        Section {
            title: "Table 3.1: from the swings, g/L set as printed",
            words: "The same with g/L held at the printed value in both tests.",
            key: "table_3_1_set",
            beside: "thesis",
            rows: ratios.iter().flat_map(|t| &t.set).collect(),
        },
        Section {
            title: "Table 3.2: masses",
            words: "About q3 first, then q2 with the lower leg's mass held, then q1 with both. Four tests: the mean of \
                    the tests that the thesis took, each fitted alone. Ours: one fit of all swings about the joint; \
                    its interval allows for that of the masses held.",
            key: "table_3_2",
            beside: "thesis",
            rows: tables.table_3_2(),
        },
        Section {
            title: "Table 3.3: friction",
            words: "From the same fits.",
            key: "table_3_3",
            beside: "thesis",
            rows: tables.table_3_3(),
        },
        Section {
            title: "Tables 3.2 and 3.3, one load at a time",
            words: "With and without extra mass; the other masses are held.",
            key: "by_load",
            beside: "thesis",
            rows: weighed.iter().flat_map(|w| &w.by_load).collect(),
        },
        Section {
            title: "Table 3.4: friction chosen for the robot",
            words: "From the swings that the thesis chose, bare ones or those with the lowest extra mass, with all \
                    masses held. Written to robot.toml.",
            key: "table_3_4",
            beside: "thesis",
            rows: tables.table_3_4(),
        },
        Section {
            title: "Whole robot, all effects together",
            words: "Up to four swings of each joint fitted in the whole robot, the other joints rigid or held by PID, \
                    whichever fits better. On each joint: lower leg's mass, friction, encoder's zero, load friction (mu_l), \
                    friction by direction (delta).",
            key: "whole_robot",
            beside: "thesis",
            rows: tables.whole.iter().flat_map(|w| &w.found).collect(),
        },
        Section {
            title: "Bias of the straight pendulum (3.8-3.10)",
            words: "All bodies on one line, as the thesis lumps them, fitted to the same swings; beside it the leg \
                    with every body in its place.",
            key: "straight",
            beside: "exact leg",
            rows: weighed.iter().flat_map(|w| &w.straight).collect(),
        },
    ]
}

impl Section<'_> {
    /// The columns in which some row has something to say, and their cells.
    pub(super) fn shown(&self) -> Shown {
        let headings =
            ["of", "what", "swings", self.beside, "four tests", "ours", "low", "high", "difference", "inside"];
        let all: Vec<[String; 10]> = self.rows.iter().map(|row| cells(row)).collect();
        let same_swings = self.rows.windows(2).all(|pair| pair[0].swings == pair[1].swings);
        let used: Vec<usize> = (0..headings.len())
            .filter(|&k| !(k == 2 && same_swings) && all.iter().any(|cells| !cells[k].is_empty()))
            .collect();
        let remark = |row: &&&Row| !row.remark.is_empty() && row.interval.is_some();
        Shown {
            columns: used.iter().map(|&k| headings[k]).collect(),
            words: used.iter().filter(|&&k| k < WORDS).count(),
            rows: all.iter().map(|cells| used.iter().map(|&k| cells[k].clone()).collect()).collect(),
            remarks: self
                .rows
                .iter()
                .filter(remark)
                .map(|row| format!("{}, {}: {}.", row.of.name(), row.quantity, row.remark))
                .collect(),
        }
    }
}

/// The cells of a row.
fn cells(row: &Row) -> [String; 10] {
    let [ours, low, high] = match (row.ours, row.interval) {
        (Some(ours), Some(interval)) => {
            let shown = format_with_uncertainty(ours, interval);
            [shown.value, shown.low, shown.high]
        }
        (Some(ours), None) if row.remark == "set" || row.remark == "held" => {
            [format!("{} {}", row.remark, as_given(ours)), String::new(), String::new()]
        }
        _ => ["not determined".to_owned(), String::new(), String::new()],
    };
    let known = row.difference().filter(|_| row.interval.is_some());
    let inside = row.inside().map(|inside| if inside { "yes" } else { "no" });
    [
        row.of.name().to_owned(),
        format!("{} [{}]", row.quantity, row.unit),
        row.swings.clone(),
        row.thesis.map(short).unwrap_or_default(),
        row.average().map(|mean| significant(mean, 3)).unwrap_or_default(),
        ours,
        low,
        high,
        known.map(signed).unwrap_or_default(),
        inside.unwrap_or_default().to_owned(),
    ]
}

/// A printed number; one that was computed has no more than four digits.
fn short(value: f64) -> String {
    let given = as_given(value);
    if given.len() > 6 { significant(value, 4) } else { given }
}

fn signed(value: f64) -> String {
    if value.abs() < 1e-9 {
        return "0".to_owned();
    }
    let text = significant(value, 2);
    if value > 0.0 { format!("+{text}") } else { text }
}
