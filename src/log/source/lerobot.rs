//! LeRobot datasets: a folder with `meta/info.json` and Parquet tables, of layout 2 (a file for each episode) or 3
//! (several episodes in a file), or one such file.
//!
//! `observation.state` is what was read, `action` what was asked. Episodes follow one another after a hole of a second
//! that nobody recorded; holes split a log, so that each has a start of its own.

use std::fs::{self, File};
use std::io::{Read, Seek};
use std::path::{Path, PathBuf};

use parquet::file::reader::{FileReader, SerializedFileReader};

use super::channel::{Channel, Source};
use super::parquet_numbers::{is_unpacked, numbers, theirs};
use crate::log::columns::{ColumnSpec, Unit};
use crate::log::error::{FileKind, LogError};
use crate::log::format::Format;
use crate::log::rows;
use std::f64::consts::{PI, TAU};

/// Between two episodes, less than a frame more \[s\].
const BREAK_S: f64 = 1.0;
/// So many episodes are told by their times.
const TOLD_EPISODES: usize = 40;
/// Beyond this no joint is in radians: two turns.
const WIDEST_RAD: f64 = 4.0 * PI;
/// Robots whose angles LeRobot writes in degrees or in percent of their range.
const IN_DEGREES: [&str; 5] = ["so100", "so101", "koch", "lekiwi", "moss"];
/// Numbers of a dataset at the most: half a gigabyte.
const MOST_NUMBERS: usize = 1 << 26;
const STATE: &str = "observation.state";
const ACTION: &str = "action";

/// Whether a folder is a dataset.
pub(super) fn is_dataset(folder: &Path) -> bool {
    folder.join("meta/info.json").is_file()
}

/// The Parquet files of a dataset, in order.
///
/// # Errors
/// Where a folder cannot be listed.
pub(super) fn files(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let mut folders = vec![folder.join("data")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder)? {
            let path = entry?.path();
            if path.is_dir() && folders.len() < 1000 {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "parquet") {
                files.push(path);
            }
        }
    }
    files.sort();
    Ok(files)
}

/// Reads a dataset, or one of its files.
///
/// # Errors
/// [`LogError::Format`] where a file is damaged, or holds no state.
pub(super) fn read_lerobot(path: &Path) -> Result<Source, LogError> {
    let wrong =
        |file: &Path, what: String| LogError::Format { file: file.to_path_buf(), format: Format::LeRobot, what };
    let failed = |file: &Path, source| LogError::Read { file: file.to_path_buf(), source };
    let (folder, files) = if path.is_dir() {
        (Some(path.to_path_buf()), files(path).map_err(|source| failed(&path.join("data"), source))?)
    } else {
        let above = path.ancestors().skip(1).take(4).find(|folder| is_dataset(folder));
        (above.map(Path::to_path_buf), vec![path.to_path_buf()])
    };
    if files.is_empty() {
        return Err(wrong(path, "no Parquet file under data/".to_owned()));
    }
    let info = folder.map(|folder| Info::read(&folder.join("meta/info.json"))).transpose()?.unwrap_or_default();
    let mut frames = Frames::default();
    for file in &files {
        let mut opened = File::open(file).map_err(|source| failed(file, source))?;
        let mut start = [0; 64];
        let have = opened.read(&mut start).map_err(|source| failed(file, source))?;
        if rows::not_text(&start[..have]) == Some(FileKind::LfsPointer) {
            return Err(LogError::NotText { file: file.clone(), found: FileKind::LfsPointer });
        }
        opened.rewind().map_err(|source| failed(file, source))?;
        frames.add(opened).map_err(|what| wrong(file, what))?;
    }
    frames.into_source(path, &info).map_err(|what| wrong(path, what))
}

/// What `meta/info.json` says.
#[derive(Default)]
struct Info {
    fps: Option<f64>,
    state: Vec<String>,
    action: Vec<String>,
    robot: Option<String>,
}

