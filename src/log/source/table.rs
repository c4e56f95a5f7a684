//! Reads a CSV table: columns that we name, or that `[columns]` does.
//!
//! The file is streamed once; the only thing that grows is the columns that are kept and where each row starts. All
//! that is wrong with it is told in one run.

use std::path::Path;

use csv::ByteRecord;

use super::channel::{Channel, Rows, Source};
use super::defects::Defects;
use super::heading::Heading;
use super::want::Want;
use crate::log::column::Column;
use crate::log::columns::Columns;
use crate::log::error::{CellFault, LogError};
use crate::log::format::Format;
use crate::log::place::{Place, Subject};
use crate::log::plausible::{LONGEST_GAP_S, Row, median_step};
use crate::log::rows;

/// A table has a row for each message if in a column this many cells are empty, and this share of the rows.
const FEWEST_EMPTY: usize = 8;
const SHARE_EMPTY: f64 = 0.1;

/// Reads the columns that are wanted.
///
/// # Errors
/// [`LogError`] with all defects of the file.
pub(super) fn read_table(path: &Path, want: Want<'_>, columns: &Columns) -> Result<Source, LogError> {
    let mut table: Option<Table> = None;
    rows::for_each_row(path, |row, record| match &mut table {
        None => {
            let cells = rows::text_cells(path, row, record)?;
            let mut defects = Defects::default();
            let heading = Heading::find(path, &cells, row, want, columns, &mut defects)?;
            table = Some(Table::new(path, heading, row, defects));
            Ok(())
        }
        Some(table) => {
            table.push(row, record);
            Ok(())
        }
    })?;
    table.ok_or_else(|| LogError::Empty { file: path.to_path_buf() })?.finish()
}

struct Table<'a> {
    path: &'a Path,
    heading: Heading,
    header_row: Row,
    rows: Vec<Row>,
    /// As long as the heading's wanted cells; without the empty ones.
    values: Vec<Vec<f64>>,
    empty: Vec<Empty>,
    defects: Defects,
}

/// Empty cells of a column.
#[derive(Default)]
struct Empty {
    rows: Vec<u32>,
    /// What stands in the first: nothing, or not-a-number.
    first: String,
}

impl<'a> Table<'a> {
    fn new(path: &'a Path, heading: Heading, header_row: Row, defects: Defects) -> Self {
        let columns = heading.wanted.len();
        let empty = (0..columns).map(|_| Empty::default()).collect();
        Self { path, heading, header_row, rows: Vec::new(), values: vec![Vec::new(); columns], empty, defects }
    }

    fn place(&self, row: Row, cell: usize) -> Box<Place> {
        let name = self.heading.names.get(cell).cloned().unwrap_or_default();
        Box::new(Place::in_log(self.path, row.byte, row.line, Subject::Column(name), Some(cell)))
    }

    fn push(&mut self, row: Row, record: &ByteRecord) {
        if let Err(error) = rows::check_row(self.path, row, record, &self.heading.names) {
            self.defects.push(None, error);
            return;
        }
        let at = u32::try_from(self.rows.len()).unwrap_or(u32::MAX);
        for k in 0..self.heading.wanted.len() {
            let one = &self.heading.wanted[k];
            let Some(cell) = record.get(one.cell) else { continue };
            let (limit, unit) = one.limit_and_unit();
            let read = match one.column {
                Some(Column::Drive) => rows::switch(cell).map(|on| f64::from(u8::from(on))),
                _ => rows::number(cell, limit, unit, at == 0),
            };
            match read {
                Ok(value) => {
                    let value = one.spec.as_ref().map_or(value, |spec| spec.apply(value));
                    self.values[k].push(value);
                }
                Err(fault) if one.column != Some(Column::Time) && is_empty(cell, fault) => {
                    let empty = &mut self.empty[k];
                    if empty.rows.is_empty() {
                        empty.first = String::from_utf8_lossy(cell).trim().to_owned();
                    }
                    empty.rows.push(at);
                }
                Err(fault) => {
                    self.values[k].push(f64::NAN);
                    self.cell_defect(k, row, cell, fault);
                }
            }
        }
        self.rows.push(row);
    }

