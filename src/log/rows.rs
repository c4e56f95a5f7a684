//! The rows of a log's CSV file, and what can be wrong with a row or a cell: what all readers of logs share.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use csv::ByteRecord;

use super::error::{CellFault, FileKind, LogError};
use super::place::{Place, Subject};
use super::plausible::Row;

/// With what a pointer of Git LFS begins.
const LFS_POINTER: &[u8] = b"version https://git-lfs.github.com/spec/";

/// Hands every row that is not blank to `take`, the header first.
pub(super) fn for_each_row(
    path: &Path,
    take: impl FnMut(Row, &ByteRecord) -> Result<(), LogError>,
) -> Result<(), LogError> {
    for_some_rows(path, usize::MAX, take)
}

/// As [`for_each_row`], of the first `most` rows.
pub(super) fn for_some_rows(
    path: &Path,
    most: usize,
    mut take: impl FnMut(Row, &ByteRecord) -> Result<(), LogError>,
) -> Result<(), LogError> {
    let mut taken = 0;
    let failed = |source| LogError::Read { file: path.to_path_buf(), source };
    let mut input = BufReader::with_capacity(1 << 16, File::open(path).map_err(failed)?);
    if let Some(found) = not_text(input.fill_buf().map_err(failed)?) {
        return Err(LogError::NotText { file: path.to_path_buf(), found });
    }
    let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(input);
    let mut record = ByteRecord::new();
    while taken < most && reader.read_byte_record(&mut record).map_err(|error| failed(error.into()))? {
        if record.iter().all(<[u8]>::is_empty) && record.len() < 2 || record.len() == 1 && is_blank(&record[0]) {
            continue;
        }
        let row = Row {
            byte: record.position().map_or(0, csv::Position::byte),
            line: record.position().map_or(1, csv::Position::line),
        };
        take(row, &record)?;
        taken += 1;
    }
    Ok(())
}

/// Recognises files that are no UTF-8 text by their first bytes.
pub(super) fn not_text(start: &[u8]) -> Option<FileKind> {
    match start {
        [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] => Some(FileKind::Utf16),
        [b'P', b'K', 3, 4, ..] => Some(FileKind::Zip),
        [0x1F, 0x8B, ..] => Some(FileKind::Gzip),
        [0x89, b'H', b'D', b'F', ..] => Some(FileKind::Hdf5),
        start if start.starts_with(b"MATLAB 7.3 MAT-file") => Some(FileKind::Hdf5),
        start if start.starts_with(b"MATLAB 5.0 MAT-file") => Some(FileKind::Matlab),
        start if start.starts_with(LFS_POINTER) => Some(FileKind::LfsPointer),
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

/// The cells of the header.
pub(super) fn text_cells<'a>(path: &Path, row: Row, record: &'a ByteRecord) -> Result<Vec<&'a str>, LogError> {
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

/// A row has to be text, with as many cells as the header.
pub(super) fn check_row(path: &Path, row: Row, record: &ByteRecord, names: &[String]) -> Result<(), LogError> {
    if std::str::from_utf8(record.as_slice()).is_err() {
        for (i, cell) in record.iter().enumerate() {
            text_of(path, row, names.get(i).map(String::as_str), i, cell)?;
        }
    }
    if record.len() == names.len() { Ok(()) } else { Err(row_length(path, row, record, names.len())) }
}

fn row_length(path: &Path, row: Row, record: &ByteRecord, expected: usize) -> LogError {
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
    let at = Box::new(Place::in_log(path, row.byte, row.line, Subject::Line, cell));
    LogError::RowLength { at, found, expected, hint: hint.map(str::to_owned) }
}

/// A finite number of at most `limit` in magnitude; `is_first` in the first row after the header.
pub(super) fn number(cell: &[u8], limit: f64, unit: &'static str, is_first: bool) -> Result<f64, CellFault> {
    let text = std::str::from_utf8(cell).unwrap_or("").trim();
    Err(match text.parse::<f64>() {
        Ok(value) if !value.is_finite() => CellFault::NotFinite,
        Ok(value) if value.abs() > limit => CellFault::Absurd { limit, unit },
        Ok(value) => return Ok(value),
        Err(_) if text.is_empty() => CellFault::Empty,
        Err(_) if text.replacen(',', ".", 1).parse::<f64>().is_ok() => CellFault::DecimalComma,
        Err(_) if text.replacen(['\u{2212}', '\u{2013}'], "-", 1).parse::<f64>().is_ok() => CellFault::Minus,
        Err(_) => CellFault::Text { first_row: is_first, unit },
    })
}

/// A cell of column `drive`.
pub(super) fn switch(cell: &[u8]) -> Result<bool, CellFault> {
    match cell {
        b"1" => Ok(true),
        b"0" => Ok(false),
        other => match String::from_utf8_lossy(other).trim().parse::<f64>() {
            Ok(1.0) => Ok(true),
            Ok(0.0) => Ok(false),
            _ => Err(CellFault::Drive),
        },
    }
}

/// The error about a cell.
pub(super) fn cell_error(at: Box<Place>, cell: &[u8], fault: CellFault) -> LogError {
    let found: String = String::from_utf8_lossy(cell).trim().chars().take(40).collect();
    let fault = if found.is_empty() { CellFault::Empty } else { fault };
    LogError::Cell { at, found, fault }
}

/// The error about a log with fewer than two samples; `row` is its last.
pub(super) fn too_few(path: &Path, row: Row, samples: usize) -> LogError {
    let at = Box::new(Place::in_log(path, row.byte, row.line, Subject::Line, None));
    LogError::TooFewSamples { at, samples }
}
