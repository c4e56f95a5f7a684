//! Folders of SAGE: `control.csv` (what was asked), `state_motor.csv` (what was read), `joint_list.txt`.

use std::fs;
use std::path::{Path, PathBuf};

use csv::ByteRecord;

use super::cells::list_cell;
use super::channel::{Channel, Source};
use super::defects::Defects;
use crate::log::error::{CellFault, LogError};
use crate::log::format::Format;
use crate::log::place::{Place, Subject};
use crate::log::plausible::{Row, median_step};
use crate::log::rows;

const ASKED: &str = "control.csv";
const READ: &str = "state_motor.csv";
const NAMES: &str = "joint_list.txt";

/// Whether a folder is one of SAGE.
pub(super) fn is_sage(folder: &Path) -> bool {
    folder.join(READ).is_file() && (folder.join(NAMES).is_file() || folder.join(ASKED).is_file())
}

/// The folder of SAGE that a file belongs to.
pub(super) fn folder_of(file: &Path) -> Option<PathBuf> {
    let name = file.file_name()?.to_str()?;
    let folder = file.parent()?;
    ([ASKED, READ, NAMES].contains(&name) && is_sage(folder)).then(|| folder.to_path_buf())
}

/// Files of a folder that are read.
pub(super) fn files(folder: &Path) -> Vec<PathBuf> {
    [READ, ASKED, NAMES].iter().map(|name| folder.join(name)).filter(|path| path.is_file()).collect()
}

/// Reads a folder.
///
/// # Errors
/// [`LogError`] with all defects of the file that has some.
pub(super) fn read_sage(folder: &Path) -> Result<Source, LogError> {
    let mut source = Source::new(folder.to_path_buf(), Format::Sage);
    let (read, asked) = (folder.join(READ), folder.join(ASKED));
    let (state, control) = rayon::join(
        || Lists::read(&read, &["positions", "velocities", "torques"]),
        || asked.is_file().then(|| Lists::read(&asked, &["positions"])).transpose(),
    );
    let (state, control) = (state?, control?);
    let width = state.columns[0].len();
    let names = names(folder, width)?;
    if let Some(control) = control.as_ref().filter(|control| control.columns[0].len() != width) {
        let what = format!("{} numbers in each list, but {} in {READ}", control.columns[0].len(), width);
        return Err(LogError::Format { file: asked, format: Format::Sage, what });
    }
    let (per_s, unit) = match median_step(&state.stamps) {
        step if step > 100.0 => (1e6, "microseconds"),
        step if step > 0.5 => (1e3, "milliseconds"),
        _ => (1.0, "seconds"),
    };
    source.notes.push(format!("stamps are {unit}, by their steps"));
    let in_s = |stamps: Vec<f64>| stamps.into_iter().map(|stamp| stamp / per_s).collect::<Vec<f64>>();
    let is_shared = control.as_ref().is_none_or(|control| control.stamps == state.stamps);
    source.clocks.push(in_s(state.stamps));
    let mut fields = state.columns.into_iter();
    for (column, field) in [("q", "positions"), ("dq", "velocities"), ("tau", "torques")] {
        let values = fields.next().unwrap_or_default();
        // A magnitude of the current: nothing can be driven by it, and no sign is to be had from it.
        let is_unsigned = column == "tau" && values.iter().flatten().all(|value| *value >= 0.0);
        if is_unsigned && !values.is_empty() {
            source.notes.push("torques have no sign (magnitudes of a current): left out".to_owned());
        }
        add(&mut source, &names, column, field, values, 0, !is_unsigned);
    }
    if let Some(control) = control {
        let clock = if is_shared {
            0
        } else {
            source.clocks.push(in_s(control.stamps));
            1
        };
        let values = control.columns.into_iter().next().unwrap_or_default();
        add(&mut source, &names, "q_ref", "control", values, clock, true);
    }
    for name in &names {
        let of = |column: &str| source.ours(&format!("{name}.{column}")).map(|channel| &channel.values);
        let is_fraction = |values: &Vec<f64>| values.iter().all(|value| (-0.02..=1.02).contains(value));
        let lower = name.to_lowercase();
        if ["jaw", "gripper", "finger"].iter().any(|word| lower.contains(word)) && of("q").is_some_and(is_fraction) {
            source.notes.push(format!(
                "{name}: from 0 to 1, as a fraction of a range is; read as an angle [rad] unless [columns] says more"
            ));
        }
    }
    Ok(source)
}