    fn cell_defect(&mut self, k: usize, row: Row, cell: &[u8], fault: CellFault) {
        let at = self.heading.wanted[k].cell;
        // The place is looked up for the first of a kind only.
        let nowhere = Box::new(Place::of_column(self.path, ""));
        let like = rows::cell_error(nowhere, cell, fault);
        let mut defects = std::mem::take(&mut self.defects);
        defects.add(&like, Some(at), || rows::cell_error(self.place(row, at), cell, fault));
        self.defects = defects;
    }

    fn finish(mut self) -> Result<Source, LogError> {
        let samples = self.rows.len();
        if samples < 2 && self.defects.is_empty() {
            let row = self.rows.last().copied().unwrap_or(self.header_row);
            return Err(rows::too_few(self.path, row, samples));
        }
        // What a long log has reserved beyond its samples.
        self.rows.shrink_to_fit();
        self.values.iter_mut().for_each(Vec::shrink_to_fit);
        let is_staggered = self.is_staggered();
        if !is_staggered {
            self.empty_defects(|_| true);
            self.fill_empty();
        } else {
            // An angle that is nowhere is none, whatever else comes in messages of its own.
            self.empty_defects(|values| values.is_empty());
        }
        let mut time = std::mem::take(&mut self.values[0]);
        let mut source =
            Source::new(self.path.to_path_buf(), if is_staggered { Format::StaggeredCsv } else { Format::Csv });
        let wanted = &self.heading.wanted;
        let mut rows = Rows {
            all: std::mem::take(&mut self.rows),
            of_clock: Vec::new(),
            time: (wanted[0].cell, self.heading.names[wanted[0].cell].clone()),
        };
        let mut patterns: Vec<Vec<u32>> = Vec::new();
        let mut empty_columns = Vec::new();
        for (k, one) in wanted.iter().enumerate().skip(1) {
            let values = std::mem::take(&mut self.values[k]);
            let missing = std::mem::take(&mut self.empty[k].rows);
            if values.is_empty() {
                empty_columns.push(self.heading.names[one.cell].clone());
                continue;
            }
            let missing = if is_staggered { missing } else { Vec::new() };
            if one.spec.as_ref().is_some_and(|spec| spec.unit.is_some()) {
                source.stated.insert(one.ours.clone());
            }
            let clock = patterns.iter().position(|known| *known == missing).unwrap_or_else(|| {
                // Where every row has every column there is one clock.
                let own_s = if is_staggered { without(&time, &missing) } else { std::mem::take(&mut time) };
                source.clocks.push(own_s);
                let of = (!missing.is_empty()).then(|| without(&(0..time.len() as u32).collect::<Vec<_>>(), &missing));
                rows.of_clock.push(of);
                patterns.push(missing);
                patterns.len() - 1
            });
            let theirs = self.heading.names[one.cell].clone();
            source.channels.push(Channel {
                ours: Some(one.ours.clone()),
                theirs,
                clock,
                values,
                cell: Some(one.cell),
                spec: None,
            });
        }
        source.ignored = self.heading.ignored();
        source.ignored.extend(empty_columns);
        source.rows = Some(rows);
        let mut defects = std::mem::take(&mut self.defects);
        time_defects(&source, is_staggered, &mut defects);
        let units = source.unit_defects(Want::Any, &mut defects);
        let mend = if defects.is_empty() { Columns::default() } else { self.heading.mend(&units) };
        defects.into_result(mend).map(|()| source)
    }

    /// Puts not-a-number where cells are empty, so that rows and samples count alike in what is still checked.
    fn fill_empty(&mut self) {
        for (values, empty) in self.values.iter_mut().zip(&mut self.empty) {
            let rows = std::mem::take(&mut empty.rows);
            if !rows.is_empty() && !values.is_empty() {
                let mut there = std::mem::take(values).into_iter();
                let mut next = rows.iter().peekable();
                let all = (0..self.rows.len()).map(|row| match next.next_if(|missing| **missing as usize == row) {
                    Some(_) => f64::NAN,
                    None => there.next().unwrap_or(f64::NAN),
                });
                *values = all.collect();
            }
        }
    }

