//! Studies whose text and logs are at hand, as in a program that has just recorded them: no file is read but those that the
//! study names beside them.

use std::path::Path;

use super::clamped_study::{ClampedStudy, clamped_study_of, within};
use super::column::column_of;
use super::columns::Columns;
use super::document::Document;
use super::error::LogError;
use super::format::Format;
use super::inputs::check_inputs;
use super::plausible::{check_period, check_stamps};
use super::read_log::{read_joint_of_study, read_robot_logs};
use super::robot_log::RobotLog;
use super::robot_study::{RobotStudy, StudyKind, kind_of, robot_study_of};
use super::source::{Channel, Source, Want, checked, joint_log, robot_log, tried};
use super::study::study_of;
use super::types::{Log, Study};
use super::window::Window;

/// A study with its logs, in its order.
#[derive(Clone, Debug)]
pub enum StudyAtHand {
    /// Of one joint.
    Joint(Box<Study>, Vec<Log>),
    /// Of a robot with a clamped base.
    Clamped(Box<ClampedStudy>, Vec<RobotLog>),
    /// Of a robot that walks, drops or hangs.
    Robot(Box<RobotStudy>, Vec<RobotLog>),
}

/// Reads a study from its text. A `[[log]] file` that is the name of one of these logs is that log, any other is a file.
/// Other files are named relative to the folder of `name`, which need not be there itself.
///
/// # Errors
/// [`LogError`] as of a study in a file.
pub fn read_at_hand(name: &Path, text: &str, logs: &[Source]) -> Result<StudyAtHand, LogError> {
    let names = logs.iter().map(|log| log.file.display().to_string());
    let document = Document::of_text(name, text).with_logs(names);
    Ok(match kind_of(&document) {
        StudyKind::Joint => {
            let study = study_of(&document)?;
            let of_joint = |source: Source| {
                let joint = study.joint.name.as_str();
                let named = source.joints().contains(&Some(joint)).then_some(joint);
                joint_log(source, named)
            };
            let mut read = Vec::with_capacity(study.logs.len());
            for (i, entry) in study.logs.iter().enumerate() {
                let log = match at_hand(logs, Window::file(entry.window.as_ref(), &entry.file), &study.columns)? {
                    Some(source) => of_joint(source)?,
                    None => read_joint_of_study(&entry.path, &study.columns, &study.joint.name)?,
                };
                check_period(&log, &study.sensor)?;
                let log = check_inputs(&study.file, i, entry, log)?;
                read.push(log.within(entry.window.as_ref(), (&study.file, i))?);
            }
            StudyAtHand::Joint(Box::new(study), read)
        }
        StudyKind::Clamped => {
            let study = clamped_study_of(&document)?;
            let entries =
                study.logs.iter().map(|entry| (Window::file(entry.window.as_ref(), &entry.file), entry.path.as_path()));
            let read = within(&study, robot_logs(logs, entries, &study.columns, study.sensor.period_s)?)?;
            StudyAtHand::Clamped(Box::new(study), read)
        }
        StudyKind::Robot => {
            let study = robot_study_of(&document)?;
            let entries = study.logs.iter().map(|entry| (entry.file.as_str(), entry.path.as_path()));
            let read = robot_logs(logs, entries, &study.columns, study.sensor.period_s)?;
            StudyAtHand::Robot(Box::new(study), read)
        }
    })
}

/// The log with this name, by what `[columns]` says of it.
fn at_hand(logs: &[Source], name: &str, columns: &Columns) -> Result<Option<Source>, LogError> {
    let Some(found) = logs.iter().find(|log| log.file.as_os_str() == name) else { return Ok(None) };
    let read = |columns: &Columns| checked(found.clone(), Want::Any, columns);
    read(columns).map(Some).map_err(|error| tried(error, columns, read))
}

fn robot_logs<'a>(
    logs: &[Source],
    entries: impl Iterator<Item = (&'a str, &'a Path)>,
    columns: &Columns,
    period_s: Option<f64>,
) -> Result<Vec<RobotLog>, LogError> {
    let mut read = Vec::new();
    for (file, path) in entries {
        match at_hand(logs, file, columns)? {
            Some(source) => {
                let log = robot_log(source)?;
                period_s.map_or(Ok(()), |period_s| check_stamps(&log.file, &log.t_s, period_s))?;
                read.push(log);
            }
            None => read.extend(read_robot_logs(&[path], columns, period_s)?),
        }
    }
    Ok(read)
}