fn add(
    source: &mut Source,
    names: &[String],
    ours: &str,
    theirs: &str,
    values: Vec<Vec<f64>>,
    clock: usize,
    is_used: bool,
) {
    for (name, values) in names.iter().zip(values) {
        let ours = is_used.then(|| format!("{name}.{ours}"));
        let theirs = format!("{name}.{theirs}");
        source.channels.push(Channel { ours, theirs, clock, values, cell: None, spec: None });
    }
}

/// Names of the joints, one a line; without the file their numbers.
fn names(folder: &Path, width: usize) -> Result<Vec<String>, LogError> {
    let path = folder.join(NAMES);
    if !path.is_file() {
        return Ok((1..=width).map(|k| format!("joint{k}")).collect());
    }
    let text = fs::read_to_string(&path).map_err(|source| LogError::Read { file: path.clone(), source })?;
    let names: Vec<String> = text.lines().map(str::trim).filter(|line| !line.is_empty()).map(str::to_owned).collect();
    let doubled = names.iter().enumerate().find(|(k, name)| names[..*k].contains(name));
    let what = match doubled {
        Some((_, name)) => format!("joint `{name}` stands twice"),
        None if names.len() != width => format!("{} joints, but {width} numbers in each list of {READ}", names.len()),
        None => return Ok(names),
    };
    Err(LogError::Format { file: path, format: Format::Sage, what })
}

/// A table whose cells are lists.
struct Lists {
    stamps: Vec<f64>,
    /// Of each field, of each joint; empty where the table has no such field.
    columns: Vec<Vec<Vec<f64>>>,
}

impl Lists {
    fn read(path: &Path, fields: &[&str]) -> Result<Self, LogError> {
        let mut reader: Option<ListReader> = None;
        rows::for_each_row(path, |row, record| match &mut reader {
            None => {
                let cells = rows::text_cells(path, row, record)?;
                reader = Some(ListReader::new(path, &cells, row, fields)?);
                Ok(())
            }
            Some(reader) => {
                reader.push(row, record);
                Ok(())
            }
        })?;
        reader.ok_or_else(|| LogError::Empty { file: path.to_path_buf() })?.finish()
    }
}

struct ListReader<'a> {
    path: &'a Path,
    names: Vec<String>,
    stamp: usize,
    cells: Vec<Option<usize>>,
    lists: Lists,
    last: Row,
    defects: Defects,
}

impl<'a> ListReader<'a> {
    fn new(path: &'a Path, cells: &[&str], row: Row, fields: &[&str]) -> Result<Self, LogError> {
        let names: Vec<String> = cells.iter().map(|cell| cell.trim().to_owned()).collect();
        let find = |name: &str| names.iter().position(|other| other == name);
        let missing = |column: &str| {
            let at = Box::new(Place::in_log(path, row.byte, row.line, Subject::Line, None));
            LogError::MissingColumn { at, column: column.to_owned(), found: names.clone(), hint: None }
        };
        let stamp = find("timestamp").ok_or_else(|| missing("timestamp"))?;
        let cells: Vec<Option<usize>> = fields.iter().map(|field| find(field)).collect();
        if cells.first().is_none_or(Option::is_none) {
            return Err(missing(fields.first().copied().unwrap_or("positions")));
        }
        let columns = vec![Vec::new(); cells.len()];
        let lists = Lists { stamps: Vec::new(), columns };
        Ok(Self { path, names, stamp, cells, lists, last: row, defects: Defects::default() })
    }

    fn place(&self, row: Row, cell: usize) -> Box<Place> {
        let name = self.names.get(cell).cloned().unwrap_or_default();
        Box::new(Place::in_log(self.path, row.byte, row.line, Subject::Column(name), Some(cell)))
    }

