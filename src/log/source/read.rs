//! Which format a file has, by what is in it, and its channels.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use super::channel::{Format, Source};
use super::columns::Columns;
use super::defects::Defects;
use super::joint_layout::Layout;
use super::joint_tables::read_joint_table;
use super::table::read_table;
use super::topics::Topics;
use super::{bam, mcap, npz, rosbag, sage, sqlite};
use crate::log::error::LogError;
use crate::log::header::Column;
use crate::log::place::Place;
use crate::log::rows;

/// What is wanted of a file.
#[derive(Clone, Copy, Debug)]
pub(in crate::log) enum Want<'a> {
    /// The log of one joint.
    One,
    /// One joint of several.
    Joint(&'a str),
    /// All joints.
    Robot,
    /// Whatever there is.
    Any,
}

/// What a path is.
#[derive(Debug)]
enum Kind {
    /// A table of text whose columns are ours, or `[columns]`'.
    Table,
    JointTable(Layout),
    Sage(PathBuf),
    /// Bags that follow one another.
    Bags(Vec<PathBuf>),
    LeRobot,
    Npz,
    Bam,
}

/// Reads all that a file or folder of any known format holds, by what `[columns]` says of it.
///
/// ```
/// use aibo_fit::log::{Columns, read_source};
/// let source = read_source("data/examples/arm/log0.csv".as_ref(), &Columns::default())?;
/// assert_eq!(source.joints(), [Some("arm/shoulder"), Some("arm/elbow")]);
/// # Ok::<(), aibo_fit::log::LogError>(())
/// ```
///
/// # Errors
/// [`LogError`] where it cannot be read, is damaged, or is of no format that is known.
pub fn read_source(path: &Path, columns: &Columns) -> Result<Source, LogError> {
    read_wanted(path, Want::Any, columns)
}

/// What is wanted of a file or folder.
///
/// # Errors
/// As [`read_source`].
pub(in crate::log) fn read_wanted(path: &Path, want: Want<'_>, columns: &Columns) -> Result<Source, LogError> {
    let source = match kind_of(path, columns)? {
        Kind::Table => return read_table(path, want, columns),
        Kind::JointTable(layout) => read_joint_table(path, layout)?,
        Kind::Sage(folder) => sage::read_sage(&folder)?,
        Kind::Bags(files) => read_bags(path, &files)?,
        Kind::LeRobot => lerobot(path)?,
        Kind::Npz => npz::read_npz(path, columns)?,
        Kind::Bam => bam::read_bam(path)?,
    };
    let mut source = mapped(source, columns)?;
    check(&source)?;
    source.notes.insert(0, format!("read as {}", source.format));
    Ok(source)
}

#[cfg(feature = "parquet")]
fn lerobot(path: &Path) -> Result<Source, LogError> {
    super::lerobot::read_lerobot(path)
}

#[cfg(not(feature = "parquet"))]
fn lerobot(path: &Path) -> Result<Source, LogError> {
    let what = "this build reads no Parquet; build with the feature `parquet`".to_owned();
    Err(LogError::Format { file: path.to_path_buf(), format: Format::LeRobot, what })
}

/// Whether a folder is a log.
pub(in crate::log) fn is_log_folder(path: &Path) -> bool {
    folder_kind(path).is_some()
}

/// Files that are read of a path: itself, or those of a folder that are.
///
/// # Errors
/// [`LogError::Read`] where a folder cannot be listed.
pub fn log_files(path: &Path) -> Result<Vec<PathBuf>, LogError> {
    if !path.is_dir() {
        return Ok(sage::folder_of(path).map_or_else(|| vec![path.to_path_buf()], |folder| sage::files(&folder)));
    }
    match folder_kind(path) {
        Some(Kind::Sage(folder)) => Ok(sage::files(&folder)),
        Some(Kind::Bags(files)) => Ok(files),
        #[cfg(feature = "parquet")]
        Some(Kind::LeRobot) => {
            let failed = |source| LogError::Read { file: path.to_path_buf(), source };
            let info = path.join("meta/info.json");
            Ok(super::lerobot::files(path).map_err(failed)?.into_iter().chain([info]).collect())
        }
        _ => Ok(vec![path.to_path_buf()]),
    }
}

