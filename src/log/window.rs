//! The part of a log that a study takes: of one recording a part may be fitted, and another held out.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::document::{Document, FINITE, Number};
use super::error::LogError;
use super::robot_log::{JointColumns, RobotLog};
use super::types::Log;

/// Keys `from` and `to` of a `[[log]]`: the samples of a log from one time until before another, so that parts may adjoin.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// The log, as written in the study.
    pub of: String,
    /// The first time \[s\] on the log's clock; `None`: its beginning.
    pub from_s: Option<f64>,
    /// The first time after it \[s\]; `None`: to the log's end.
    pub to_s: Option<f64>,
}

impl Window {
    /// What a `[[log]]` says of it; `table` names that.
    pub(super) fn read(
        document: &Document<'_>,
        table: &str,
        file: &str,
        [from, to]: [&Number; 2],
    ) -> Result<Option<Self>, LogError> {
        let from_s = document.number(&format!("{table} from"), from, FINITE)?;
        let to_s = document.number(&format!("{table} to"), to, FINITE)?;
        if let (Some(from_s), Some(to_s), Some(spanned)) = (from_s, to_s, to)
            && to_s <= from_s
        {
            let expected = format!("a time after `from`, {from_s} s");
            return Err(document.wrong(&format!("{table} to"), spanned.span(), to_s.to_string(), &expected));
        }
        let is_whole = from_s.is_none() && to_s.is_none();
        Ok((!is_whole).then(|| Self { of: file.to_owned(), from_s, to_s }))
    }

    /// The file as a study names it, which reports call so.
    pub(super) fn file<'a>(window: Option<&'a Self>, log: &'a str) -> &'a str {
        window.map_or(log, |window| &window.of)
    }

    /// What reports call it.
    pub(super) fn label(&self) -> String {
        match (self.from_s, self.to_s) {
            (Some(from), Some(to)) => format!("{} ({from} to {to} s)", self.of),
            (Some(from), None) => format!("{} (from {from} s)", self.of),
            (None, to) => format!("{} (to {} s)", self.of, to.unwrap_or(f64::INFINITY)),
        }
    }

    /// From when to when \[s\].
    fn ends_s(&self) -> [f64; 2] {
        [self.from_s.unwrap_or(f64::NEG_INFINITY), self.to_s.unwrap_or(f64::INFINITY)]
    }

    /// The samples of a log that it takes; `study` and `entry`, from 0, say whose it is.
    fn samples(&self, t_s: &[f64], (study, entry): (&Path, usize)) -> Result<Range<usize>, LogError> {
        let [from_s, to_s] = self.ends_s();
        let range = t_s.partition_point(|t| *t < from_s)..t_s.partition_point(|t| *t < to_s);
        if range.len() >= 2 {
            return Ok(range);
        }
        Err(LogError::EmptyWindow {
            study: study.into(),
            entry: entry + 1,
            log: self.label(),
            samples: range.len(),
            begins_s: t_s.first().copied().unwrap_or_default(),
            ends_s: t_s.last().copied().unwrap_or_default(),
        })
    }
}

/// Whether two parts of one log, `None`: all of it, have samples in common.
pub(super) fn overlap(one: Option<&Window>, other: Option<&Window>) -> bool {
    let ends = |window: Option<&Window>| window.map_or([f64::NEG_INFINITY, f64::INFINITY], Window::ends_s);
    let ([from, to], [other_from, other_to]) = (ends(one), ends(other));
    from.max(other_from) < to.min(other_to)
}

impl Log {
    /// The part of it that a study takes.
    pub(super) fn within(self, window: Option<&Window>, whose: (&Path, usize)) -> Result<Self, LogError> {
        let Some(window) = window else { return Ok(self) };
        let range = window.samples(&self.t_s, whose)?;
        let of = |column: Vec<f64>| column[range.clone()].to_vec();
        Ok(Self {
            file: PathBuf::from(window.label()),
            t_s: of(self.t_s),
            q_rad: of(self.q_rad),
            dq_rad_s: self.dq_rad_s.map(of),
            tau_nm: self.tau_nm.map(of),
            q_ref_rad: self.q_ref_rad.map(of),
            drive: self.drive.map(|on| on[range.clone()].to_vec()),
            ..self
        })
    }
}

impl RobotLog {
    /// The part of it that a study takes.
    pub(super) fn within(self, window: Option<&Window>, whose: (&Path, usize)) -> Result<Self, LogError> {
        let Some(window) = window else { return Ok(self) };
        let range = window.samples(&self.t_s, whose)?;
        let part = self.part(range);
        let (ignored_columns, notes) = (self.ignored_columns, self.notes);
        Ok(Self { file: PathBuf::from(window.label()), ignored_columns, notes, ..part })
    }