    fn push(&mut self, row: Row, record: &ByteRecord) {
        if let Err(error) = rows::check_row(self.path, row, record, &self.names) {
            return self.defects.push(None, error);
        }
        let is_first = self.lists.stamps.is_empty();
        let stamp = match rows::number(&record[self.stamp], 1e20, "us", is_first) {
            Ok(stamp) => stamp,
            Err(fault) => return self.bad_cell(row, self.stamp, record, fault),
        };
        if let Some(previous_s) = self.lists.stamps.last().copied().filter(|previous| stamp <= *previous) {
            let (at, line) = (self.place(row, self.stamp), self.place(self.last, self.stamp).line);
            return self
                .defects
                .push(Some(self.stamp), LogError::TimeOrder { at, previous_line: line, time_s: stamp, previous_s });
        }
        let mut lists = Vec::with_capacity(self.cells.len());
        for (k, cell) in self.cells.iter().enumerate() {
            let Some(cell) = *cell else {
                lists.push(Vec::new());
                continue;
            };
            let width = self.lists.columns[k].len();
            match list_cell(&record[cell]).filter(|list| is_first || list.len() == width) {
                Some(list) => lists.push(list),
                None => {
                    return self.bad_cell(
                        row,
                        cell,
                        record,
                        CellFault::List { expected: if is_first { None } else { Some(width) } },
                    );
                }
            }
        }
        for (columns, list) in self.lists.columns.iter_mut().zip(lists) {
            columns.resize(list.len(), Vec::new());
            columns.iter_mut().zip(list).for_each(|(column, value)| column.push(value));
        }
        self.lists.stamps.push(stamp);
        self.last = row;
    }

    fn bad_cell(&mut self, row: Row, cell: usize, record: &ByteRecord, fault: CellFault) {
        let like = rows::cell_error(Box::new(Place::of_column(self.path, "")), &record[cell], fault);
        let mut defects = std::mem::take(&mut self.defects);
        defects.add(&like, Some(cell), || rows::cell_error(self.place(row, cell), &record[cell], fault));
        self.defects = defects;
    }

    fn finish(self) -> Result<Lists, LogError> {
        let samples = self.lists.stamps.len();
        if samples < 2 && self.defects.is_empty() {
            return Err(rows::too_few(self.path, self.last, samples));
        }
        self.defects.into_result(crate::log::columns::Columns::default()).map(|()| self.lists)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(control: &str, state: &str, names: &str) -> tempfile::TempDir {
        let dir = tempfile::tempdir().unwrap();
        for (name, text) in [(ASKED, control), (READ, state), (NAMES, names)] {
            fs::write(dir.path().join(name), text).unwrap();
        }
        dir
    }

    const STATE: &str = "type,timestamp,positions,velocities,torques\nS,0,\"[0.1, 2]\",\"[0, 0]\",\"[1, 1]\"\n\
                         S,20000.5,\"[0.2, 3]\",\"[0, 0]\",\"[1, 0]\"\n";

    #[test]
    fn what_was_asked_and_read_becomes_channels_in_seconds() {
        let dir = folder("type,timestamp,positions\nC,5,\"[0, 0.5]\"\nC,20005,\"[1, 1]\"\n", STATE, "Elbow\nJaw\n");
        let source = read_sage(dir.path()).unwrap();
        assert_eq!(source.clocks, [[0.0, 0.0200005].to_vec(), [5e-6, 0.020005].to_vec()]);
        assert_eq!(source.ours("Jaw.q_ref").unwrap().values, [0.5, 1.0]);
        assert!(source.ours("Elbow.tau").is_none() && source.notes.iter().any(|note| note.contains("no sign")));
    }

    #[test]
    fn each_fault_is_told_with_file_and_line() {
        let good = "type,timestamp,positions\nC,0,\"[0, 0.5]\"\nC,20000,\"[1, 1]\"\n";
        for (control, state, names, part) in [
            (good, STATE, "Elbow\n", "joint_list.txt: a SAGE recording: 1 joints, but 2 numbers"),
            (
                good,
                "type,timestamp,positions\nS,0,\"[0.1, 2]\"\nS,1,\"[0.1\"\n",
                "a\nb\n",
                "state_motor.csv: line 3, column `positions`",
            ),
            (good, "type,timestamp\nS,0\n", "a\nb\n", "column `positions` is missing"),
            (
                "type,timestamp,positions\nC,0,[1]\nC,9,[1]\n",
                STATE,
                "a\nb\n",
                "control.csv: a SAGE recording: 1 numbers",
            ),
            (good, "type,timestamp,positions\nS,9,\"[0.1, 2]\"\nS,1,\"[0.1, 2]\"\n", "a\nb\n", "time runs back"),
        ] {
            let dir = folder(control, state, names);
            let message = read_sage(dir.path()).unwrap_err().to_string();
            assert!(message.contains(part), "`{part}` is not in\n{message}");
        }
    }
}
