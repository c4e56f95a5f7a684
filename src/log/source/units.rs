//! Whether the numbers of a source can be radians and seconds, and what they look like if not.

use super::channel::{Channel, Source};
use super::defects::Defects;
use crate::log::column::Column;
use crate::log::columns::{ColumnSpec, Columns, Unit};
use crate::log::error::{LogError, UnitFault};
use crate::log::plausible;
use std::f64::consts::TAU;

/// Counts to a turn where nobody says: most servos and encoders of joints have 12 bits.
const USUAL_PER_REV: f64 = 4096.0;

impl Source {
    /// Adds what looks like another unit, and answers with the units that it looks like, by cell.
    pub(super) fn unit_defects(&self, defects: &mut Defects) -> Vec<(usize, Unit)> {
        let mut units: Vec<(usize, Unit)> = Vec::new();
        let mut seen_clocks: Vec<usize> = Vec::new();
        for angle in self.channels.iter().filter(|channel| is_of(channel, Column::Angle)) {
            let joint = angle.ours.as_deref().and_then(crate::log::column::column_of).and_then(|(joint, _)| joint);
            let name = joint.map_or_else(|| Column::Setpoint.name().to_owned(), |joint| format!("{joint}.q_ref"));
            let setpoint = self.ours(&name);
            let q_ref = setpoint.map_or(&[][..], |channel| &channel.values);
            for (column, index, fault) in plausible::faults(self.t_s(angle), &angle.values, q_ref) {
                let channel = if column == Column::Setpoint { setpoint.unwrap_or(angle) } else { angle };
                let is_time = column == Column::Time;
                if is_time && seen_clocks.contains(&angle.clock) {
                    continue;
                }
                let cell = match (&self.rows, is_time) {
                    (Some(rows), true) => Some(rows.time.0),
                    _ => channel.cell,
                };
                if let Some(cell) = cell {
                    units.push((cell, looks_like(fault)));
                }
                if is_time {
                    seen_clocks.push(angle.clock);
                }
                defects.push(cell, LogError::Units { at: self.place(channel, index, is_time), fault });
            }
        }
        units
    }
}

impl Source {
    /// The lines of `[columns]` that would read angles of a file without rows as what they look like.
    pub(super) fn mend(&self) -> Columns {
        let mut columns = Columns::default();
        for angle in self.channels.iter().filter(|channel| is_of(channel, Column::Angle)) {
            for (column, _, fault) in plausible::faults(self.t_s(angle), &angle.values, &[]) {
                let joint = angle.ours.as_deref().and_then(crate::log::column::column_of).and_then(|(joint, _)| joint);
                for name in [Column::Angle, Column::Setpoint].iter().filter(|_| column == Column::Angle) {
                    let ours = joint.map_or_else(|| name.name().to_owned(), |joint| format!("{joint}.{}", name.name()));
                    if let Some(channel) = self.ours(&ours) {
                        let spec = ColumnSpec { unit: Some(looks_like(fault)), ..ColumnSpec::named(&channel.theirs) };
                        columns.0.insert(ours, spec);
                    }
                }
            }
        }
        columns
    }
}

fn is_of(channel: &Channel, column: Column) -> bool {
    channel.ours.as_deref().and_then(crate::log::column::column_of).is_some_and(|(_, found)| found == column)
}

/// The unit that a fault suggests.
fn looks_like(fault: UnitFault) -> Unit {
    match fault {
        UnitFault::Time { unit, .. } => Unit::Time(match unit {
            "nanoseconds" => 1e-9,
            "microseconds" => 1e-6,
            _ => 1e-3,
        }),
        // Whatever was said; should they be milliseconds, they show when they are tried.
        UnitFault::Haste { .. } => Unit::Time(1.0),
        UnitFault::Counts { .. } => Unit::Ticks { per_rev: USUAL_PER_REV },
        UnitFault::Angle { .. } | UnitFault::Speed { .. } | UnitFault::Setpoint { .. } => Unit::Angle(TAU / 360.0),
    }
}
