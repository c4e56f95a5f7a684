//! The full model's drop in words and as a table.

use super::{FullDrop, HeldRow, causes_text, refit_words};
use crate::report::number::{mrad, significant};
use crate::report::rows::shorten;
use crate::report::text::{finish, number, one_line, table, wrap};
use comfy_table::Cell;
use std::path::Path;

const NAME: usize = 16;

/// Table and summary, `width` columns wide.
pub(in crate::report) fn full_text(full: &FullDrop, width: usize) -> String {
    let numbers = [
        "pendulum\nRMS [mrad]",
        "as fitted:\nrigid, PID [mrad]",
        "refitted:\nrigid, PID [mrad]",
        "first swing\nrigid, PID [ms]",
        "at rest\nrigid, PID [mrad]",
        "others give\n[mrad]",
    ];
    let mut rows = table(width, &["whole robot"], &numbers);
    let milli = |value: Option<f64>| value.map_or("-".to_owned(), |value| significant(1e3 * value, 3));
    let both =
        |of: fn(&HeldRow) -> Option<f64>, a: &HeldRow, b: &HeldRow| format!("{}, {}", milli(of(a)), milli(of(b)));
    for row in &full.rows {
        let (rigid, controlled) = (&row.rigid, &row.controlled);
        rows.add_row([
            Cell::new(shorten(&one_line(&name(&row.file)), NAME)),
            number(milli(Some(row.pendulum_rms))),
            number(both(|held| held.rms, rigid, controlled)),
            number(both(|held| held.rms, &row.rigid_refitted, &row.controlled_refitted)),
            number(both(|held| held.first_swing, &row.rigid_refitted, &row.controlled_refitted)),
            number(both(|held| held.rest, &row.rigid_refitted, &row.controlled_refitted)),
            number(milli(Some(row.give))),
        ]);
    }
    let causes = full.refit.as_ref().filter(|refit| refit.ranked());
    let causes = causes.map_or_else(String::new, |refit| format!("{}\n\n", causes_text(refit, width)));
    format!("{}\n\n{causes}{}", finish(&mut rows), wrap(width, &summary(full), "", ""))
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
        "The same drop in the whole robot, trunk clamped (Figure 3.6), with the pendulum's values: {} with the other joints \
         rigid, as the pendulum ({}) takes them, {} with them held by their PID (Table B.2).",
        mean(&|row| row.rigid.rms),
        mean(&|row| Some(row.pendulum_rms)),
        mean(&|row| row.controlled.rms)
    );
    match &full.refit {
        Some(refit) => format!("{as_fitted} {}", refit_words(refit)),
        None => as_fitted,
    }
}
