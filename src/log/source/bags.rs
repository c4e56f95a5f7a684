//! Bags: files of ROS 1, of ROS 2 in SQLite and of MCAP, packed as a whole or not, and folders of them.

use std::fs;
#[cfg(feature = "robots")]
use std::fs::File;
#[cfg(feature = "robots")]
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

#[cfg(feature = "robots")]
use super::bytes::{MCAP_MAGIC, ROS1_MAGIC};
use super::channel::Source;
#[cfg(feature = "robots")]
use super::topics::Topics;
#[cfg(feature = "robots")]
use super::{mcap, packed, ros1_bag, rosbag};
use crate::log::error::LogError;
use crate::log::format::Format;

/// What stands beside the bags of a folder.
pub(super) const ABOUT: &str = "metadata.yaml";

/// The bags in a folder, in the order in which they were written. A packed one beside the same unpacked is none of its own.
pub(super) fn bags_of(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path()));
    let mut bags: Vec<PathBuf> = entries.filter(|path| is_bag(&bare(path))).collect();
    bags.sort_by_cached_key(|path| parts(&path.to_string_lossy()));
    let plain: Vec<PathBuf> = bags.iter().filter(|path| is_bag(path)).cloned().collect();
    bags.retain(|path| is_bag(path) || !plain.contains(&bare(path)));
    bags
}

fn is_bag(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "db3" || ending == "mcap" || ending == "bag")
}

/// A path without the ending that zstd adds.
fn bare(path: &Path) -> PathBuf {
    let is_packed = path.extension().is_some_and(|ending| ending == "zstd" || ending == "zst");
    if is_packed { path.with_extension("") } else { path.to_path_buf() }
}

/// A name in parts, so that `bag_10` comes after `bag_9`.
fn parts(name: &str) -> Vec<(String, u64)> {
    let mut parts = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let word = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
        let end = rest[word..].find(|c: char| !c.is_ascii_digit()).map_or(rest.len(), |length| word + length);
        parts.push((rest[..word].to_owned(), rest[word..end].parse().unwrap_or(0)));
        rest = &rest[end..];
    }
    parts
}

/// Refuses bags.
///
/// # Errors
/// [`LogError::Format`] in any case.
#[cfg(not(feature = "robots"))]
pub(super) fn read_bags(path: &Path, _: &[PathBuf]) -> Result<Source, LogError> {
    let what = "this build reads no bags; build with the feature `robots`".to_owned();
    Err(LogError::Format { file: path.to_path_buf(), format: Format::Rosbag2, what })
}

/// Reads bags that follow one another.
///
/// # Errors
/// [`LogError`] where one cannot be read, is damaged, or none has a message of joints.
#[cfg(feature = "robots")]
pub(super) fn read_bags(path: &Path, files: &[PathBuf]) -> Result<Source, LogError> {
    let mut topics = Topics::default();
    let mut format = Format::Rosbag2;
    for file in files {
        let failed = |source| LogError::Read { file: file.clone(), source };
        let mut opened = File::open(file).map_err(failed)?;
        if packed::is_packed(&mut opened).map_err(failed)? {
            let wrong = |what| LogError::Format { file: file.clone(), format: Format::Rosbag2, what };
            opened = packed::unpack(opened).map_err(wrong)?;
        }
        let mut start = [0; 9];
        // A file that is shorter is for its reader to refuse.
        let is_whole = opened.read_exact(&mut start).is_ok();
        opened.seek(SeekFrom::Start(0)).map_err(failed)?;
        let ending = bare(file);
        let is_mcap = is_whole && start.starts_with(MCAP_MAGIC)
            || !is_whole && ending.extension().is_some_and(|ending| ending == "mcap");
        if is_mcap {
            format = Format::Mcap;
            mcap::read_mcap(file, opened, &mut topics)?;
        } else if is_whole && start.starts_with(ROS1_MAGIC) {
            format = Format::Rosbag1;
            ros1_bag::read_ros1(file, opened, &mut topics)?;
        } else {
            rosbag::read_db3(file, opened, &mut topics)?;
        }
    }
    let mut source = topics.into_source(path, format)?;
    source.notes.extend(missing(path));
    Ok(source)
}

/// What the description of a folder of bags names and is not there, in words.
#[cfg(feature = "robots")]
fn missing(path: &Path) -> Option<String> {
    let folder = if path.is_dir() { path } else { path.parent().filter(|_| path.ends_with(ABOUT))? };
    let about = fs::read_to_string(folder.join(ABOUT)).ok()?;
    let list = about.lines().map(str::trim).skip_while(|line| *line != "relative_file_paths:").skip(1);
    let named = list.map_while(|line| Some(line.strip_prefix("- ")?.trim_matches(['"', '\''])));
    let is_there =
        |name: &str| [Path::new(name).to_path_buf(), bare(Path::new(name))].iter().any(|own| folder.join(own).exists());
    let missing: Vec<&str> = named.filter(|name| !is_there(name)).collect();
    (!missing.is_empty()).then(|| {
        format!(
            "{ABOUT} names {}, which {} not there: a part of the bag",
            missing.join(", "),
            if missing.len() == 1 { "is" } else { "are" }
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bags_of_a_folder_come_in_the_order_of_their_numbers_and_once() {
        let dir = tempfile::tempdir().unwrap();
        for name in ["b_10.db3", "b_9.db3.zstd", "b_2.db3", "b_2.db3.zstd", "metadata.yaml"] {
            fs::write(dir.path().join(name), b"").unwrap();
        }
        let found = bags_of(dir.path());
        let names: Vec<_> = found.iter().map(|path| path.file_name().unwrap().to_str().unwrap()).collect();
        assert_eq!(names, ["b_2.db3", "b_9.db3.zstd", "b_10.db3"]);
    }

    #[test]
    #[cfg(feature = "robots")]
    fn bags_that_are_announced_and_not_there_are_told() {
        let dir = tempfile::tempdir().unwrap();
        let about = "a:\n  relative_file_paths:\n    - b_0.db3\n    - \"b_1.db3\"\n  duration: 3\n";
        fs::write(dir.path().join("b_0.db3"), b"").unwrap();
        assert_eq!(missing(dir.path()), None);
        fs::write(dir.path().join(ABOUT), about).unwrap();
        let told = "metadata.yaml names b_1.db3, which is not there: a part of the bag";
        assert_eq!(missing(dir.path()).as_deref(), Some(told));
        assert_eq!(missing(&dir.path().join(ABOUT)).as_deref(), Some(told));
    }
}