impl Info {
    fn read(path: &Path) -> Result<Self, LogError> {
        let bytes = fs::read(path).map_err(|source| LogError::Read { file: path.to_path_buf(), source })?;
        let json: serde_json::Value = serde_json::from_slice(&bytes).map_err(|error| LogError::Format {
            file: path.to_path_buf(),
            format: Format::LeRobot,
            what: error.to_string(),
        })?;
        Ok(Self {
            fps: json["fps"].as_f64().filter(|fps| *fps > 0.0 && *fps <= 1e5),
            state: names(&json["features"][STATE]["names"]),
            action: names(&json["features"][ACTION]["names"]),
            robot: json["robot_type"].as_str().map(str::to_owned),
        })
    }
}

/// Names of a feature: a list, a list under the one key of a table, or a table of their places.
fn names(json: &serde_json::Value) -> Vec<String> {
    let place_of = |(name, place): (&String, &serde_json::Value)| Some((place.as_u64()?, joint_name(name)));
    let places: Option<Vec<(u64, String)>> = json.as_object().and_then(|table| table.iter().map(place_of).collect());
    if let Some(mut places) = places {
        places.sort_by_key(|(place, _)| *place);
        return places.into_iter().map(|(_, name)| name).collect();
    }
    let list = json.as_array().or_else(|| json.as_object()?.values().next()?.as_array());
    list.into_iter().flatten().filter_map(|name| name.as_str().map(joint_name)).collect()
}

/// A joint without what LeRobot hangs on its name.
fn joint_name(name: &str) -> String {
    let name = name.strip_suffix(".pos").unwrap_or(name);
    name.strip_prefix("main_").unwrap_or(name).to_owned()
}

/// The frames of all files so far.
#[derive(Default)]
struct Frames {
    episode: Vec<i64>,
    frame: Vec<i64>,
    stamp: Vec<f64>,
    state: Vec<Vec<f64>>,
    action: Vec<Vec<f64>>,
    numbers: usize,
}

impl Frames {
    fn add(&mut self, file: File) -> Result<(), String> {
        let reader = theirs(|| SerializedFileReader::new(file))?;
        let schema = reader.metadata().file_metadata().schema_descr_ptr();
        let column = |name: &str| {
            (0..schema.num_columns())
                .find(|k| schema.column(*k).path().parts().first().is_some_and(|first| first == name))
        };
        let found = || schema.columns().iter().map(|column| column.path().string()).collect::<Vec<_>>().join(", ");
        let state = column(STATE).ok_or_else(|| format!("no column `{STATE}`; found {}", found()))?;
        let (action, stamp) = (column(ACTION), column("timestamp"));
        let (episode, frame) = (column("episode_index"), column("frame_index"));
        for group in 0..reader.num_row_groups() {
            let group = theirs(|| reader.get_row_group(group))?;
            let rows = usize::try_from(group.metadata().num_rows())
                .map_err(|_| "damaged: a negative count of rows".to_owned())?;
            let mut read = |at: usize| -> Result<Vec<f64>, String> {
                is_unpacked(group.metadata().column(at).compression())?;
                let column = theirs(|| group.get_column_reader(at))?;
                let values = numbers(column, MOST_NUMBERS - self.numbers)?;
                self.numbers += values.len();
                let is_even = if rows == 0 { values.is_empty() } else { values.len().is_multiple_of(rows) };
                is_even.then_some(values).ok_or_else(|| {
                    format!("`{}`: not the same count of numbers in every row", schema.column(at).path())
                })
            };
            let one = |values: Vec<f64>| {
                if values.len() == rows { Ok(values) } else { Err("a list where one number is expected".to_owned()) }
            };
            spread(&mut self.state, &read(state)?, rows)?;
            if let Some(at) = action {
                spread(&mut self.action, &read(at)?, rows)?;
            }
            if let Some(at) = stamp {
                self.stamp.extend(one(read(at)?)?);
            }
            let whole = |values: Vec<f64>| values.into_iter().map(|value| value as i64);
            if let Some(at) = episode {
                self.episode.extend(whole(one(read(at)?)?));
            }
            if let Some(at) = frame {
                self.frame.extend(whole(one(read(at)?)?));
            }
        }
        Ok(())
    }

