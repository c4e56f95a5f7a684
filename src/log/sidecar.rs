//! What stands beside a log under its name: a sidecar, or a study.

use std::path::{Path, PathBuf};

use super::columns::Columns;
use super::document::Document;
use super::error::LogError;
use super::raw_columns::study_columns;
use super::robot_study::{StudyKind, kind_of};
use super::schema::RawStudy;

/// The file `NAME.toml` beside a log `NAME.csv`, where there is one.
pub(crate) fn sidecar_of(log: &Path) -> Option<PathBuf> {
    let sidecar = log.with_extension("toml");
    (sidecar != log && sidecar.is_file()).then_some(sidecar)
}

/// What the sidecar `NAME.toml` beside a log `NAME.csv` says of its columns; nothing where there is none.
///
/// # Errors
/// As [`study_columns`], and where it has a key that no sidecar has. A study, a robot or a gait may have the log's name: their
/// other keys are for their readers to check.
pub fn sidecar_columns(log: &Path) -> Result<Columns, LogError> {
    let Some(sidecar) = sidecar_of(log) else { return Ok(Columns::default()) };
    let columns = study_columns(&sidecar)?;
    if tables_of(log).is_some() {
        let _all_are_known: RawStudy = Document::open(&sidecar)?.parse_any()?;
    }
    Ok(columns)
}

/// Tables of a log's sidecar; `None` where there is none, or one that is about something else than the log: a study, or a robot
/// with its parts or its gait.
fn tables_of(log: &Path) -> Option<toml::Table> {
    const OF_ROBOTS: [&str; 4] = ["robot", "part", "wave", "truth"];
    let sidecar = sidecar_of(log)?;
    let document = Document::open(&sidecar).ok()?;
    let tables: toml::Table = toml::from_str(document.text()).ok()?;
    let is_of_robot = OF_ROBOTS.iter().any(|key| tables.contains_key(*key));
    (!is_of_robot && study_beside(log).is_none()).then_some(tables)
}

/// Tables of a log's sidecar of which who takes its [`sidecar_columns`] alone takes nothing, as they are written; none of a study
/// that has the log's name, and none where there is no sidecar.
pub fn beside_columns(log: &Path) -> Vec<String> {
    const TAKEN: [&str; 3] = ["schema", "about", "columns"];
    let written = |(key, value): (&String, &toml::Value)| match value {
        toml::Value::Array(_) => format!("[[{key}]]"),
        _ => format!("[{key}]"),
    };
    let tables = tables_of(log).unwrap_or_default();
    tables.iter().filter(|(key, _)| !TAKEN.contains(&key.as_str())).map(written).collect()
}

/// The kind of study that stands in the place of a log's sidecar: it is about a joint or a robot, and names logs.
pub(crate) fn study_beside(log: &Path) -> Option<StudyKind> {
    let sidecar = sidecar_of(log)?;
    let document = Document::open(&sidecar).ok()?;
    let table: toml::Table = toml::from_str(document.text()).ok()?;
    let names_logs = table.get("log")?.as_array()?.iter().any(|log| log.get("file").is_some());
    let is_about = ["joint", "robot"].iter().any(|subject| table.contains_key(*subject));
    (names_logs && is_about).then(|| kind_of(&document))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Only `[columns]` was looked at, whatever else stood there.
    #[test]
    fn a_sidecar_has_known_keys_and_those_beside_columns_are_told() {
        let dir = tempfile::tempdir().unwrap();
        let log = dir.path().join("swing.csv");
        let read = |text: &str| {
            std::fs::write(log.with_extension("toml"), text).unwrap();
            (sidecar_columns(&log).map_err(|error| error.to_string()), beside_columns(&log))
        };
        let told = "schema = 1\n[columns]\nq = { name = \"angle\" }\n";
        let (columns, beside) = read(told);
        assert_eq!((columns.unwrap().toml().as_str(), beside.len()), ("[columns]\nq = { name = \"angle\" }\n", 0));
        let (columns, beside) = read(&format!("{told}[release]\ntime = 0.1\n[[log]]\ndrive = \"off\"\n"));
        assert_eq!(columns.map(|columns| columns.0.len()), Ok(1));
        assert_eq!(beside.len(), 2);
        assert!(beside.contains(&"[release]".to_owned()) && beside.contains(&"[[log]]".to_owned()), "{beside:?}");
        for (text, key) in [("[relase]\ntime = 0.1\n", "relase"), ("[release]\ntme = 0.1\n", "tme")] {
            let error = read(&format!("{told}{text}")).0.unwrap_err();
            assert!(error.contains("swing.toml") && error.contains(key) && error.contains("line "), "{error}");
        }
        // Studies, robots and gaits have tables of their own.
        for other in [
            "[robot]\nscenario = \"fixed\"\n[joints.a]\nkp = 1.0\n[[log]]\nfile = \"swing.csv\"\n",
            "root = \"trunk\"\nbase = \"free\"\n[[part]]\nname = \"trunk\"\n",
            "stand_s = 1.0\nwalk_s = 2.0\n[[wave]]\njoint = \"a\"\n",
        ] {
            let (columns, beside) = read(other);
            assert_eq!((columns.map(|columns| columns.0.len()), beside), (Ok(0), Vec::new()), "{other}");
        }
    }

    #[test]
    fn a_study_that_has_the_name_of_a_log_is_told_from_its_sidecar() {
        let dir = tempfile::tempdir().unwrap();
        let log = dir.path().join("swing.csv");
        assert_eq!((sidecar_of(&log), study_beside(&log)), (None, None));
        for (text, expected) in [
            ("schema = 1\n[columns]\nq = { name = \"angle\" }\n", None),
            ("[joint]\nname = \"hip\"\n[[log]]\ndrive = \"off\"\n", None),
            ("[[log]]\nfile = \"swing.csv\"\n", None),
            ("[joint]\nname = \"hip\"\n[[log]]\nfile = \"swing.csv\"\n", Some(StudyKind::Joint)),
            ("[robot]\nscenario = \"fixed\"\n[[log]]\nfile = \"swing.csv\"\n", Some(StudyKind::Clamped)),
            ("no TOML", None),
        ] {
            std::fs::write(log.with_extension("toml"), text).unwrap();
            assert_eq!(study_beside(&log), expected, "{text}");
        }
        assert_eq!(sidecar_of(&log), Some(log.with_extension("toml")));
        assert_eq!(sidecar_of(&log.with_extension("toml")), None);
    }
}