fn folder_kind(path: &Path) -> Option<Kind> {
    if !path.is_dir() {
        return None;
    }
    if sage::is_sage(path) {
        return Some(Kind::Sage(path.to_path_buf()));
    }
    if path.join("meta/info.json").is_file() {
        return Some(Kind::LeRobot);
    }
    let bags = bags_of(path);
    (!bags.is_empty()).then_some(Kind::Bags(bags))
}

/// The bags in a folder, in the order of their names.
fn bags_of(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path()));
    let is_bag = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "db3" || ending == "mcap");
    let mut bags: Vec<PathBuf> = entries.filter(is_bag).collect();
    bags.sort();
    bags
}

fn kind_of(path: &Path, columns: &Columns) -> Result<Kind, LogError> {
    if let Some(kind) = folder_kind(path) {
        return Ok(kind);
    }
    let failed = |source| LogError::Read { file: path.to_path_buf(), source };
    let is_file = fs::metadata(path).map_err(failed)?.is_file();
    if !is_file {
        // A pipe can be read once only.
        return Ok(Kind::Table);
    }
    let mut start = [0; 64];
    let mut file = File::open(path).map_err(failed)?;
    let mut have = 0;
    while have < start.len() {
        match file.read(&mut start[have..]).map_err(failed)? {
            0 => break,
            count => have += count,
        }
    }
    let start = &start[..have];
    let ends = |ending: &str| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending));
    let wrong = |format, what: &str| Err(LogError::Format { file: path.to_path_buf(), format, what: what.to_owned() });
    let is_text = rows::not_text(start).is_none();
    Ok(match start {
        start if start.starts_with(sqlite::MAGIC) || start.starts_with(mcap::MAGIC) => {
            Kind::Bags(vec![path.to_path_buf()])
        }
        start if start.starts_with(b"PAR1") => Kind::LeRobot,
        start if start.starts_with(b"PK") && (npz::holds_arrays(path) || ends("npz")) => Kind::Npz,
        start if start.starts_with(b"\x93NUMPY") => {
            return wrong(Format::Npz, "one array alone has no stamps; save it with them by numpy.savez");
        }
        start if start.starts_with(b"#ROSBAG") => {
            return wrong(Format::Rosbag2, "a bag of ROS 1; convert it first, as with `rosbags-convert`");
        }
        [0x28, 0xb5, 0x2f, 0xfd, ..] => {
            return wrong(Format::Rosbag2, "packed as a whole by zstd; unpack it first with `zstd -d`");
        }
        // The ending says what it should be: the first bytes are not those of such a file.
        _ if ends("db3") => {
            return wrong(Format::Rosbag2, "damaged, or none: it does not begin as an SQLite file does");
        }
        _ if ends("mcap") => return wrong(Format::Mcap, "damaged, or none: it does not begin as an MCAP file does"),
        _ if ends("parquet") => {
            return wrong(Format::LeRobot, "damaged, or none: it does not begin as a Parquet file does");
        }
        _ if ends("npz") => return wrong(Format::Npz, "damaged, or none: it does not begin as a zip file does"),
        start if is_text && start.trim_ascii_start().starts_with(b"{") => Kind::Bam,
        _ => match sage::folder_of(path) {
            Some(folder) => Kind::Sage(folder),
            None if is_text => table_kind(path, columns),
            None => Kind::Table,
        },
    })
}

