//! The fleet's table as Parquet, for pandas, DuckDB, Spark.

use super::rows::FleetRow;
use crate::report::ReportError;
use ::parquet::basic::Compression;
use ::parquet::column::writer::ColumnWriter;
use ::parquet::data_type::ByteArray;
use ::parquet::errors::ParquetError;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::parser::parse_message_type;
use std::sync::Arc;

/// The cells of a column.
enum Cells {
    Texts(Vec<Option<String>>),
    Days(Vec<Option<i32>>),
    Numbers(Vec<Option<f64>>),
}

impl Cells {
    /// As the schema's language has it.
    fn kind(&self) -> [&'static str; 2] {
        match self {
            Self::Texts(_) => ["binary", " (STRING)"],
            Self::Days(_) => ["int32", " (DATE)"],
            Self::Numbers(_) => ["double", ""],
        }
    }
}

fn columns(rows: &[FleetRow]) -> Vec<(&'static str, Cells)> {
    let texts = |of: &dyn Fn(&FleetRow) -> Option<String>| Cells::Texts(rows.iter().map(of).collect());
    let numbers = |of: &dyn Fn(&FleetRow) -> Option<f64>| Cells::Numbers(rows.iter().map(of).collect());
    let size = |of: fn(&super::FleetSize) -> Option<f64>| numbers(&|row| row.size.as_ref().and_then(of));
    vec![
        ("study", texts(&|row| Some(row.study.clone()))),
        ("robot", texts(&|row| row.robot.clone())),
        ("joint", texts(&|row| row.joint.clone())),
        ("log", texts(&|row| row.log.clone())),
        ("day", Cells::Days(rows.iter().map(|row| Some(row.day?.number())).collect())),
        ("day_from", texts(&|row| Some(row.day_from?.word().to_owned()))),
        ("since", Cells::Days(rows.iter().map(|row| Some(row.since?.number())).collect())),
        ("unit", texts(&|row| row.unit.clone())),
        ("gap_before", numbers(&|row| row.gap_before)),
        ("gap_after", numbers(&|row| row.gap_after)),
        ("verdict", texts(&|row| row.verdict.clone())),
        ("cause", texts(&|row| row.cause.clone())),
        ("parameter", texts(&|row| Some(row.size.as_ref()?.parameter.clone()))),
        ("size", size(|size| Some(size.value))),
        ("size_low", size(|size| Some(size.interval?[0]))),
        ("size_high", size(|size| Some(size.interval?[1]))),
        ("size_unit", texts(&|row| Some(row.size.as_ref()?.unit.clone()))),
        ("probability", numbers(&|row| row.probability)),
        ("sentence", texts(&|row| row.sentence.clone())),
        ("error", texts(&|row| row.error.clone())),
    ]
}

/// Writes the rows as a Parquet file, packed by Snappy; every cell may be null, days are dates.
///
/// # Errors
/// [`ReportError::Parquet`], which does not depend on the data.
pub fn fleet_parquet(rows: &[FleetRow]) -> Result<Vec<u8>, ReportError> {
    written(rows).map_err(|error| ReportError::Parquet(error.to_string()))
}

fn written(rows: &[FleetRow]) -> Result<Vec<u8>, ParquetError> {
    let columns = columns(rows);
    let field = |(name, cells): &(&str, Cells)| {
        let [kind, logical] = cells.kind();
        format!("optional {kind} {name}{logical};")
    };
    let schema = format!("message fleet {{ {} }}", columns.iter().map(field).collect::<Vec<_>>().join(" "));
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let mut bytes = Vec::new();
    let mut file = SerializedFileWriter::new(&mut bytes, Arc::new(parse_message_type(&schema)?), Arc::new(properties))?;
    let mut group = file.next_row_group()?;
    for (name, cells) in columns {
        let mut column =
            group.next_column()?.ok_or_else(|| ParquetError::General(format!("no column for `{name}`")))?;
        match (cells, column.untyped()) {
            (Cells::Texts(cells), ColumnWriter::ByteArrayColumnWriter(writer)) => {
                let (values, there) = parted(cells, |text| ByteArray::from(text.into_bytes()));
                writer.write_batch(&values, Some(&there), None)?;
            }
            (Cells::Days(cells), ColumnWriter::Int32ColumnWriter(writer)) => {
                let (values, there) = parted(cells, |day| day);
                writer.write_batch(&values, Some(&there), None)?;
            }
            (Cells::Numbers(cells), ColumnWriter::DoubleColumnWriter(writer)) => {
                let (values, there) = parted(cells, |number| number);
                writer.write_batch(&values, Some(&there), None)?;
            }
            _ => return Err(ParquetError::General(format!("`{name}` is of another kind"))),
        }
        column.close()?;
    }
    group.close()?;
    file.close()?;
    Ok(bytes)
}

/// The values that are there, and which those are.
fn parted<A, B>(cells: Vec<Option<A>>, value: impl Fn(A) -> B) -> (Vec<B>, Vec<i16>) {
    let there = cells.iter().map(|cell| i16::from(cell.is_some())).collect();
    (cells.into_iter().flatten().map(value).collect(), there)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Day;
    use crate::report::FleetSize;
    use ::parquet::file::reader::{FileReader, SerializedFileReader};

    #[test]
    fn the_table_is_read_back_with_its_nulls_and_dates() {
        let size = FleetSize { parameter: "T".into(), value: 0.016, interval: None, unit: "s".into() };
        let found = FleetRow {
            study: "a/study.toml".into(),
            day: Day::parse("2026-03-01"),
            gap_before: Some(0.25),
            size: Some(size),
            ..FleetRow::default()
        };
        let failed = FleetRow { study: "b".into(), error: Some("line 1".into()), ..FleetRow::default() };
        let bytes = fleet_parquet(&[found.clone(), failed.clone()]).unwrap();
        assert_eq!(bytes, fleet_parquet(&[found, failed]).unwrap());
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("fleet.parquet");
        std::fs::write(&path, bytes).unwrap();
        let reader = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        let rows: Vec<String> = reader.get_row_iter(None).unwrap().map(|row| row.unwrap().to_string()).collect();
        assert_eq!(rows.len(), 2);
        for said in ["study: \"a/study.toml\"", "day: 2026-03-01", "gap_before: 0.25", "size_low: null", "error: null"]
        {
            assert!(rows[0].contains(said), "{said}: {}", rows[0]);
        }
        assert!(rows[1].contains("error: \"line 1\"") && rows[1].contains("day: null"), "{}", rows[1]);
    }
}
