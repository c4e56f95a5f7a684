//! A walk for a terminal.

use super::WalkReport;
use crate::report::number::significant;
use crate::report::text::{finish, number, table, wrap};
use comfy_table::Cell;

const WIDTH: usize = 100;

/// The report as text, a hundred columns wide.
pub fn walk_text(report: &WalkReport) -> String {
    let mut text = wrap(WIDTH, &report.sentence, "", "");
    text.push_str("\n\n");
    if !report.joints.is_empty() {
        let numbers = ["amplitude [rad]", "ratio", "delay [ms]", "RMS [mrad]", "worst [mrad]", "peak [rad/s]"];
        let mut rows = table(WIDTH, &["joint"], &numbers);
        for row in &report.joints {
            rows.add_row([
                Cell::new(&row.joint),
                number(format!("{:.4}", row.amplitude_rad)),
                number(format!("{:.4}", row.amplitude_ratio)),
                number(format!("{:.2}", 1e3 * row.delay_s)),
                number(significant(1e3 * row.rms_rad, 3)),
                number(significant(1e3 * row.worst_rad, 3)),
                number(significant(row.peak_rad_s, 3)),
            ]);
        }
        text.push_str(&finish(&mut rows));
        text.push_str("\n\n");
    }
    for note in &report.notes {
        text.push_str(&wrap(WIDTH, note, "- ", "  "));
        text.push('\n');
    }
    let factor = significant(report.realtime_factor, 3);
    text.push_str(&wrap(WIDTH, &format!("{} {factor} times real time.", cost(report)), "", ""));
    text.push('\n');
    text
}

/// Method and cost in one sentence.
pub(super) fn cost(report: &WalkReport) -> String {
    format!(
        "{}: {} s simulated in {} steps, {} evaluations of the equations of motion.",
        report.method,
        significant(report.duration_s, 4),
        report.integration_steps,
        report.evaluations
    )
}