/// Which kind of table of text; what is wrong with it is for its reader to say.
fn table_kind(path: &Path, columns: &Columns) -> Kind {
    let mut seen: Vec<Vec<String>> = Vec::new();
    let read = rows::for_some_rows(path, 2, |_, record| {
        seen.push(record.iter().map(|cell| String::from_utf8_lossy(cell).trim().to_owned()).collect());
        Ok(())
    });
    let [names, first] = &seen[..] else { return Kind::Table };
    let is_there = |name: &str| names.iter().any(|other| other == name);
    let is_ours = is_there(Column::Time.name()) && names.iter().any(|name| name == "q" || name.ends_with(".q"));
    let is_mapped = columns.get(Column::Time.name()).is_some_and(|spec| is_there(&spec.name));
    if read.is_err() || is_ours || is_mapped {
        return Kind::Table;
    }
    Layout::find(names, first).map_or(Kind::Table, Kind::JointTable)
}

fn read_bags(path: &Path, files: &[PathBuf]) -> Result<Source, LogError> {
    let mut topics = Topics::default();
    let mut format = Format::Rosbag2;
    for file in files {
        let mut start = [0; 8];
        let mut opened = File::open(file).map_err(|source| LogError::Read { file: file.clone(), source })?;
        // A file that is shorter is for its reader to refuse.
        let is_mcap = opened.read_exact(&mut start).is_ok() && start == *mcap::MAGIC
            || file.extension().is_some_and(|ending| ending == "mcap");
        if is_mcap {
            format = Format::Mcap;
            mcap::read_mcap(file, &mut topics)?;
        } else {
            rosbag::read_db3(file, &mut topics)?;
        }
    }
    topics.into_source(path, format)
}

/// Applies `[columns]`, and the units that the reader told.
fn mapped(mut source: Source, columns: &Columns) -> Result<Source, LogError> {
    for (ours, spec) in columns.0.iter().filter(|(ours, _)| *ours != Column::Time.name()) {
        let Some(at) = source.channels.iter().position(|channel| channel.theirs == spec.name) else {
            if source.ours(ours).is_some()
                || !ours.ends_with(Column::Angle.name())
                || ours.ends_with(Column::Speed.name())
            {
                continue;
            }
            let found = source.channels.iter().map(|channel| channel.theirs.clone()).collect();
            let hint = Some(format!("[columns] says that it is `{ours}`"));
            let at = Box::new(Place::in_file(&source.file));
            return Err(LogError::MissingColumn { at, column: spec.name.clone(), found, hint });
        };
        source.channels.iter_mut().filter(|c| c.ours.as_ref() == Some(ours)).for_each(|c| c.ours = None);
        let channel = &mut source.channels[at];
        let told = channel.spec.take().and_then(|spec| spec.unit);
        channel.ours = Some(ours.clone());
        channel.spec = Some(super::columns::ColumnSpec { unit: spec.unit.or(told), ..spec.clone() });
    }
    for channel in &mut source.channels {
        if let Some(spec) = channel.spec.take() {
            channel.values.iter_mut().for_each(|value| *value = spec.apply(*value));
        }
    }
    Ok(source)
}

/// What the checks of a table are to a table: stamps that rise, numbers, units.
fn check(source: &Source) -> Result<(), LogError> {
    let mut defects = Defects::default();
    let wrong = |what: String| LogError::Format { file: source.file.clone(), format: source.format, what };
    for (clock, t_s) in source.clocks.iter().enumerate() {
        let name = source.channels.iter().find(|channel| channel.clock == clock).map_or("", |channel| &channel.theirs);
        if let Some(at) = t_s.windows(2).position(|pair| !(pair[1] > pair[0])) {
            defects.push(
                Some(clock),
                wrong(format!("stamps of {name} do not rise: {} s after {} s", t_s[at + 1], t_s[at])),
            );
        }
    }
    for channel in source.channels.iter().filter(|channel| channel.ours.is_some()) {
        if let Some(at) = channel.values.iter().position(|value| !value.is_finite() || value.abs() > 1e9) {
            defects.push(
                None,
                wrong(format!("{}, sample {at}: {}, expected a number", channel.theirs, channel.values[at])),
            );
        }
    }
    if defects.is_empty() {
        source.unit_defects(&mut defects);
    }
    let mend = if defects.is_empty() { Columns::default() } else { source.mend() };
    defects.into_result(mend)
}
