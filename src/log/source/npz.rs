//! NumPy arrays in a zip file (`.npz`): one array of stamps, arrays of one column, or of one for each joint; or one array
//! (`.npy`) with named fields, or with columns that `[columns]` names.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;

use super::channel::{Channel, Source};
use super::guess::guess;
#[cfg(feature = "robots")]
use super::npy::said_of;
use super::npy::{Array, READ, read_array};
use super::stamps::{NS, ns_per_unit, unit_word};
#[cfg(feature = "robots")]
use super::zip::Archive;
use crate::log::column::Column;
use crate::log::columns::{ColumnSpec, Columns, Unit};
use crate::log::error::LogError;
use crate::log::format::Format;
use crate::log::place::Place;
use crate::log::plausible::median_step;

/// Numbers of one file at the most: half a gigabyte.
const MOST_NUMBERS: u64 = 1 << 26;

/// Arrays that an error lists at the most.
const MOST_TOLD: usize = 12;

/// Whether a zip file holds arrays; nobody looks into it here.
#[cfg(not(feature = "robots"))]
pub(super) fn holds_arrays(_: &Path) -> bool {
    false
}

/// Refuses arrays in a zip file.
#[cfg(not(feature = "robots"))]
fn arrays(_: File, _: &Columns) -> Result<(Vec<Array>, Vec<String>), String> {
    Err("this build unpacks no arrays; build with the feature `robots`".to_owned())
}

/// Whether a zip file holds arrays.
#[cfg(feature = "robots")]
pub(super) fn holds_arrays(path: &Path) -> bool {
    let entries = File::open(path).ok().and_then(|file| Archive::open(file).ok());
    entries.is_some_and(|archive| archive.entries.iter().any(|entry| entry.name.ends_with(".npy")))
}

/// Reads the arrays of a file.
///
/// # Errors
/// [`LogError::Format`] where it is damaged, or no array is one of stamps.
pub(super) fn read_npz(path: &Path, columns: &Columns) -> Result<Source, LogError> {
    let wrong = |what: String| LogError::Format { file: path.to_path_buf(), format: Format::Npz, what };
    let file = File::open(path).map_err(|source| LogError::Read { file: path.to_path_buf(), source })?;
    arrays(file, columns).and_then(|(arrays, others)| source(path, arrays, others, columns)).map_err(wrong)
}

/// Reads one array: its fields, or its columns, which are called `[:, 0]`, `[:, 1]` ...
///
/// # Errors
/// [`LogError::Format`] where it is damaged; [`LogError::Defects`] with what its columns look like, where nobody says it.
pub(super) fn read_npy(path: &Path, columns: &Columns) -> Result<Source, LogError> {
    let wrong = |what: String| LogError::Format { file: path.to_path_buf(), format: Format::Npz, what };
    let file = File::open(path).map_err(|source| LogError::Read { file: path.to_path_buf(), source })?;
    let size = file.metadata().map_or(u64::MAX, |meta| meta.len());
    let mut arrays = read_array(file, "", size, &mut MOST_NUMBERS.clone()).map_err(wrong)?;
    let is_plain = matches!(&arrays[..], [array] if array.name.is_empty() && array.left_out.is_none());
    if is_plain && let Some(array) = arrays.pop() {
        let one = |(k, values)| Array {
            name: column_name(k),
            descr: array.descr.clone(),
            left_out: None,
            rows: array.rows,
            values: vec![values],
            texts: Vec::new(),
        };
        arrays = array.values.into_iter().enumerate().map(one).collect();
        if columns.get(Column::Time.name()).is_none() {
            return Err(unnamed(path, &arrays));
        }
    }
    source(path, arrays, Vec::new(), columns).map_err(wrong)
}

fn column_name(k: usize) -> String {
    format!("[:, {k}]")
}

