//! NumPy arrays in a zip file (`.npz`): one array of stamps, arrays of one column, or of one for each joint.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use super::channel::{Channel, Format, Source};
use super::columns::{Columns, Unit};
use super::guess::guess;
use super::zip::{Archive, Entry};
use crate::log::error::LogError;
use crate::log::header::Column;

/// Numbers of one file at the most: half a gigabyte.
const MOST_NUMBERS: u64 = 1 << 26;
/// The description of an array at the most \[bytes\].
const LONGEST_HEAD: usize = 65_536;
/// Joints of one array at the most.
const MOST_JOINTS: u64 = 512;

/// Whether a zip file holds arrays.
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
    arrays(file, columns).and_then(|arrays| source(path, arrays, columns)).map_err(wrong)
}

struct Array {
    name: String,
    /// Rows and columns; one column of a plain list.
    rows: usize,
    values: Vec<Vec<f64>>,
    texts: Vec<String>,
}

fn arrays(file: File, columns: &Columns) -> Result<Vec<Array>, String> {
    let mut archive = Archive::open(file)?;
    let mut left = MOST_NUMBERS;
    let mut arrays = Vec::new();
    for entry in std::mem::take(&mut archive.entries) {
        let Some(name) = entry.name.strip_suffix(".npy").map(str::to_owned) else { continue };
        let is_wanted =
            guess(&name).is_some() || is_names(&name) || columns.0.values().any(|spec| spec.name.starts_with(&name));
        if is_wanted
            && let Some(array) = array(&mut archive, &entry, name.clone(), &mut left)
                .map_err(|what| format!("array `{name}`: {what}"))?
        {
            arrays.push(array);
        }
    }
    Ok(arrays)
}

fn is_names(name: &str) -> bool {
    matches!(name.to_lowercase().as_str(), "names" | "joint_names" | "joints" | "name" | "dof_names" | "labels")
}

/// `None`: of a kind that is not used.
fn array(archive: &mut Archive, entry: &Entry, name: String, left: &mut u64) -> Result<Option<Array>, String> {
    let mut content = archive.content(entry)?;
    let mut head = [0; 8];
    content.read_exact(&mut head).map_err(cut)?;
    if &head[..6] != b"\x93NUMPY" {
        return Err("it is no array of NumPy".to_owned());
    }
    let mut length = [0; 4];
    let long = head[6] >= 2;
    content.read_exact(&mut length[..if long { 4 } else { 2 }]).map_err(cut)?;
    let length = u32::from_le_bytes(length) as usize;
    if length > LONGEST_HEAD {
        return Err(format!("a description of {length} bytes is announced"));
    }
    let mut text = vec![0; length];
    content.read_exact(&mut text).map_err(cut)?;
    let text = String::from_utf8_lossy(&text).into_owned();
    let shape = Shape::read(&text)?;
    let Some(kind) = Kind::read(&shape.descr) else { return Ok(None) };
    let (rows, width) = match shape.dims[..] {
        [] => return Ok(None),
        [rows] => (rows, 1),
        [rows, width] => (rows, width),
        _ => return Ok(None),
    };
    let numbers = rows.checked_mul(width).filter(|numbers| *numbers <= *left && width <= MOST_JOINTS);
    let Some(numbers) = numbers else {
        return Err(format!("{rows} rows of {width} numbers are announced, more than the {left} that are read"));
    };
    if numbers.saturating_mul(kind.size as u64).saturating_add(length as u64) > entry.size {
        return Err(format!(
            "{rows} rows of {width} numbers are announced, more than the {} bytes there are",
            entry.size
        ));
    }
    *left -= numbers;
    let (rows, width) = (rows as usize, width as usize);
    let mut values = vec![Vec::new(); if kind.is_text() { 0 } else { width }];
    let mut texts = Vec::new();
    let mut item = vec![0; kind.size];
    let mut content = BufReader::with_capacity(1 << 16, content);
    for k in 0..rows * width {
        content.read_exact(&mut item).map_err(cut)?;
        if kind.is_text() {
            texts.push(kind.text(&item));
        } else {
            let column = if shape.fortran && width > 1 { k / rows } else { k % width };
            values[column].push(kind.number(&item));
        }
    }
    // What is left of the entry is read too, so that its checksum is compared.
    std::io::copy(&mut content, &mut std::io::sink()).map_err(cut)?;
    Ok(Some(Array { name, rows, values, texts }))
}

fn cut(error: std::io::Error) -> String {
    if error.kind() == std::io::ErrorKind::UnexpectedEof { "cut short".to_owned() } else { format!("damaged: {error}") }
}

/// The description of an array.
struct Shape {
    descr: String,
    fortran: bool,
    dims: Vec<u64>,
}

