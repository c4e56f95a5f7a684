//! Of which robot a study is, and of which day a log.

use super::find::Found;
use crate::log::{About, Columns, Day, read_about, read_source, study_columns};
use crate::report::DayFrom;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::time::UNIX_EPOCH;

/// The robot: as `[about]` says, else the first folder below the pattern's fixed part that has no day in its name, else,
/// of a study of a robot, what its description calls it.
pub(super) fn robot(found: &Found, document: Option<&Value>) -> Option<String> {
    let of_study = read_about(&found.path).unwrap_or_default().robot;
    let of_folder = || folders(found).into_iter().find(|name| Day::find(name).is_none());
    let of_description = || {
        let document = document?;
        let is_robot = document.get("joints").is_some() || document.get("scenario").is_some();
        document["name"].as_str().filter(|name| is_robot && !name.is_empty()).map(str::to_owned)
    };
    of_study.or_else(of_folder).or_else(of_description)
}

/// Days of all logs that a diagnosis tells of.
pub(super) fn days(found: &Found, document: &Value) -> BTreeMap<String, (Day, DayFrom)> {
    let about = read_about(&found.path).unwrap_or_default();
    let columns = study_columns(&found.path).unwrap_or_default();
    let mut logs = BTreeSet::new();
    logs_of(document, &mut logs);
    for joint in document["joints"].as_object().into_iter().flat_map(|joints| joints.values()) {
        logs_of(joint, &mut logs);
    }
    logs.into_iter().filter_map(|log| Some((log.to_owned(), day(found, &about, &columns, log)?))).collect()
}

fn logs_of<'a>(document: &'a Value, logs: &mut BTreeSet<&'a str>) {
    logs.extend(document["gap"]["per_log"].as_array().into_iter().flatten().filter_map(|log| log["file"].as_str()));
}

/// As `[about]` says, else as the log's name or a folder's has it, the innermost first, else by the log's own stamps, else
/// by when its file was last written.
fn day(found: &Found, about: &About, columns: &Columns, log: &str) -> Option<(Day, DayFrom)> {
    let path = found.path.parent().unwrap_or(Path::new("")).join(log);
    let of_path = || {
        let names = path.strip_prefix(&found.base).unwrap_or(&path).components().rev();
        names.into_iter().find_map(|name| Day::find(&name.as_os_str().to_string_lossy()))
    };
    let of_stamps = || read_source(&path, columns).ok()?.day();
    let of_file = || {
        let written = fs::metadata(&path).ok()?.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
        Day::of_epoch_s(written.as_secs_f64())
    };
    let told = |day: Option<Day>, from: DayFrom| day.map(|day| (day, from));
    told(about.day, DayFrom::Study)
        .or_else(|| told(of_path(), DayFrom::Path))
        .or_else(|| told(of_stamps(), DayFrom::Stamps))
        .or_else(|| told(of_file(), DayFrom::File))
}

/// Names of the folders between the pattern's fixed part and the study.
fn folders(found: &Found) -> Vec<String> {
    let inside = found.path.parent().and_then(|folder| folder.strip_prefix(&found.base).ok());
    let names = inside.into_iter().flat_map(Path::components);
    names.map(|name| name.as_os_str().to_string_lossy().into_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn found(dir: &Path, study: &str, text: &str) -> Found {
        let path = dir.join(study);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, text).unwrap();
        Found { path, base: dir.to_path_buf() }
    }

    #[test]
    fn a_robot_is_named_by_its_study_its_folder_or_its_description() {
        let dir = tempfile::tempdir().unwrap();
        let arm = json!({ "name": "arm", "joints": {} });
        let stated = found(dir.path(), "dog-07/a/study.toml", "[about]\nrobot = 'dog 7'\n");
        assert_eq!(robot(&stated, Some(&arm)).as_deref(), Some("dog 7"));
        let filed = found(dir.path(), "2026-03-01/dog-07/study.toml", "");
        assert_eq!(robot(&filed, Some(&arm)).as_deref(), Some("dog-07"));
        let alone = found(dir.path(), "study.toml", "");
        assert_eq!(robot(&alone, Some(&arm)).as_deref(), Some("arm"));
        assert_eq!(robot(&alone, Some(&json!({ "name": "knee" }))), None);
    }

    #[test]
    fn a_log_has_the_day_of_its_study_its_path_its_stamps_or_its_file() {
        let dir = tempfile::tempdir().unwrap();
        let document = json!({ "gap": { "per_log": [{ "file": "log.csv" }] } });
        let told = |found: &Found| days(found, &document)["log.csv"];
        let day = Day::parse("2026-03-01").unwrap();
        let stated = found(dir.path(), "2025-01-01/study.toml", "[about]\nday = '2026-03-01'\n");
        assert_eq!(told(&stated), (day, DayFrom::Study));
        let filed = found(dir.path(), "dog/2026-03-01/run/study.toml", "");
        assert_eq!(told(&filed), (day, DayFrom::Path));
        let stamped = found(dir.path(), "dog/study.toml", "");
        let row = |i: i32| format!("{:.2},{:.3}", 1_772_323_200.0 + 0.01 * f64::from(i), 0.01 * f64::from(i));
        let rows: Vec<String> = (0..50).map(row).collect();
        fs::write(dir.path().join("dog/log.csv"), format!("t,q\n{}\n", rows.join("\n"))).unwrap();
        assert_eq!(told(&stamped), (day, DayFrom::Stamps));
        fs::write(dir.path().join("dog/log.csv"), "t,q\n0.0,0.1\n0.01,0.2\n").unwrap();
        assert_eq!(told(&stamped).1, DayFrom::File);
        fs::remove_file(dir.path().join("dog/log.csv")).unwrap();
        assert!(days(&stamped, &document).is_empty());
    }
}