/// What to say of columns without names: a guess where one of them rises as stamps do.
fn unnamed(path: &Path, columns: &[Array]) -> LogError {
    let rises = |array: &Array| array.values[0].len() > 1 && array.values[0].windows(2).all(|pair| pair[1] > pair[0]);
    let Some(time) = columns.iter().position(rises).filter(|_| columns.len() > 1) else {
        let what =
            "one array alone, and no column of it rises as stamps do; save stamps with it by numpy.savez".to_owned();
        return LogError::Format { file: path.to_path_buf(), format: Format::Npz, what };
    };
    let others = (0..columns.len()).filter(|k| *k != time);
    let named = |(ours, k): (&str, usize)| (ours.to_owned(), ColumnSpec::named(column_name(k)));
    let mut mend: BTreeMap<String, ColumnSpec> = ["q", "q_ref"].into_iter().zip(others).map(named).collect();
    mend.extend([named((Column::Time.name(), time))]);
    let found: Vec<String> = columns.iter().map(|array| array.name.clone()).collect();
    let first = LogError::MissingColumn {
        at: Box::new(Place::in_file(path)),
        column: Column::Time.name().to_owned(),
        found,
        hint: Some("an array without names; [columns] says what its columns are".to_owned()),
    };
    LogError::Defects { first: Box::new(first), count: 1, others: Vec::new(), beyond: 0, mend: Columns(mend) }
}

/// The arrays with names that a log has, and names and types of the others.
#[cfg(feature = "robots")]
fn arrays(file: File, columns: &Columns) -> Result<(Vec<Array>, Vec<String>), String> {
    let mut archive = Archive::open(file)?;
    let mut left = MOST_NUMBERS;
    let (mut arrays, mut others) = (Vec::new(), Vec::new());
    for entry in std::mem::take(&mut archive.entries) {
        let Some(name) = entry.name.strip_suffix(".npy").map(str::to_owned) else { continue };
        let is_wanted =
            guess(&name).is_some() || is_names(&name) || columns.0.values().any(|spec| spec.name.starts_with(&name));
        if is_wanted {
            let found = archive.content(&entry).and_then(|content| read_array(content, &name, entry.size, &mut left));
            arrays.extend(found.map_err(|what| format!("array `{name}`: {what}"))?);
        } else {
            others.extend(archive.content(&entry).and_then(|content| said_of(content, &name)));
        }
    }
    Ok((arrays, others))
}

fn is_names(name: &str) -> bool {
    matches!(name.to_lowercase().as_str(), "names" | "joint_names" | "joints" | "name" | "dof_names" | "labels")
}

