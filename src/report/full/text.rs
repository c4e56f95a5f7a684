//! The full model's drop in words and as a table.

use super::{FullDrop, HeldRow, causes_table, refit_words};
use crate::report::grid::Grid;
use crate::report::number::{capital, mrad, significant};
use crate::report::rows::shorten;
use crate::report::text::wrap;
use std::path::Path;

const NAME: usize = 16;

/// Tables and summary, `width` columns wide.
pub(in crate::report) fn full_text(full: &FullDrop, width: usize) -> String {
    let tables: Vec<String> = full_tables(full).iter().map(|grid| grid.text(width)).collect();
    format!("{}\n\n{}", tables.join("\n\n"), wrap(width, &summary(full), "", ""))
}

/// The whole robot log by log, and what each explanation is worth where they were ranked.
pub(in crate::report) fn full_tables(full: &FullDrop) -> Vec<Grid> {
    let milli = |value: Option<f64>| value.map_or("-".to_owned(), |value| significant(1e3 * value, 3));
    let both =
        |of: fn(&HeldRow) -> Option<f64>, a: &HeldRow, b: &HeldRow| format!("{}, {}", milli(of(a)), milli(of(b)));
    let row = |row: &super::FullRow| {
        let numbers = vec![
            milli(Some(row.pendulum_rms)),
            both(|held| held.rms, &row.rigid, &row.controlled),
            both(|held| held.rms, &row.rigid_refitted, &row.controlled_refitted),
            both(|held| held.first_swing, &row.rigid_refitted, &row.controlled_refitted),
            both(|held| held.rest, &row.rigid_refitted, &row.controlled_refitted),
            milli(Some(row.give)),
        ];
        (shorten(&name(&row.file), NAME), numbers)
    };
    let robot = Grid {
        name: "whole robot",
        numbers: vec![
            "pendulum\nRMS [mrad]",
            "as fitted:\nrigid, PID [mrad]",
            "refitted:\nrigid, PID [mrad]",
            "first swing\nrigid, PID [ms]",
            "at rest\nrigid, PID [mrad]",
            "others give\n[mrad]",
        ],
        rows: full.rows.iter().map(row).collect(),
    };
    let causes = full.refit.as_ref().filter(|refit| refit.ranked()).map(causes_table);
    std::iter::once(robot).chain(causes).collect()
}

/// The log's name without its folder.
fn name(file: &str) -> String {
    Path::new(file).file_name().map_or_else(|| file.to_owned(), |name| name.to_string_lossy().into_owned())
}

/// One paragraph: what the held joints do, and what remains.
pub(in crate::report) fn summary(full: &FullDrop) -> String {
    let mean = |of: &dyn Fn(&super::FullRow) -> Option<f64>| {
        let squares: Vec<f64> = full.rows.iter().filter_map(of).map(|rms| rms * rms).collect();
        mrad((squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt())
    };
    let as_fitted = format!(
        "With the pendulum's values the whole robot, trunk clamped (Figure 3.6), is off by {} with the other joints rigid, as the \
         pendulum ({}) takes them, by {} with them held by their PID.",
        mean(&|row| row.rigid.rms),
        mean(&|row| Some(row.pendulum_rms)),
        mean(&|row| row.controlled.rms)
    );
    match &full.refit {
        Some(refit) => format!("{} {as_fitted}", capital(&refit_words(refit))),
        None => as_fitted,
    }
}
