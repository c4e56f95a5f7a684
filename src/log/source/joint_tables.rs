//! JointState messages as CSV, in the layouts that tools write: PlotJuggler's, `rostopic echo -p`, frames of pandas with
//! lists or numbered columns, one row for each joint, one column for each joint and field.
//!
//! Every row is a message, or one of several topics; they are gathered as those of a bag are.

use std::borrow::Cow;
use std::path::Path;

use csv::ByteRecord;

use super::cells::{list_cell, names_cell, nanoseconds};
use super::channel::Source;
use super::defects::Defects;
use super::joint_columns::{Columns, Content, Fields, Names, Stamp};
use super::joint_layout::Layout;
use super::message::{Message, Point};
use super::stamps::{NS, ns_per_unit, unit_word};
use super::topics::Topics;
use crate::log::error::{CellFault, LogError};
use crate::log::format::Format;
use crate::log::place::{Place, Subject};
use crate::log::plausible::{Row, median_step};
use crate::log::rows;

/// Reads a table of a layout.
///
/// # Errors
/// [`LogError`] with all defects of the file.
pub(super) fn read_joint_table(path: &Path, layout: Layout) -> Result<Source, LogError> {
    let mut reader =
        Reader { path, names: Vec::new(), topics: Topics::default(), defects: Defects::default(), units: Vec::new() };
    let units = units(path, &layout)?;
    reader.units = units;
    rows::for_each_row(path, |row, record| {
        if reader.names.is_empty() {
            reader.names = rows::text_cells(path, row, record)?.iter().map(|cell| cell.trim().to_owned()).collect();
        } else if let Err(error) = rows::check_row(path, row, record, &reader.names) {
            reader.defects.push(None, error);
        } else {
            layout.topics.iter().enumerate().for_each(|(k, topic)| reader.message(k, topic, row, record));
        }
        Ok(())
    })?;
    reader.defects.into_result(crate::log::columns::Columns::default())?;
    let mut source = reader.topics.into_source(path, Format::JointStateTable)?;
    for (topic, ns) in layout.topics.iter().zip(&reader.units) {
        if let Stamp::Unknown(cell) = topic.stamp {
            let unit = unit_word(*ns);
            source
                .notes
                .push(format!("{}: stamps are {unit}, by their steps", reader.names.get(cell).map_or("", |name| name)));
        }
    }
    Ok(source)
}

/// The unit of each topic's stamps \[ns\], by the steps of the first rows where the name does not say it.
fn units(path: &Path, layout: &Layout) -> Result<Vec<i64>, LogError> {
    const LOOKED_AT: usize = 200;
    let mut stamps: Vec<Vec<f64>> = vec![Vec::new(); layout.topics.len()];
    let mut seen = 0;
    rows::for_some_rows(path, LOOKED_AT, |_, record| {
        seen += 1;
        for (topic, stamps) in layout.topics.iter().zip(&mut stamps) {
            if let Stamp::Unknown(cell) = topic.stamp
                && seen > 1
                && let Some(value) =
                    record.get(cell).and_then(|cell| std::str::from_utf8(cell).ok()?.trim().parse::<f64>().ok())
                && stamps.last().is_none_or(|last| value > *last)
            {
                stamps.push(value);
            }
        }
        Ok(())
    })?;
    let unit = |stamps: &Vec<f64>| ns_per_unit(median_step(stamps));
    Ok(stamps.iter().map(unit).collect())
}

struct Reader<'a> {
    path: &'a Path,
    names: Vec<String>,
    topics: Topics,
    defects: Defects,
    units: Vec<i64>,
}