/// The channels of these arrays; `unused` are names and types of others.
fn source(path: &Path, arrays: Vec<Array>, unused: Vec<String>, columns: &Columns) -> Result<Source, String> {
    let mut source = Source::new(path.to_path_buf(), Format::Npz);
    let found: Vec<String> = arrays.iter().map(Array::said).chain(unused).take(MOST_TOLD).collect();
    let left_out = arrays.iter().filter(|array| array.left_out.is_some());
    source.notes.extend(left_out.map(|array| format!("{}; left out", array.said())));
    let arrays = arrays.into_iter().filter(|array| array.left_out.is_none());
    let (mut texts, numbers): (Vec<Array>, Vec<Array>) = arrays.partition(|array| !array.texts.is_empty());
    let names = texts.iter().position(|array| is_names(&array.name)).map(|at| texts.remove(at).texts);
    source.notes.extend(texts.iter().map(|array| format!("{}: no numbers; left out", array.said())));
    let mapped = columns.get("t");
    let is_time = |array: &Array| match mapped {
        Some(spec) => spec.name == array.name,
        None => guess(&array.name).is_some_and(|guess| guess.column == Column::Time || is_stamp(&array.name)),
    };
    let (times, others): (Vec<Array>, Vec<Array>) =
        numbers.into_iter().partition(|array| array.values.len() == 1 && is_time(array));
    if times.is_empty() {
        let found = if found.is_empty() { "no array".to_owned() } else { found.join(", ") };
        return Err(format!(
            "no array of stamps (`t`, `time`, `timestamp`) of a type that is read ({READ}); found {found}"
        ));
    }
    // An array belongs to the stamps that are as many; of several such to those that sound like it.
    let mut lengths = Vec::new();
    for mut array in times {
        let unit = mapped.and_then(|spec| spec.unit).or_else(|| guess(&array.name)?.unit);
        let mut values = array.values.pop().unwrap_or_default();
        let by_steps = ns_per_unit(median_step(&values));
        if unit.is_none() && by_steps != NS {
            source.notes.push(format!("{}: stamps are {}, by their steps", array.name, unit_word(by_steps)));
        }
        let scale = unit.map_or(by_steps as f64 / NS as f64, Unit::scale);
        values.iter_mut().for_each(|value| *value *= scale);
        lengths.push((array.rows, array.name));
        source.clocks.push(values);
    }
    for mut array in others {
        let is_of = |rows: usize| lengths.iter().any(|(own, _)| *own == rows);
        if !is_of(array.rows) && is_of(array.values.len()) {
            array = array.turned();
        }
        let like = |name: &str| {
            guess(&array.name).is_some_and(|own| own.column == Column::Setpoint) == name.contains(['c', 'r'])
        };
        let clock = lengths
            .iter()
            .position(|(rows, name)| *rows == array.rows && lengths.len() > 1 && like(name))
            .or_else(|| lengths.iter().position(|(rows, _)| *rows == array.rows));
        let Some(clock) = clock else {
            source.notes.push(format!("{}: {} rows, as many as no array of stamps; left out", array.name, array.rows));
            continue;
        };
        let guessed = guess(&array.name).filter(|guess| guess.column != Column::Time);
        let width = array.values.len();
        for (k, values) in array.values.into_iter().enumerate() {
            let theirs = if width == 1 { array.name.clone() } else { array.name.clone() + &column_name(k) };
            let joint = match &names {
                Some(names) if width > 1 || names.len() == 1 => names.get(k).cloned(),
                _ if width > 1 => Some(format!("joint{}", k + 1)),
                _ => None,
            };
            let joint = joint.or_else(|| guessed.as_ref()?.joint.clone());
            let ours = guessed.as_ref().map(|guess| match &joint {
                Some(joint) => format!("{joint}.{}", guess.column.name()),
                None => guess.column.name().to_owned(),
            });
            let spec = guessed
                .as_ref()
                .and_then(|guess| guess.unit)
                .map(|unit| ColumnSpec { unit: Some(unit), ..ColumnSpec::named(&theirs) });
            source.channels.push(Channel { ours, theirs, clock, values, cell: None, spec });
        }
    }
    Ok(source)
}

/// Stamps with a word more: `t_cmd`, `time_ref`.
fn is_stamp(name: &str) -> bool {
    let name = name.to_lowercase();
    ["t_", "time_", "stamp_", "timestamp_"].iter().any(|start| name.starts_with(start))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(name: &str, descr: &str, left_out: Option<&'static str>) -> Array {
        let values = if left_out.is_some() { Vec::new() } else { vec![vec![0.0, 0.1]] };
        Array { name: name.to_owned(), descr: descr.to_owned(), left_out, rows: 2, values, texts: Vec::new() }
    }

    #[test]
    fn what_is_not_read_is_told_with_its_type() {
        let of = |arrays| source(Path::new("log.npz"), arrays, vec!["`extra` (<f8)".to_owned()], &Columns::default());
        let halves = array("t", "<f2", Some("a type that is not read"));
        let error = of(vec![halves, array("q", "<f8", None)]).unwrap_err();
        for part in ["found `t` (<f2, a type that is not read), `q` (<f8), `extra` (<f8)", "float32, float64"] {
            assert!(error.contains(part), "`{part}` is not in\n{error}");
        }
        let complex = array("q_ref", "<c16", Some("a type that is not read"));
        let source = of(vec![array("t", "<f8", None), array("q", "<f8", None), complex]).unwrap();
        assert_eq!(source.notes, ["`q_ref` (<c16, a type that is not read); left out"]);
    }
}
