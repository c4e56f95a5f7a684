//! Reads a log: CSV in the format of one joint, or one joint out of a log of several.
//!
//! The file is streamed once; the only thing that grows is the columns that are kept. A file with a fault is opened a
//! second time to show the offending line.

use std::path::Path;

use csv::ByteRecord;

use super::error::{CellFault, LogError};
use super::header::{Column, Header};
use super::place::{Place, Subject};
use super::plausible::{self, Extremes, Row};
use super::rows;
use super::types::Log;

/// Reads the log of one joint: columns `t` \[s\], `q` \[rad\] and, where present, `dq`, `tau`, `q_ref`, `drive`.
///
/// Columns are found by name in any order; others are ignored and listed in [`Log::ignored_columns`].
///
/// # Errors
/// [`LogError`] for anything that is not a well-formed log in SI units; see its variants.
pub fn read_log(path: &Path) -> Result<Log, LogError> {
    read_joint_log(path, None)
}

/// Reads one joint of a log of several (`<joint>.q`, `<joint>.q_ref`, ...); without a joint as [`read_log`].
///
/// # Errors
/// As [`read_log`], and [`LogError::NoSuchJoint`] if the log does not have the joint.
pub fn read_joint_log(path: &Path, joint: Option<&str>) -> Result<Log, LogError> {
    let mut table: Option<Table> = None;
    rows::for_each_row(path, |row, record| match &mut table {
        None => {
            let cells = rows::text_cells(path, row, record)?;
            table = Some(Table::new(path, Header::find(path, &cells, row.byte, joint)?, row));
            Ok(())
        }
        Some(table) => table.push(row, record),
    })?;
    table.ok_or_else(|| LogError::Empty { file: path.to_path_buf() })?.finish()
}

/// The columns as they are read.
struct Table<'a> {
    path: &'a Path,
    header: Header,
    header_row: Row,
    /// In the order of [`KEPT`].
    columns: [Vec<f64>; 5],
    drive: Vec<bool>,
    previous: Row,
    extremes: Extremes,
}

/// The columns that hold numbers.
const KEPT: [Column; 5] = [Column::Time, Column::Angle, Column::Speed, Column::Torque, Column::Setpoint];

impl<'a> Table<'a> {
    fn new(path: &'a Path, header: Header, header_row: Row) -> Self {
        let extremes = Extremes::default();
        Self {
            path,
            header,
            header_row,
            columns: Default::default(),
            drive: Vec::new(),
            previous: header_row,
            extremes,
        }
    }

    fn place(&self, row: Row, column: Column) -> Box<Place> {
        let subject = Subject::Column(self.header.column_name(column));
        Box::new(Place::in_log(self.path, row.byte, row.line, subject, self.header.cell(column)))
    }

    fn push(&mut self, row: Row, record: &ByteRecord) -> Result<(), LogError> {
        rows::check_row(self.path, row, record, &self.header.names)?;
        for (k, column) in KEPT.into_iter().enumerate() {
            let Some(cell) = self.header.cell(column).and_then(|i| record.get(i)) else { continue };
            let value = self.number(row, column, cell)?;
            if column == Column::Time {
                self.check_time(row, value)?;
            }
            self.columns[k].push(value);
            self.extremes.see(column, value, row);
        }
        if let Some(cell) = self.header.cell(Column::Drive).and_then(|i| record.get(i)) {
            let value = rows::switch(cell).map_err(|fault| self.cell_error(row, Column::Drive, cell, fault))?;
            self.drive.push(value);
        }
        self.previous = row;
        Ok(())
    }

    fn number(&self, row: Row, column: Column, cell: &[u8]) -> Result<f64, LogError> {
        rows::number(cell, column.limit(), column.unit(), self.columns[0].is_empty())
            .map_err(|fault| self.cell_error(row, column, cell, fault))
    }

    fn cell_error(&self, row: Row, column: Column, cell: &[u8], fault: CellFault) -> LogError {
        rows::cell_error(self.place(row, column), cell, fault)
    }

    fn check_time(&mut self, row: Row, time_s: f64) -> Result<(), LogError> {
        let Some(&previous_s) = self.columns[0].last() else { return Ok(()) };
        if time_s <= previous_s {
            let previous_line = self.place(self.previous, Column::Time).line;
            return Err(LogError::TimeOrder { at: self.place(row, Column::Time), previous_line, time_s, previous_s });
        }
        self.extremes.see_step(time_s - previous_s, self.previous, row);
        Ok(())
    }

    fn finish(self) -> Result<Log, LogError> {
        let samples = self.columns[0].len();
        if samples < 2 {
            let row = if samples == 0 { self.header_row } else { self.previous };
            return Err(rows::too_few(self.path, row, samples));
        }
        let fault = plausible::check(&self.columns[0], &self.columns[1], &self.columns[4], &self.extremes);
        if let Some((row, column, fault)) = fault {
            return Err(LogError::Units { at: self.place(row, column), fault });
        }
        if let Some((gap_s, before, after)) = self.extremes.gap {
            let previous_line = self.place(before, Column::Time).line;
            return Err(LogError::TimeGap { at: self.place(after, Column::Time), previous_line, gap_s });
        }
        let ignored_columns = self.header.ignored();
        let present = |column| self.header.cell(column).is_some();
        let [t_s, q_rad, dq, tau, q_ref] = self.columns;
        Ok(Log {
            file: self.path.to_path_buf(),
            t_s,
            q_rad,
            dq_rad_s: present(Column::Speed).then_some(dq),
            tau_nm: present(Column::Torque).then_some(tau),
            q_ref_rad: present(Column::Setpoint).then_some(q_ref),
            drive: present(Column::Drive).then_some(self.drive),
            ignored_columns,
        })
    }
}
