//! Reads a log: CSV in the format of one joint, or one joint out of a log of several.
//!
//! The file is streamed once; the only thing that grows is the columns that are kept. A file with a fault is opened a
//! second time to show the offending line.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use csv::ByteRecord;

use super::error::{CellFault, FileKind, LogError};
use super::header::{Column, Header};
use super::place::{Place, Subject};
use super::plausible::{self, Extremes, Row};
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
    let failed = |source| LogError::Read { file: path.to_path_buf(), source };
    let mut input = BufReader::with_capacity(1 << 16, File::open(path).map_err(failed)?);
    if let Some(found) = not_text(input.fill_buf().map_err(failed)?) {
        return Err(LogError::NotText { file: path.to_path_buf(), found });
    }
    let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(input);
    let mut record = ByteRecord::new();
    let mut table: Option<Table> = None;
    while reader.read_byte_record(&mut record).map_err(|error| failed(error.into()))? {
        if record.iter().all(<[u8]>::is_empty) && record.len() < 2 || record.len() == 1 && is_blank(&record[0]) {
            continue;
        }
        let row = Row {
            byte: record.position().map_or(0, csv::Position::byte),
            line: record.position().map_or(1, csv::Position::line),
        };
        match &mut table {
            None => {
                let cells = text_cells(path, row, &record)?;
                table = Some(Table::new(path, Header::find(path, &cells, row.byte, joint)?, row));
            }
            Some(table) => table.push(row, &record)?,
        }
    }
    table.ok_or_else(|| LogError::Empty { file: path.to_path_buf() })?.finish()
}

/// Recognises files that are no UTF-8 text by their first bytes.
pub(super) fn not_text(start: &[u8]) -> Option<FileKind> {
    match start {
        [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] => Some(FileKind::Utf16),
        [b'P', b'K', 3, 4, ..] => Some(FileKind::Zip),
        [0x1F, 0x8B, ..] => Some(FileKind::Gzip),
        _ => {
            let head = &start[..start.len().min(512)];
            let zeros = head.iter().filter(|&&b| b == 0).count();
            // ASCII in UTF-16 has a zero in every other byte
            (zeros > 0).then_some(if zeros * 5 >= head.len() * 2 { FileKind::Utf16 } else { FileKind::Binary })
        }
    }
}

fn is_blank(cell: &[u8]) -> bool {
    cell.iter().all(u8::is_ascii_whitespace)
}

fn text_cells<'a>(path: &Path, row: Row, record: &'a ByteRecord) -> Result<Vec<&'a str>, LogError> {
    record.iter().enumerate().map(|(i, cell)| text_of(path, row, None, i, cell)).collect()
}

/// The cell as text, or the error that names its first byte that is not UTF-8.
fn text_of<'a>(path: &Path, row: Row, name: Option<&str>, i: usize, cell: &'a [u8]) -> Result<&'a str, LogError> {
    std::str::from_utf8(cell).map_err(|error| {
        let subject = name.filter(|name| !name.is_empty()).map_or(Subject::Line, |name| Subject::Column(name.into()));
        let at = Box::new(Place::in_log(path, row.byte, row.line, subject, Some(i)));
        LogError::NotUtf8 { at, byte: cell.get(error.valid_up_to()).copied().unwrap_or(0) }
    })
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
        let expected = self.header.names.len();
        if std::str::from_utf8(record.as_slice()).is_err() {
            for (i, cell) in record.iter().enumerate() {
                text_of(self.path, row, self.header.names.get(i).map(String::as_str), i, cell)?;
            }
        }
        if record.len() != expected {
            return Err(self.row_length(row, record, expected));
        }
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
            let value = match cell {
                b"1" => true,
                b"0" => false,
                other => match String::from_utf8_lossy(other).trim().parse::<f64>() {
                    Ok(1.0) => true,
                    Ok(0.0) => false,
                    _ => return Err(self.cell_error(row, Column::Drive, other, CellFault::Drive)),
                },
            };
            self.drive.push(value);
        }
        self.previous = row;
        Ok(())
    }

    fn number(&self, row: Row, column: Column, cell: &[u8]) -> Result<f64, LogError> {
        let text = std::str::from_utf8(cell).unwrap_or("").trim();
        let fault = match text.parse::<f64>() {
            Ok(value) if !value.is_finite() => CellFault::NotFinite,
            Ok(value) if value.abs() > column.limit() => {
                CellFault::Absurd { limit: column.limit(), unit: column.unit() }
            }
            Ok(value) => return Ok(value),
            Err(_) if text.is_empty() => CellFault::Empty,
            Err(_) if text.replacen(',', ".", 1).parse::<f64>().is_ok() => CellFault::DecimalComma,
            Err(_) if text.replacen(['\u{2212}', '\u{2013}'], "-", 1).parse::<f64>().is_ok() => CellFault::Minus,
            Err(_) => CellFault::Text { first_row: self.columns[0].is_empty(), unit: column.unit() },
        };
        Err(self.cell_error(row, column, cell, fault))
    }

    fn cell_error(&self, row: Row, column: Column, cell: &[u8], fault: CellFault) -> LogError {
        let found: String = String::from_utf8_lossy(cell).trim().chars().take(40).collect();
        let fault = if found.is_empty() { CellFault::Empty } else { fault };
        LogError::Cell { at: self.place(row, column), found, fault }
    }

    fn row_length(&self, row: Row, record: &ByteRecord, expected: usize) -> LogError {
        let found = record.len();
        let whole = |cell: &[u8]| {
            let text = String::from_utf8_lossy(cell);
            text.trim().trim_start_matches('-').chars().all(|c| c.is_ascii_digit()) && !text.trim().is_empty()
        };
        let hint = if found == 1 && record[0].iter().any(|b| matches!(b, b';' | b'\t')) {
            Some("the row is not separated by commas")
        } else if found > expected && record.iter().all(whole) {
            Some("decimal commas? write `0.5`, not `0,5`")
        } else if found == expected + 1 && record.get(expected).is_some_and(is_blank) {
            Some("remove the comma at the end of the row")
        } else if found < expected {
            Some("was the recording cut off in this row? complete or delete it")
        } else {
            None
        };
        let cell = if found > expected { Some(expected) } else { None };
        let at = Box::new(Place::in_log(self.path, row.byte, row.line, Subject::Line, cell));
        LogError::RowLength { at, found, expected, hint: hint.map(str::to_owned) }
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
            let at = Box::new(Place::in_log(self.path, row.byte, row.line, Subject::Line, None));
            return Err(LogError::TooFewSamples { at, samples });
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
