//! What was there against what was answered.

use crate::blind::Table;
use crate::report::ReportError;
use crate::report::plot::canvas::{EXTENSIVE, POSITIVE};
use crate::report::plot::heat::{Heat, HeatCell, UNUSED, heat, tint};

/// Draws the table as counts; the colour is the share of the row, of right answers blue and of wrong ones vermillion.
pub(super) fn confusion(table: &Table) -> Result<String, ReportError> {
    let totals: Vec<u32> = table.counts.iter().map(|row| row.iter().sum()).collect();
    let rows: Vec<String> = table.rows.iter().zip(&totals).map(|(name, total)| format!("{name} ({total})")).collect();
    let columns: Vec<String> = table.columns.iter().map(|name| (*name).to_owned()).collect();
    let map = Heat {
        title: "What was there, and what was answered",
        rows: &rows,
        columns: &columns,
        name_room: 150.0,
        cell: [44.0, 30.0],
        names_above: false,
        axes: ["there (studies) \u{2193}", "answered \u{2192}, names below"],
        colour: |share| tint(if share < 0.0 { POSITIVE } else { EXTENSIVE }, share.abs()),
        scale: &[(1.0, "right"), (0.0, "0 %"), (-1.0, "wrong")],
        nothing: "nothing was answered",
    };
    heat(&map, |row, column| {
        let is_right = Table::is_right(table.rows[row], table.columns[column]);
        let count = table.counts[row][column];
        let share = f64::from(count) / f64::from(totals[row].max(1));
        let colour = if is_right { EXTENSIVE } else { POSITIVE };
        HeatCell {
            // a single answer of many is still seen
            ground: if count > 0 { tint(colour, 0.12 + 0.88 * share) } else { UNUSED },
            words: if count > 0 { count.to_string() } else { String::new() },
            framed: is_right,
        }
    })
}