    fn is_staggered(&self) -> bool {
        self.empty.iter().any(|empty| are_of_messages(empty.rows.len(), self.rows.len()))
    }

    /// Tells empty cells of the columns that have to be whole, by the values that they have.
    fn empty_defects(&mut self, has_to_be: impl Fn(&[f64]) -> bool) {
        for (k, empty) in self.empty.iter().enumerate() {
            let is_angle = self.heading.wanted[k].column == Some(Column::Angle);
            // What is nowhere is not there.
            if !has_to_be(&self.values[k]) || self.values[k].is_empty() && !is_angle {
                continue;
            }
            let cell = self.heading.wanted[k].cell;
            let fault = if empty.first.is_empty() { CellFault::Empty } else { CellFault::NotFinite };
            for row in &empty.rows {
                let like =
                    LogError::Cell { at: Box::new(Place::of_column(self.path, "")), found: String::new(), fault };
                let row = self.rows[*row as usize];
                let name = self.heading.names[cell].clone();
                let place =
                    || Box::new(Place::in_log(self.path, row.byte, row.line, Subject::Column(name), Some(cell)));
                self.defects.add(&like, Some(cell), || rows::cell_error(place(), empty.first.as_bytes(), fault));
            }
        }
    }
}

/// Whether so many empty cells of a column say that its values come in messages of their own.
pub(in crate::log) fn are_of_messages(empty: usize, rows: usize) -> bool {
    (FEWEST_EMPTY..rows).contains(&empty) && empty as f64 >= SHARE_EMPTY * rows as f64
}

/// A cell with nothing in it, or with what tables have in the place of nothing.
fn is_empty(cell: &[u8], fault: CellFault) -> bool {
    match fault {
        CellFault::Empty => true,
        CellFault::NotFinite => cell.trim_ascii().eq_ignore_ascii_case(b"nan"),
        _ => false,
    }
}

/// Values of the rows that are not among these.
fn without<T: Copy>(values: &[T], rows: &[u32]) -> Vec<T> {
    let mut next = rows.iter().peekable();
    let stays = |(row, _): &(usize, &T)| match next.peek() {
        Some(missing) if **missing as usize == *row => {
            next.next();
            false
        }
        _ => true,
    };
    values.iter().enumerate().filter(stays).map(|(_, value)| *value).collect()
}

/// Stamps that do not rise, and, of plain tables, recordings that were appended to one another.
fn time_defects(source: &Source, is_staggered: bool, defects: &mut Defects) {
    for (clock, t_s) in source.clocks.iter().enumerate() {
        let Some(channel) = source.channels.iter().find(|channel| channel.clock == clock) else { continue };
        let in_seconds = median_step(t_s) < 0.5;
        for (k, pair) in t_s.windows(2).enumerate() {
            let (previous_s, time_s) = (pair[0], pair[1]);
            let previous_line = || source.place(channel, k, true).line;
            if time_s.is_nan() || previous_s.is_nan() {
                continue;
            }
            if time_s <= previous_s {
                let nowhere = Box::new(Place::of_column(&source.file, ""));
                let like = LogError::TimeOrder { at: nowhere, previous_line: 0, time_s, previous_s };
                let kind = if time_s == previous_s { 0 } else { 1 };
                defects.add(&like, Some(kind), || LogError::TimeOrder {
                    at: source.place(channel, k + 1, true),
                    previous_line: previous_line(),
                    time_s,
                    previous_s,
                });
            } else if !is_staggered && in_seconds && time_s - previous_s > LONGEST_GAP_S {
                let nowhere = Box::new(Place::of_column(&source.file, ""));
                let gap_s = time_s - previous_s;
                let like = LogError::TimeGap { at: nowhere, previous_line: 0, gap_s };
                defects.add(&like, None, || LogError::TimeGap {
                    at: source.place(channel, k + 1, true),
                    previous_line: previous_line(),
                    gap_s,
                });
            }
        }
    }
}

#[cfg(test)]
#[path = "table_tests.rs"]
mod tests;