impl Reader<'_> {
    fn message(&mut self, k: usize, topic: &Columns, row: Row, record: &ByteRecord) {
        let cell = |at: usize| record.get(at).unwrap_or_default();
        let is_blank = |at: usize| {
            let cell = cell(at).trim_ascii();
            cell.is_empty() || cell.eq_ignore_ascii_case(b"nan")
        };
        let is_absent = match &topic.content {
            Content::Wide { cells, .. } => cells.iter().all(|cells| cells[0].is_none_or(is_blank)),
            Content::Lists { cells, .. } | Content::Long { cells, .. } => cells[0].is_none_or(is_blank),
        };
        if is_absent {
            return;
        }
        let stamp = match topic.stamp {
            Stamp::One(at, ns) => nanoseconds(cell(at), ns).ok_or(at),
            Stamp::Unknown(at) => nanoseconds(cell(at), self.units[k]).ok_or(at),
            Stamp::Two(sec, nano) => match (nanoseconds(cell(sec), NS), nanoseconds(cell(nano), 1)) {
                (Some(sec), Some(nano)) => Ok(sec.saturating_add(nano)),
                (None, _) => Err(sec),
                _ => Err(nano),
            },
        };
        let stamp_ns = match stamp {
            Ok(stamp_ns) => stamp_ns,
            Err(at) => return self.bad_cell(row, at, record, CellFault::Text { first_row: false, unit: "s" }),
        };
        let number = |at: Option<usize>| match at {
            Some(at) if !is_blank(at) => {
                let text = std::str::from_utf8(cell(at)).unwrap_or("").trim();
                text.parse::<f64>().ok().filter(|value| !value.is_infinite()).ok_or(at)
            }
            _ => Ok(f64::NAN),
        };
        let lists = |cells: &Fields| {
            let list = |at: &Option<usize>| at.map_or(Ok(Vec::new()), |at| list_cell(cell(at)).ok_or(at));
            Ok::<_, usize>([list(&cells[0])?, list(&cells[1])?, list(&cells[2])?])
        };
        let (names, fields) = match &topic.content {
            Content::Wide { names, cells } => {
                let column = |field: usize| match cells.iter().any(|cells| cells[field].is_some()) {
                    true => cells.iter().map(|cells| number(cells[field])).collect::<Result<Vec<f64>, usize>>(),
                    false => Ok(Vec::new()),
                };
                let fields = column(0).and_then(|position| Ok([position, column(1)?, column(2)?]));
                let names = match names {
                    Names::Known(names) => Cow::Borrowed(&names[..]),
                    Names::Cells(cells) => {
                        let title = |at: &usize| String::from_utf8_lossy(cell(*at)).trim().trim_matches('"').to_owned();
                        Cow::Owned(cells.iter().map(title).collect())
                    }
                };
                (names, fields)
            }
            Content::Lists { names, cells } => match names_cell(cell(*names)) {
                Some(titles) => (Cow::Owned(titles), lists(cells)),
                None => (Cow::Owned(Vec::new()), Err(*names)),
            },
            Content::Long { name, cells } => {
                let one =
                    |at: Option<usize>| if at.is_some() { number(at).map(|value| vec![value]) } else { Ok(Vec::new()) };
                let fields = one(cells[0]).and_then(|position| Ok([position, one(cells[1])?, one(cells[2])?]));
                (Cow::Owned(vec![String::from_utf8_lossy(cell(*name)).trim().to_owned()]), fields)
            }
        };
        let [position, velocity, effort] = match fields {
            Ok(fields) => fields,
            Err(at) => return self.bad_cell(row, at, record, CellFault::Text { first_row: false, unit: "rad" }),
        };
        let mut names: Vec<&str> = names.iter().map(String::as_str).collect();
        let mut point = Point { after_ns: 0, position, velocity, effort };
        if point.position.iter().any(|value| value.is_nan()) && names.len() == point.position.len() {
            // Several publishers share a topic: this is a message of those joints that are in it.
            let there: Vec<usize> = (0..names.len()).filter(|k| !point.position[*k].is_nan()).collect();
            let of = |values: &[f64]| there.iter().filter_map(|k| values.get(*k).copied()).collect::<Vec<f64>>();
            let (position, velocity, effort) = (of(&point.position), of(&point.velocity), of(&point.effort));
            names = there.iter().map(|k| names[*k]).collect();
            point = Point { after_ns: 0, position, velocity, effort };
        }
        let message = Message { stamp_ns: Some(stamp_ns), points: vec![point], ..Message::default() };
        if let Err(what) = self.topics.take(&topic.topic, topic.kind, &names, stamp_ns, message) {
            let error = LogError::Format { file: self.path.to_path_buf(), format: Format::JointStateTable, what };
            self.defects.push(None, error);
        }
    }

    fn bad_cell(&mut self, row: Row, cell: usize, record: &ByteRecord, fault: CellFault) {
        let content = record.get(cell).unwrap_or_default();
        let like = rows::cell_error(Box::new(Place::of_column(self.path, "")), content, fault);
        let name = self.names.get(cell).cloned().unwrap_or_default();
        let at = || Box::new(Place::in_log(self.path, row.byte, row.line, Subject::Column(name), Some(cell)));
        self.defects.add(&like, Some(cell), || rows::cell_error(at(), content, fault));
    }
}
