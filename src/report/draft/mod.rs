//! A study written from logs: everything that they show stands in it, guesses are marked as guesses, and what nobody can
//! see in a log is there as a comment that says what to weigh or look up.

mod beliefs;
mod joint;
mod match_joints;
mod robot;
mod seen;
mod shared;
#[cfg(test)]
mod tests;

use crate::log::LogError;
use crate::robot::description::{Description, DescriptionError};
use seen::{Seen, look};
use std::path::{Component, Path, PathBuf};

/// Joints told by name at the most.
const NAMED: usize = 12;

/// A study as `init` writes it.
#[derive(Clone, Debug)]
pub struct Draft {
    /// The TOML.
    pub text: String,
    /// What could not be told from the logs, in sentences.
    pub untold: Vec<String>,
    /// Keys to fill in before anything is asked of it.
    pub to_fill: Vec<&'static str>,
    /// Files that were read.
    pub inputs: Vec<PathBuf>,
}

/// Why no study can be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DraftError {
    /// A log cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The robot cannot be read.
    #[error(transparent)]
    Description(Box<DescriptionError>),
    /// A log does not have the joint that was asked for.
    #[error("{}: no joint `{joint}`; the log has {known}", file.display())]
    NoJoint {
        /// The log.
        file: PathBuf,
        /// The joint.
        joint: String,
        /// The joints that there are.
        known: String,
    },
    /// No joint of a log can be one of the robot's.
    #[error("{}: none of its joints ({found}) can be told to be one of the robot's ({known}); rename them, or map them in [columns]", file.display())]
    NoMatch {
        /// The log.
        file: PathBuf,
        /// Joints of the log.
        found: String,
        /// Joints of the robot.
        known: String,
    },
    /// Logs need different lines in `[columns]`.
    #[error(
        "{}: read with `{line}`, but {} with `{instead}`; a study has one [columns] for all its logs: make a study of each, let \
         their sidecars say the same, or write both down under our names with `aibo-fit convert`",
        file.display(),
        other.display()
    )]
    ColumnsDiffer {
        /// A log.
        file: PathBuf,
        /// The line that reads a column of it.
        line: String,
        /// Another log.
        other: PathBuf,
        /// What reads that column there.
        instead: String,
    },
}

/// Writes a study of logs: of a robot where its description is given, else of one joint, the named one or the one that
/// moves most. Paths in it are relative to `folder`.
///
/// # Errors
/// [`DraftError`] where a log or the robot cannot be read, or they do not fit.
pub fn draft_study(
    logs: &[PathBuf],
    robot: Option<&Path>,
    joint: Option<&str>,
    folder: &Path,
) -> Result<Draft, DraftError> {
    let seen: Vec<Seen> = logs.iter().map(|path| look(path)).collect::<Result<_, _>>()?;
    let mut inputs: Vec<PathBuf> = logs.to_vec();
    inputs.extend(seen.iter().filter_map(|log| log.sidecar.clone()));
    let (text, untold, to_fill) = match robot {
        Some(path) => {
            let description = Description::read(path).map_err(|error| DraftError::Description(Box::new(error)))?;
            inputs.extend(description.files.iter().cloned());
            let turns = |name: &str| {
                let joint = description.joint(name).map(|at| &description.joints[at.0]);
                joint.is_some_and(|joint| joint.limit_rad.is_none())
            };
            let seen: Vec<Seen> = seen.into_iter().map(|log| log.turning(&turns)).collect::<Result<_, _>>()?;
            robot::study(&seen, path, &description, folder)?
        }
        None => joint::study(&seen, joint, folder)?,
    };
    Ok(Draft { text, untold, to_fill, inputs })
}

/// A path as it is seen from a folder, with `/` between its parts; as it is where the two share no folder.
fn relative(path: &Path, folder: &Path) -> String {
    let (to, from) = (whole(path), whole(folder));
    let shared = to.iter().zip(&from).take_while(|(a, b)| a == b).count();
    let up = from.len() - shared;
    // The root alone is nothing that two paths share.
    if shared < 2 && up > 0 {
        return std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()).to_string_lossy().into_owned();
    }
    let parts: Vec<String> = std::iter::repeat_n("..".to_owned(), up).chain(to[shared..].iter().cloned()).collect();
    if parts.is_empty() { ".".to_owned() } else { parts.join("/") }
}

/// The parts of a path from the root on, without `.` and `..`.
fn whole(path: &Path) -> Vec<String> {
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    let mut parts: Vec<String> = Vec::new();
    for part in whole.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => drop(parts.pop()),
            part => parts.push(part.as_os_str().to_string_lossy().into_owned()),
        }
    }
    parts
}

/// Names in a row, the first of them where there are many.
fn listed(names: &[&str]) -> String {
    let more = if names.len() > NAMED { " ..." } else { "" };
    let first: Vec<&str> = names.iter().take(NAMED).copied().collect();
    first.join(", ") + more
}

/// A number for a study: six digits, and a decimal point.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    format!("{rounded:?}")
}