impl Shape {
    fn read(text: &str) -> Result<Self, String> {
        let after =
            |key: &str| text.find(key).map(|at| text[at + key.len()..].trim_start_matches([' ', ':', '\'', '"']));
        let damaged = || "damaged: its description cannot be read".to_owned();
        let descr: String = after("'descr'")
            .ok_or_else(damaged)?
            .chars()
            .take_while(|c| !matches!(c, '\'' | '"' | ',' | ' '))
            .collect();
        let fortran = after("'fortran_order'").ok_or_else(damaged)?.starts_with("True");
        let dims = after("'shape'").and_then(|rest| rest.strip_prefix('(')?.split(')').next()).ok_or_else(damaged)?;
        let dims = dims.split(',').map(str::trim).filter(|part| !part.is_empty());
        let dims: Vec<u64> = dims.map(str::parse).collect::<Result<_, _>>().map_err(|_| damaged())?;
        Ok(Self { descr, fortran, dims })
    }
}

/// What an item of an array is.
#[derive(Clone, Copy)]
struct Kind {
    letter: u8,
    size: usize,
    is_big: bool,
}

impl Kind {
    fn read(descr: &str) -> Option<Self> {
        let (order, rest) = descr.split_at_checked(1)?;
        let (letter, count) = rest.split_at_checked(1)?;
        let (letter, count) = (letter.as_bytes()[0], count.parse::<usize>().ok()?);
        let is_known = match letter {
            b'f' => matches!(count, 4 | 8),
            b'i' | b'u' => matches!(count, 1 | 2 | 4 | 8),
            b'b' => count == 1,
            b'U' | b'S' => count <= 256,
            _ => false,
        };
        let size = if letter == b'U' { 4 * count } else { count };
        (is_known && size > 0).then_some(Self { letter, size, is_big: order == ">" })
    }

    fn is_text(self) -> bool {
        matches!(self.letter, b'U' | b'S')
    }

    fn number(self, item: &[u8]) -> f64 {
        let mut bytes = [0; 8];
        for (k, byte) in item.iter().enumerate() {
            bytes[if self.is_big { item.len() - 1 - k } else { k }] = *byte;
        }
        let whole = u64::from_le_bytes(bytes);
        match (self.letter, self.size) {
            (b'f', 4) => f64::from(f32::from_bits(whole as u32)),
            (b'f', _) => f64::from_bits(whole),
            (b'i', size) => {
                let unused = 64 - 8 * size as u32;
                ((whole << unused) as i64 >> unused) as f64
            }
            _ => whole as f64,
        }
    }

    fn text(self, item: &[u8]) -> String {
        if self.letter == b'S' {
            return String::from_utf8_lossy(item).trim_end_matches('\0').to_owned();
        }
        let codes = item.chunks_exact(4).map(|code| {
            let code: [u8; 4] = code.try_into().unwrap_or_default();
            if self.is_big { u32::from_be_bytes(code) } else { u32::from_le_bytes(code) }
        });
        codes.take_while(|code| *code != 0).map(|code| char::from_u32(code).unwrap_or('?')).collect()
    }
}

fn source(path: &Path, arrays: Vec<Array>, columns: &Columns) -> Result<Source, String> {
    let mut source = Source::new(path.to_path_buf(), Format::Npz);
    let (texts, numbers): (Vec<Array>, Vec<Array>) = arrays.into_iter().partition(|array| !array.texts.is_empty());
    let names = texts.into_iter().find(|array| is_names(&array.name)).map(|array| array.texts);
    let mapped = columns.get("t");
    let is_time = |array: &Array| match mapped {
        Some(spec) => spec.name == array.name,
        None => guess(&array.name).is_some_and(|guess| guess.column == Column::Time || is_stamp(&array.name)),
    };
    let (times, others): (Vec<Array>, Vec<Array>) =
        numbers.into_iter().partition(|array| array.values.len() == 1 && is_time(array));
    if times.is_empty() {
        let found: Vec<&str> = others.iter().map(|array| array.name.as_str()).collect();
        return Err(format!("no array of stamps (`t`, `time`, `timestamp`); found {}", found.join(", ")));
    }
    // An array belongs to the stamps that are as many; of several such to those that sound like it.
    let mut lengths = Vec::new();
    for mut array in times {
        let unit = mapped.and_then(|spec| spec.unit).or_else(|| guess(&array.name)?.unit);
        let scale = unit.map_or(1.0, Unit::scale);
        let mut values = array.values.pop().unwrap_or_default();
        values.iter_mut().for_each(|value| *value *= scale);
        lengths.push((array.rows, array.name));
        source.clocks.push(values);
    }
    for array in others {
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
            let theirs = if width == 1 { array.name.clone() } else { format!("{}[:, {k}]", array.name) };
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
            let spec = guessed.as_ref().and_then(|guess| guess.unit).map(|unit| super::columns::ColumnSpec {
                unit: Some(unit),
                ..super::columns::ColumnSpec::named(&theirs)
            });
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

/// The file's size, where it can be told.
pub(super) fn size(file: &mut File) -> Result<u64, String> {
    file.seek(SeekFrom::End(0)).map_err(|error| error.to_string())
}