    fn into_source(self, path: &Path, info: &Info) -> Result<Source, String> {
        let samples = self.state.first().map_or(0, Vec::len);
        if samples < 2 {
            return Err(format!("{samples} frames with a state, expected at least 2"));
        }
        let mut source = Source::new(path.to_path_buf(), Format::LeRobot);
        let (t_s, episodes) = self.stamps(samples, info)?;
        source.clocks.push(t_s);
        source.notes.extend(of_episodes(&episodes));
        let width = self.state.len();
        let names: Vec<String> = match info.state.len() == width {
            true => info.state.clone(),
            false => (1..=width).map(|k| format!("joint{k}")).collect(),
        };
        if info.state.len() != width {
            source.notes.push("no name for each number of observation.state: joint1 ... as they stand".to_owned());
        }
        let scales = scales(&names, &self.state, info.robot.as_deref(), &mut source.notes);
        let asked: Vec<Option<usize>> = (0..self.action.len())
            .map(|k| match info.action.get(k).and_then(|name| names.iter().position(|other| other == name)) {
                Some(joint) => Some(joint),
                None if self.action.len() == width && info.action.len() != self.action.len() => Some(k),
                None => None,
            })
            .collect();
        let spec = |theirs: &str, joint: usize| {
            scales[joint].map(|unit| ColumnSpec { unit: Some(unit), ..ColumnSpec::named(theirs) })
        };
        let mut add = |ours: Option<String>, theirs: String, joint: Option<usize>, values: Vec<f64>| {
            let spec = joint.and_then(|joint| spec(&theirs, joint));
            source.channels.push(Channel { ours, theirs, clock: 0, values, cell: None, spec });
        };
        for (k, values) in self.state.into_iter().enumerate() {
            add(Some(format!("{}.q", names[k])), format!("{STATE}.{}", names[k]), Some(k), values);
        }
        for (k, values) in self.action.into_iter().enumerate().filter(|(_, values)| values.len() == samples) {
            let joint = asked[k];
            let theirs = joint.map_or_else(|| format!("{ACTION}[{k}]"), |joint| format!("{ACTION}.{}", names[joint]));
            add(joint.map(|joint| format!("{}.q_ref", names[joint])), theirs, joint, values);
        }
        Ok(source)
    }

    /// Stamps along all episodes, and when each begins.
    fn stamps(&self, samples: usize, info: &Info) -> Result<(Vec<f64>, Vec<f64>), String> {
        let has = |count: usize| count == samples;
        let own = |k: usize| match info.fps {
            // A stamp in single precision is not as good as the count of frames.
            Some(fps) if has(self.frame.len()) => Some(self.frame[k] as f64 / fps),
            _ => self.stamp.get(k).copied().filter(|_| has(self.stamp.len())),
        };
        let (mut t_s, mut episodes, mut start_s) = (Vec::with_capacity(samples), Vec::new(), 0.0);
        for k in 0..samples {
            let own_s = own(k).ok_or("no column `timestamp`, and no `frame_index` with `fps` in meta/info.json")?;
            let before = k.checked_sub(1).and_then(own);
            let is_next = k > 0
                && (has(self.episode.len()) && self.episode[k] != self.episode[k - 1]
                    || before.is_some_and(|before| own_s < before));
            if is_next {
                // Between two frames: no frame is lost there.
                let frame_s = if k > 1 { t_s[k - 1] - t_s[k - 2] } else { BREAK_S };
                let break_s = ((BREAK_S / frame_s).round() + 0.5) * frame_s;
                start_s = t_s[k - 1] + break_s - own_s;
            }
            let stamp = start_s + own_s;
            if t_s.last().is_some_and(|last| !(stamp > *last)) || !stamp.is_finite() {
                return Err(format!("frame {k}: its stamp {own_s} s does not come after the one before"));
            }
            if k == 0 || is_next {
                episodes.push(stamp);
            }
            t_s.push(stamp);
        }
        Ok((t_s, episodes))
    }
}

