//! Whether the numbers of a source can be radians and seconds, and what they look like if not.

use super::channel::{Channel, Source};
use super::defects::Defects;
use super::want::Want;
use crate::log::column::Column;
use crate::log::columns::{ColumnSpec, Columns, Unit};
use crate::log::error::{LogError, UnitFault};
use crate::log::plausible;
use std::f64::consts::TAU;

/// Counts to a turn where nobody says: most servos and encoders of joints have 12 bits.
const USUAL_PER_REV: f64 = 4096.0;

impl Source {
    /// Adds what looks like another unit, and answers with the units that it looks like, by cell.
    pub(super) fn unit_defects(&self, want: Want<'_>, defects: &mut Defects) -> Vec<(usize, Unit)> {
        let mut units: Vec<(usize, Unit)> = Vec::new();
        let mut seen_clocks: Vec<usize> = Vec::new();
        for (angle, setpoint) in self.angles(want) {
            for (column, index, fault) in self.faults(angle, setpoint) {
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

    /// The angles that are wanted, each with its setpoint.
    fn angles<'a>(&'a self, want: Want<'a>) -> impl Iterator<Item = (&'a Channel, Option<&'a Channel>)> {
        let wanted = self.channels.iter().filter(move |channel| channel.is_wanted(want));
        wanted.filter(|channel| is_of(channel, Column::Angle)).map(|angle| {
            let setpoint = format!("{}_ref", angle.ours.as_deref().unwrap_or_default());
            (angle, self.ours(&setpoint))
        })
    }

    /// What cannot be of the unit that it is taken to be in; a unit that somebody said is not questioned.
    fn faults(&self, angle: &Channel, setpoint: Option<&Channel>) -> Vec<(Column, usize, UnitFault)> {
        let q_ref = setpoint.map_or(&[][..], |channel| &channel.values);
        let is_stated = |channel: &Channel| channel.ours.as_ref().is_some_and(|ours| self.stated.contains(ours));
        let mut faults = plausible::faults(self.t_s(angle), &angle.values, q_ref);
        faults.retain(|(column, ..)| match column {
            Column::Angle => !is_stated(angle),
            Column::Setpoint => !setpoint.is_some_and(is_stated),
            _ => true,
        });
        faults
    }

    /// The lines of `[columns]` that would read angles of a file without rows as what they look like.
    pub(super) fn mend(&self, want: Want<'_>) -> Columns {
        let mut columns = Columns::default();
        for (angle, setpoint) in self.angles(want) {
            for (column, _, fault) in self.faults(angle, setpoint) {
                let of_both = [Some(angle).filter(|_| column == Column::Angle), setpoint];
                for channel in of_both.into_iter().flatten().filter(|_| column != Column::Time) {
                    let spec = ColumnSpec { unit: Some(looks_like(fault)), ..ColumnSpec::named(&channel.theirs) };
                    columns.0.entry(channel.ours.clone().unwrap_or_default()).or_insert(spec);
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
