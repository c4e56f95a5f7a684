//! The numbers of a column of a Parquet file.

use parquet::basic::{Compression, Type};
use parquet::column::reader::ColumnReader;
use parquet::errors::ParquetError;

use super::contained::contained;

/// Records read at a time.
const BATCH: usize = 8192;

/// Whether a column is packed by something that is unpacked here.
pub(super) fn is_unpacked(packed: Compression) -> Result<(), String> {
    match packed {
        Compression::UNCOMPRESSED | Compression::SNAPPY | Compression::GZIP(_) => Ok(()),
        Compression::LZ4 | Compression::LZ4_RAW => Ok(()),
        other => Err(format!(
            "its columns are packed by {other}, expected Snappy (as LeRobot writes), gzip, lz4 or nothing; pandas' \
             `to_parquet(..., compression=\"snappy\")` rewrites it"
        )),
    }
}

/// What the Parquet crate answers; whatever a damaged file makes it do is an error of that file.
pub(super) fn theirs<T>(work: impl FnOnce() -> Result<T, ParquetError>) -> Result<T, String> {
    match contained(work) {
        Some(answer) => answer.map_err(|error| format!("damaged: {error}")),
        None => Err("damaged: it cannot be decoded".to_owned()),
    }
}

/// All numbers of a column, at the most so many.
pub(super) fn numbers(reader: ColumnReader, most: usize) -> Result<Vec<f64>, String> {
    let mut all = Vec::new();
    macro_rules! read {
        ($reader:expr, $as:expr) => {{
            let mut reader = $reader;
            loop {
                let (mut values, mut definitions, mut repetitions) = (Vec::new(), Vec::new(), Vec::new());
                let (records, _, levels) =
                    theirs(|| reader.read_records(BATCH, Some(&mut definitions), Some(&mut repetitions), &mut values))?;
                if definitions.len() > values.len() || levels > values.len() {
                    return Err("empty cells, expected a number in each".to_owned());
                }
                all.extend(values.into_iter().map($as));
                if all.len() > most {
                    return Err(format!("more than {most} numbers"));
                }
                if records == 0 {
                    break;
                }
            }
        }};
    }
    match reader {
        ColumnReader::FloatColumnReader(reader) => read!(reader, f64::from),
        ColumnReader::DoubleColumnReader(reader) => read!(reader, |value: f64| value),
        ColumnReader::Int64ColumnReader(reader) => read!(reader, |value: i64| value as f64),
        ColumnReader::Int32ColumnReader(reader) => read!(reader, f64::from),
        _ => return Err(format!("a column of texts, expected numbers ({:?} or such)", Type::FLOAT)),
    }
    if all.iter().any(|value| !value.is_finite()) {
        return Err("a number that is not finite".to_owned());
    }
    Ok(all)
}
