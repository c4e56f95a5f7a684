//! What is asked about: a study in a file, or in a text with arrays.

use crate::errors::Failed;
use aibo_fit::cli::CliError;
use aibo_fit::gap::clamped::ClampedSetup;
use aibo_fit::gap::robot::RobotCase;
use aibo_fit::identify::Case;
use aibo_fit::log::{Source, StudyAtHand, StudyKind, read_at_hand, study_kind};
use aibo_fit::report::{Provenance, draft_study};
use numpy::PyReadonlyArray1;
use std::path::{Path, PathBuf};

/// A log of arrays: its name, the stamps \[s\] of its clocks, and its columns, each with the number of its clock.
pub type Arrays<'py> = (String, Vec<PyReadonlyArray1<'py, f64>>, Vec<(String, usize, PyReadonlyArray1<'py, f64>)>);

/// A question from the Python half: a path, or a study as JSON with arrays, and a robot.
pub type Question<'py> = (Option<PathBuf>, Option<String>, Vec<Arrays<'py>>, Option<PathBuf>);

/// What errors call a study that is no file.
const NO_FILE: &str = "<study>";

/// A question, still in the interpreter's terms.
pub enum Asked {
    /// A study in a file.
    Study(PathBuf),
    /// A study's text, as a program would write it, with the logs that it names.
    Text { text: String, logs: Vec<Source> },
    /// A log and the robot whose it is.
    LogOf { log: PathBuf, robot: PathBuf },
}

/// A study with its logs.
pub enum Subject {
    /// One joint.
    Joint(Box<Case>),
    /// A robot with a clamped base.
    Clamped(Box<ClampedSetup>),
    /// A robot that walks, drops or hangs.
    Robot(Box<RobotCase>),
}

impl Asked {
    /// Takes the question out of the interpreter's hands.
    pub fn new((path, study, logs, robot): Question<'_>) -> Result<Self, Failed> {
        match (path, study, robot) {
            (Some(log), _, Some(robot)) => Ok(Self::LogOf { log, robot }),
            (Some(path), _, None) => Ok(Self::Study(path)),
            (None, study, _) => {
                let value: serde_json::Value = serde_json::from_str(study.as_deref().unwrap_or("{}"))?;
                let text = toml::to_string(&value).map_err(|error| format!("the study as TOML: {error}"))?;
                let logs = logs.into_iter().map(source).collect::<Result<_, _>>()?;
                Ok(Self::Text { text, logs })
            }
        }
    }

    /// What stands after the program's name in the command that asks the same.
    pub fn words(&self) -> String {
        match self {
            Self::Study(path) => path.display().to_string(),
            Self::Text { .. } => NO_FILE.to_owned(),
            Self::LogOf { log, robot } => format!("{} --robot {}", log.display(), robot.display()),
        }
    }

    /// Reads study and logs.
    pub fn read(&self) -> Result<Subject, Failed> {
        Ok(match self {
            Self::Study(path) => of_file(path)?,
            Self::Text { text, logs } => at_hand(text, logs)?,
            Self::LogOf { log, robot } => {
                let draft = draft_study(std::slice::from_ref(log), Some(robot), None, Path::new(""))?;
                at_hand(&draft.text, &[])?
            }
        })
    }
}

fn of_file(path: &Path) -> Result<Subject, Failed> {
    Ok(match study_kind(path).map_err(unread)? {
        StudyKind::Joint => Subject::Joint(Box::new(Case::of_study(path).map_err(unread)?)),
        StudyKind::Clamped => {
            let boxed = |error| unread(CliError::ClampedCase(Box::new(error)));
            Subject::Clamped(Box::new(ClampedSetup::read(path).map_err(boxed)?))
        }
        StudyKind::Robot => Subject::Robot(Box::new(RobotCase::of_study(path).map_err(unread)?)),
    })
}

/// Why a study in a file is not to be had; what cannot be read now may be later.
fn unread(error: impl Into<CliError>) -> Failed {
    let error = error.into();
    if error.is_io() { Failed::Unreadable(error.to_string()) } else { Failed::of(error) }
}

fn at_hand(text: &str, logs: &[Source]) -> Result<Subject, Failed> {
    Ok(match read_at_hand(Path::new(NO_FILE), text, logs)? {
        StudyAtHand::Joint(study, logs) => Subject::Joint(Box::new(Case::of_read(*study, logs)?)),
        StudyAtHand::Clamped(study, logs) => Subject::Clamped(Box::new(ClampedSetup::of_read(*study, logs)?)),
        StudyAtHand::Robot(study, logs) => Subject::Robot(Box::new(RobotCase::new(*study, logs)?)),
    })
}

fn source((name, clocks, columns): Arrays<'_>) -> Result<Source, Failed> {
    let copied = |array: &PyReadonlyArray1<'_, f64>| array.as_array().to_vec();
    let columns = columns.iter().map(|(name, clock, values)| (name.clone(), *clock, copied(values)));
    Ok(Source::of_arrays(&name, clocks.iter().map(copied).collect(), columns.collect())?)
}

/// Where an answer comes from; arrays are no files that could be hashed.
pub fn provenance(command: String, inputs: Vec<PathBuf>) -> Result<Provenance, Failed> {
    Ok(Provenance::of(command, inputs.into_iter().filter(|path| path.exists()))?)
}