impl Source {
    /// A log of arrays. `columns` are `q`, `q_ref`, `tau`, `dq`, `drive`, of several joints with the joint's name before
    /// (`elbow.q`), or what `[columns]` of a study calls them: name, which of the `clocks_s` stamps it, values.
    ///
    /// ```
    /// use aibo_fit::log::Source;
    /// let mut log = Source::of_arrays("swing", vec![vec![0.0, 0.01]], vec![("q".to_owned(), 0, vec![0.1, 0.2])])?;
    /// assert_eq!(log.take_joint_log(None)?.q_rad, [0.1, 0.2]);
    /// # Ok::<(), aibo_fit::log::LogError>(())
    /// ```
    ///
    /// # Errors
    /// [`LogError::Format`] where an array is not as long as its stamps.
    pub fn of_arrays(
        name: &str,
        clocks_s: Vec<Vec<f64>>,
        columns: Vec<(String, usize, Vec<f64>)>,
    ) -> Result<Self, LogError> {
        let mut source = Self::new(name.into(), Format::Arrays);
        source.clocks = clocks_s;
        for (column, clock, values) in columns {
            let expected = source.clocks.get(clock).map_or(0, Vec::len);
            if values.len() != expected {
                let what =
                    format!("`{column}`: {} values, expected {expected}, as many as it has stamps", values.len());
                return Err(LogError::Format { file: source.file, format: Format::Arrays, what });
            }
            let ours = column_of(&column).map(|_| column.clone());
            if ours.is_none() {
                source.ignored.push(column.clone());
            }
            source.channels.push(Channel { ours, theirs: column, clock, values, cell: None, spec: None });
        }
        Ok(source)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STUDY: &str = "schema = 1\n[joint]\nname = \"hip\"\ninertia = 4e-3\nmoment = 0.03\ncoulomb = 1e-3\nviscous = 0.017\n\
                         [columns]\nq = { name = \"angle\", unit = \"deg\" }\n\
                         [[log]]\nfile = \"swing\"\nrole = \"fit\"\ndrive = \"off\"\n";

    fn swing(column: &str, samples: usize) -> Source {
        let t: Vec<f64> = (0..100).map(|k| 0.01 * f64::from(k)).collect();
        let q = t.iter().take(samples).map(|t| 30.0 * (5.0 * t).cos()).collect();
        Source::of_arrays("swing", vec![t], vec![(column.to_owned(), 0, q)]).unwrap()
    }

    #[test]
    fn arrays_are_the_logs_that_a_text_names_in_its_units() {
        let StudyAtHand::Joint(study, logs) = read_at_hand("study".as_ref(), STUDY, &[swing("angle", 100)]).unwrap()
        else {
            panic!("a joint")
        };
        assert_eq!((study.logs[0].file.as_str(), logs.len()), ("swing", 1));
        assert!((logs[0].q_rad[0] - 30f64.to_radians()).abs() < 1e-12);
    }

    #[test]
    fn what_is_wrong_with_arrays_is_said_as_of_files() {
        let short = Source::of_arrays("swing", vec![vec![0.0, 0.1]], vec![("q".to_owned(), 0, vec![0.0])]);
        assert!(short.unwrap_err().to_string().contains("`q`: 1 values, expected 2"));
        // Not even our own name stands in for the one that is said.
        for name in ["position", "q"] {
            let other = read_at_hand("study".as_ref(), STUDY, &[swing(name, 100)]).unwrap_err().to_string();
            assert!(other.contains("`q` is `angle` here"), "{other}");
        }
        let absent = read_at_hand("study".as_ref(), STUDY, &[]).unwrap_err().to_string();
        assert!(absent.contains("swing") && absent.contains("[[log]] 1 file"), "{absent}");
        let mut falls = swing("angle", 100);
        falls.clocks[0][7] = 0.0;
        let falls = read_at_hand("study".as_ref(), STUDY, &[falls]).unwrap_err().to_string();
        assert!(falls.contains("do not rise"), "{falls}");
    }
}
