//! The full model's drop in words and as a table.

use super::{FullDrop, HeldRow};
use crate::report::number::significant;
use crate::report::rows::shorten;
use crate::report::text::{finish, number, one_line, table, wrap};
use comfy_table::Cell;
use std::path::Path;

const NAME: usize = 16;

/// One RMS is clearly above another from this ratio on.
const CLEARLY: f64 = 1.2;

/// Table and summary, `width` columns wide.
pub(in crate::report) fn full_text(full: &FullDrop, width: usize) -> String {
    let numbers = [
        "pendulum\nRMS [mrad]",
        "rigid, PID\nRMS [mrad]",
        "zero refitted:\nrigid, PID [mrad]",
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
            number(both(|held| held.rms, &row.rigid_apart, &row.controlled_apart)),
            number(both(|held| held.first_swing, rigid, controlled)),
            number(both(|held| held.rest, rigid, controlled)),
            number(milli(Some(row.give))),
        ]);
    }
    format!("{}\n\n{}", finish(&mut rows), wrap(width, &summary(full), "", ""))
}

/// The log's name without its folder.
fn name(file: &str) -> String {
    Path::new(file).file_name().map_or_else(|| file.to_owned(), |name| name.to_string_lossy().into_owned())
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
    let moved = (between.iter().sum::<f64>() / between.len().max(1) as f64).sqrt();
    let milli = |value: f64| significant(1e3 * value, 3);
    let own = mean(&|row| row.rigid.rms);
    let [pendulum, rigid, controlled] =
        [mean(&|row| Some(row.pendulum_rms)), own, mean(&|row| row.controlled.rms)].map(milli);
    let (apart, remains) = (mean(&|row| row.rigid_apart.rms), mean(&|row| row.controlled_apart.rms));
    let share = if apart > 0.0 { (1.0 - (remains / apart).powi(2)).max(0.0) } else { 0.0 };
    let doubt = if remains > CLEARLY * own {
        format!(
            " Rigid joints with their own zero follow better ({rigid} mrad): either these joints were held rigidly, or the \
             values that were fitted with rigid joints have taken in what they do."
        )
    } else {
        String::new()
    };
    format!(
        "The same drop in the whole robot with the fitted values, trunk clamped (Figure 3.6): {rigid} mrad with the other \
         joints rigid, as the pendulum ({pendulum} mrad) takes them, {controlled} mrad with them held by their PID (Table B.2). \
         The zero was fitted with rigid joints and may have taken in how far the others droop; for joints that give it is \
         {} mrad instead of {}. With that zero the gap splits: {} mrad with rigid joints, {} mrad with joints that give. The \
         held joints, which move the swing by {} mrad, account for {:.0} % of its mean square; the rest remains.{doubt}",
        milli(full.refitted_rad),
        milli(full.zero_rad),
        milli(apart),
        milli(remains),
        milli(moved),
        100.0 * share
    )
}
