//! What stands beside a log under its name: a sidecar, or a study.

use std::path::{Path, PathBuf};

use super::columns::Columns;
use super::document::Document;
use super::error::LogError;
use super::raw_columns::study_columns;
use super::robot_study::{StudyKind, kind_of};

/// The file `NAME.toml` beside a log `NAME.csv`, where there is one.
pub(crate) fn sidecar_of(log: &Path) -> Option<PathBuf> {
    let sidecar = log.with_extension("toml");
    (sidecar != log && sidecar.is_file()).then_some(sidecar)
}

/// What the sidecar `NAME.toml` beside a log `NAME.csv` says of its columns; nothing where there is none.
///
/// # Errors
/// As [`study_columns`].
pub fn sidecar_columns(log: &Path) -> Result<Columns, LogError> {
    sidecar_of(log).map_or_else(|| Ok(Columns::default()), |sidecar| study_columns(&sidecar))
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
