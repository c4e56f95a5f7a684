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
    /// Its rows.
    pub rows: Vec<&'a Row>,
}

/// Headings of the columns.
pub(super) const COLUMNS: [&str; 9] =
    ["of", "what", "swings", "unit", "thesis", "four tests", "ours", "95 % interval", "difference"];

/// The tables in the thesis's order.
pub(super) fn sections(tables: &Tables) -> Vec<Section<'_>> {
    let ratios = &tables.ratios;
    let weighed = &tables.weighed;
    vec![
        Section {
            title: "Table 3.1: arithmetic",
            words: "Mass (3.5) and friction (3.6) from the printed ratios. The interval is what the rounding of the \
                    printed digits leaves open.",
            key: "table_3_1_arithmetic",
            rows: ratios.iter().flat_map(|t| &t.arithmetic).collect(),
        },
        Section {
            title: "Table 3.1: from the swings, g/L fitted",
            words: "The simple pendulum (3.2) fitted to all swings with one extra mass.",
            key: "table_3_1",
            rows: tables.table_3_1(),
        },
        Section {
            title: "Table 3.1: from the swings, g/L set as printed",
            words: "The same with g/L held at 60, 60 and 75 1/s^2 in both tests.",
            key: "table_3_1_set",
            rows: ratios.iter().flat_map(|t| &t.set).collect(),
        },
        Section {
            title: "Table 3.2: masses",
            words: "About q3 first, then q2 with the lower leg's mass held, then q1 with both. Four tests: the mean of \
                    the tests that the thesis took, each fitted alone. Ours: one fit of all swings about the joint; \
                    its interval allows for that of the masses held.",
            key: "table_3_2",
            rows: tables.table_3_2(),
        },
        Section {
            title: "Table 3.3: friction",
            words: "From the same fits.",
            key: "table_3_3",
            rows: tables.table_3_3(),
        },
        Section {
            title: "Tables 3.2 and 3.3, one load at a time",
            words: "With and without extra mass; the other masses are held.",
            key: "by_load",
            rows: weighed.iter().flat_map(|w| &w.by_load).collect(),
        },
        Section {
            title: "Table 3.4: friction chosen for the robot",
            words: "From the swings that the thesis chose, bare ones or those with the lowest extra mass, with all \
                    masses held. Written to robot.toml.",
            key: "table_3_4",
            rows: tables.table_3_4(),
        },
        Section {
            title: "Bias of the straight pendulum (3.8-3.10)",
            words: "All bodies on one line, as the thesis lumps them, fitted to the same swings; beside it, in the \
                    place of the thesis, the exact leg.",
            key: "straight",
            rows: weighed.iter().flat_map(|w| &w.straight).collect(),
        },
    ]
}

/// The cells of a row, under [`COLUMNS`].
pub(super) fn cells(row: &Row) -> [String; 9] {
    let (ours, interval) = match (row.ours, row.interval) {
        (Some(ours), Some(interval)) => {
            let shown = format_with_uncertainty(ours, interval);
            (shown.value, format!("{} to {}", shown.low, shown.high))
        }
        (Some(ours), None) => (format!("{} ({})", significant(ours, 4), row.remark), String::new()),
        (None, _) => ("not determined".to_owned(), String::new()),
    };
    let difference = match (row.difference(), row.inside()) {
        (Some(difference), Some(inside)) => {
            let mark = if inside { "inside" } else { "outside" };
            format!("{} {mark}", signed(difference))
        }
        _ => String::new(),
    };
    [
        row.of.name().to_owned(),
        row.quantity.clone(),
        row.swings.clone(),
        row.unit.clone(),
        row.thesis.map(short).unwrap_or_default(),
        row.average().map(|mean| significant(mean, 3)).unwrap_or_default(),
        ours,
        interval,
        difference,
    ]
}

/// A printed number; one that was computed has no more than five digits.
fn short(value: f64) -> String {
    let given = as_given(value);
    if given.len() > 8 { significant(value, 4) } else { given }
}

fn signed(value: f64) -> String {
    let text = significant(value, 2);
    if value >= 0.0 { format!("+{text}") } else { text }
}
