//! Which format a file or folder has, by what is in it.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use super::bytes::{MCAP_MAGIC, ROS1_MAGIC, SQLITE_MAGIC, ZSTD_MAGIC};
use super::joint_layout::Layout;
use super::{bags, npy, npz, sage};
use crate::log::column::Column;
use crate::log::columns::Columns;
use crate::log::error::{FileKind, LogError};
use crate::log::format::Format;
use crate::log::rows;

/// How bags begin, of any kind.
const BAGS: [&[u8]; 4] = [SQLITE_MAGIC, MCAP_MAGIC, ROS1_MAGIC, &ZSTD_MAGIC];

/// What a path is.
#[derive(Debug)]
pub(super) enum Kind {
    /// A table of text whose columns are ours, or `[columns]`'.
    Table,
    JointTable(Layout),
    Sage(PathBuf),
    /// Bags that follow one another.
    Bags(Vec<PathBuf>),
    LeRobot,
    Npz,
    /// One array alone.
    Npy,
    Bam,
}

/// A folder's path as it can be listed: that of `metadata.yaml` alone is the working folder.
fn whole(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
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
    let bags = bags::bags_of(path);
    (!bags.is_empty()).then_some(Kind::Bags(bags))
}

/// What a path is, by its first bytes, and by its ending where these are none that are known.
///
/// # Errors
/// [`LogError`] where it cannot be read, or is of a format that is known not to be read.
pub(super) fn kind_of(path: &Path, columns: &Columns) -> Result<Kind, LogError> {
    if let Some(kind) = folder_kind(path) {
        return Ok(kind);
    }
    // What stands beside bags leads to them.
    let beside = path.file_name().filter(|name| *name == bags::ABOUT).and_then(|_| path.parent());
    if let Some(kind @ Kind::Bags(_)) = beside.and_then(|folder| folder_kind(whole(folder))) {
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
        start if BAGS.iter().any(|magic| start.starts_with(magic)) => Kind::Bags(vec![path.to_path_buf()]),
        start if start.starts_with(b"PAR1") => Kind::LeRobot,
        start if start.starts_with(b"PK") && (npz::holds_arrays(path) || ends("npz")) => Kind::Npz,
        start if start.starts_with(npy::MAGIC) => Kind::Npy,
        start if rows::not_text(start) == Some(FileKind::LfsPointer) => {
            return Err(LogError::NotText { file: path.to_path_buf(), found: FileKind::LfsPointer });
        }
        // The ending says what it should be: the first bytes are not those of such a file.
        _ if ends("db3") => {
            return wrong(Format::Rosbag2, "damaged, or none: it does not begin as an SQLite file does");
        }
        _ if ends("mcap") => return wrong(Format::Mcap, "damaged, or none: it does not begin as an MCAP file does"),
        _ if ends("parquet") => {
            return wrong(Format::LeRobot, "damaged, or none: it does not begin as a Parquet file does");
        }
        _ if ends("bag") => return wrong(Format::Rosbag1, "damaged, or none: it does not begin as a bag does"),
        _ if ends("npy") => return wrong(Format::Npz, "damaged, or none: it does not begin as an array of NumPy does"),
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
