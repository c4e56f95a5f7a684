//! The full model's drop in words and as a table.

use super::{FullDrop, HeldRow};
use crate::report::number::significant;
use crate::report::rows::shorten;
use crate::report::text::{finish, number, one_line, table, wrap};
use comfy_table::Cell;

const NAME: usize = 20;

/// Table and summary, `width` columns wide.
pub(in crate::report) fn full_text(full: &FullDrop, width: usize) -> String {
    let numbers = [
        "pendulum\nRMS [mrad]",
        "rigid\nRMS [mrad]",
        "by PID\nRMS [mrad]",
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
            Cell::new(shorten(&one_line(&row.file), NAME)),
            number(milli(Some(row.pendulum_rms))),
            number(milli(rigid.rms)),
            number(milli(controlled.rms)),
            number(both(|held| held.first_swing, rigid, controlled)),
            number(both(|held| held.rest, rigid, controlled)),
            number(milli(Some(row.give))),
        ]);
    }
    format!("{}\n\n{}", finish(&mut rows), wrap(width, &summary(full), "", ""))
}

/// One paragraph: what the held joints do, and what remains.
pub(in crate::report) fn summary(full: &FullDrop) -> String {
    let mean = |of: &dyn Fn(&super::FullRow) -> Option<f64>| {
        let squares: Vec<f64> = full.rows.iter().filter_map(of).map(|rms| rms * rms).collect();
        (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
    };
    let between: Vec<f64> = full
        .curves
        .iter()
        .flat_map(|c| c.rigid_rad.iter().zip(&c.controlled_rad).skip(c.first).map(|(a, b)| (a - b).powi(2)))
        .filter(|square| square.is_finite())
        .collect();
    let held = (between.iter().sum::<f64>() / between.len().max(1) as f64).sqrt();
    let [pendulum, rigid, controlled] =
        [mean(&|row| Some(row.pendulum_rms)), mean(&|row| row.rigid.rms), mean(&|row| row.controlled.rms)]
            .map(|rms| significant(1e3 * rms, 3));
    format!(
        "The same drop in the whole robot with the fitted values, trunk clamped (Figure 3.6): {rigid} mrad with the other \
         joints rigid, as the pendulum ({pendulum} mrad) takes them, {controlled} mrad with them held by their PID (Table B.2); \
         how they are held moves the swing by {} mrad, part of which the values fitted to a rigid pendulum have taken in.",
        significant(1e3 * held, 3)
    )
}