/// What is said of several episodes: when they begin, as `from` and `to` of a study take one. In the hole before each a tenth
/// of a second is nothing.
fn of_episodes(begin_s: &[f64]) -> Option<String> {
    let times: Vec<String> =
        begin_s.iter().take(TOLD_EPISODES).map(|s| format!("{}", (10.0 * s).floor() / 10.0)).collect();
    let more = if begin_s.len() > TOLD_EPISODES { ", ..." } else { "" };
    (begin_s.len() > 1).then(|| {
        format!(
            "{} episodes, one after the other with a hole of {BREAK_S} s between them; they begin at {}{more} s",
            begin_s.len(),
            times.join(", ")
        )
    })
}

/// The unit of each joint, where it is not radians, and a note on how that was told.
fn scales(names: &[String], state: &[Vec<f64>], robot: Option<&str>, notes: &mut Vec<String>) -> Vec<Option<Unit>> {
    let most = |values: &Vec<f64>| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let is_gripper = |k: usize| {
        let name = names[k].to_lowercase();
        let word = ["gripper", "jaw", "finger"].iter().any(|word| name.contains(word));
        word && state[k].iter().all(|value| (-1.0..=101.0).contains(value)) && most(&state[k]) > TAU
    };
    let of = robot.map_or_else(String::new, |robot| format!(" ({robot})"));
    let wide: Vec<usize> = (0..names.len()).filter(|k| !is_gripper(*k) && most(&state[*k]) > WIDEST_RAD).collect();
    // Whatever they do, LeRobot never writes radians of these.
    let never_in_radians = robot.is_some_and(|robot| {
        let plain: String = robot.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect();
        IN_DEGREES.iter().any(|known| plain.contains(known))
    });
    let why = if wide.is_empty() { "LeRobot writes those of this robot so" } else { "they go beyond 4 pi" };
    let are_degrees = never_in_radians || !wide.is_empty();
    if are_degrees {
        notes.push(format!("angles{of} are taken to be degrees: {why} (a range from -100 to 100 would look the same; [columns] can say so)"));
    }
    let degrees = Some(Unit::Angle(TAU / 360.0));
    (0..names.len())
        .map(|k| {
            if is_gripper(k) {
                notes.push(format!("{}: 0 to 100 of its range, read as if 100 were 100 degrees (a guess; say per_rev and zero in [columns])", names[k]));
                Some(Unit::Ticks { per_rev: 360.0 })
            } else if are_degrees {
                degrees
            } else {
                None
            }
        })
        .collect()
}

/// Adds rows of so many numbers each to columns.
fn spread(columns: &mut Vec<Vec<f64>>, values: &[f64], rows: usize) -> Result<(), String> {
    if rows == 0 {
        return Ok(());
    }
    let width = values.len() / rows;
    if columns.is_empty() {
        columns.resize(width, Vec::new());
    }
    if columns.len() != width || width == 0 {
        return Err(format!("rows of {width} numbers after rows of {}", columns.len()));
    }
    for row in values.chunks_exact(width) {
        columns.iter_mut().zip(row).for_each(|(column, value)| column.push(*value));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn episodes_are_told_by_when_they_begin() {
        assert_eq!(of_episodes(&[0.0]), None);
        let told = of_episodes(&[0.0, 21.0667, 40.0]).unwrap();
        assert!(told.starts_with("3 episodes") && told.ends_with("begin at 0, 21, 40 s"), "{told}");
        let many: Vec<f64> = (0..100).map(f64::from).collect();
        assert!(of_episodes(&many).unwrap().ends_with("39, ... s"));
    }

    #[test]
    fn small_motions_of_an_arm_that_has_no_radians_are_degrees() {
        let read = |robot: Option<&str>| {
            let mut notes = Vec::new();
            let scales = scales(&["elbow".to_owned()], &[vec![-12.0, 12.0]], robot, &mut notes);
            (scales[0].is_some(), notes.iter().any(|note| note.contains("degrees")))
        };
        assert_eq!(read(Some("SO-101 follower")), (true, true));
        assert_eq!(read(Some("ur10e")), (false, false));
        assert_eq!(read(None), (false, false));
    }
}