    /// Some of the samples of a log whose base is clamped; setpoints at stamps of their own stay, the last one before the
    /// part is in force at its beginning.
    pub(crate) fn part(&self, samples: Range<usize>) -> Self {
        let of = |column: &Vec<f64>| column[samples.clone()].to_vec();
        let joint = |joint: &JointColumns| JointColumns {
            name: joint.name.clone(),
            q_rad: of(&joint.q_rad),
            q_ref_rad: joint.q_ref_rad.as_ref().map(of),
            setpoints: joint.setpoints.clone(),
            tau_nm: joint.tau_nm.as_ref().map(of),
            drive: joint.drive.as_ref().map(|on| on[samples.clone()].to_vec()),
        };
        Self {
            file: self.file.clone(),
            t_s: of(&self.t_s),
            joints: self.joints.iter().map(joint).collect(),
            // A base that is clamped stands still.
            base: None,
            acceleration_m_s2: None,
            ignored_columns: Vec::new(),
            notes: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{read_clamped_study, read_clamped_study_logs, read_study, read_study_logs, study_text};

    const JOINT: &str =
        "schema = 1\n[joint]\nname = \"hip\"\ninertia = 4e-3\nmoment = 0.03\ncoulomb = 1e-3\nviscous = 0.017\n";
    const ARM: &str = "schema = 1\n[robot]\nmodel = \"arm.urdf\"\nscenario = \"fixed\"\n";

    /// A study beside a log of ten seconds at 10 Hz.
    fn study(beliefs: &str, logs: &[&str]) -> tempfile::TempDir {
        let dir = tempfile::tempdir().unwrap();
        let rows = (0..100).map(|k| format!("{:.1},{}\n", 0.1 * f64::from(k), 0.01 * f64::from(k)));
        let head = if beliefs == JOINT { "t,q\n" } else { "t,hip.q\n" };
        std::fs::write(dir.path().join("log.csv"), rows.fold(head.to_owned(), |text, row| text + &row)).unwrap();
        let entry = |keys: &&str| format!("[[log]]\nfile = \"log.csv\"\nrole = \"fit\"\ndrive = \"off\"\n{keys}\n");
        std::fs::write(dir.path().join("study.toml"), beliefs.to_owned() + &logs.iter().map(entry).collect::<String>())
            .unwrap();
        dir
    }

    #[test]
    fn parts_of_one_log_are_logs() {
        let dir = study(JOINT, &["to = 4", "from = 4.0\nto = 9", "from = 9"]);
        let read = read_study(&dir.path().join("study.toml")).unwrap();
        let logs = read_study_logs(&read).unwrap();
        assert_eq!(logs.iter().map(Log::len).collect::<Vec<_>>(), [40, 50, 10]);
        assert_eq!((logs[1].t_s[0], logs[1].q_rad[0]), (4.0, 0.4));
        let files: Vec<&str> = read.logs.iter().map(|log| log.file.as_str()).collect();
        assert_eq!(files, ["log.csv (to 4 s)", "log.csv (4 to 9 s)", "log.csv (from 9 s)"]);
        std::fs::write(dir.path().join("again.toml"), study_text(&read)).unwrap();
        assert_eq!(read_study(&dir.path().join("again.toml")).unwrap().logs, read.logs);
        let dir = study(ARM, &["to = 4", "from = 4"]);
        let read = read_clamped_study(&dir.path().join("study.toml")).unwrap();
        let logs = read_clamped_study_logs(&read).unwrap();
        assert_eq!(logs.iter().map(RobotLog::len).collect::<Vec<_>>(), [40, 60]);
        assert_eq!(logs[1].file, PathBuf::from("log.csv (from 4 s)"));
    }

    #[test]
    fn parts_that_overlap_or_have_no_samples_are_refused() {
        for (logs, parts) in [
            (&["to = 4", "from = 3"][..], ["[[log]] 2 file", "which is also [[log]] 1"]),
            (&["", "from = 3"], ["[[log]] 2 file", "which is also [[log]] 1"]),
            (&["from = 4\nto = 4"], ["[[log]] 1 to", "a time after `from`, 4 s"]),
            (&["to = inf"], ["[[log]] 1 to", "finite"]),
            (&["to = 5", "from = 20"], ["[[log]] 2 from, to: 0 samples in log.csv (from 20 s)", "from 0 to 9.9 s"]),
        ] {
            for beliefs in [JOINT, ARM] {
                let dir = study(beliefs, logs);
                let path = dir.path().join("study.toml");
                let error = if beliefs == JOINT {
                    read_study(&path).and_then(|study| read_study_logs(&study)).unwrap_err()
                } else {
                    read_clamped_study(&path).and_then(|study| read_clamped_study_logs(&study)).unwrap_err()
                };
                parts.iter().for_each(|part| assert!(error.to_string().contains(part), "{error}"));
            }
        }
    }
}
