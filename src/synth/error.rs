//! Why no logs can be made.

use crate::gap::clamped::ClampedCaseError;
use crate::geometry::GeometryError;
use crate::log::LogError;
use crate::robot::RobotError;
use crate::robot::simulate::{Diverged, SimulateError};
use std::path::PathBuf;

/// A spec that cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SynthError {
    /// A file cannot be read, or is wrong.
    #[error(transparent)]
    File(#[from] LogError),
    /// A value of the spec cannot be.
    #[error("{}: key `{key}`: found {found}, expected {expected}", file.display())]
    Value {
        /// The spec.
        file: PathBuf,
        /// Where in it.
        key: String,
        /// What stands there.
        found: String,
        /// What may.
        expected: String,
    },
    /// A part, joint or number that the robot, its floor or an effect refuses.
    #[error("{}: {key}: {source}", file.display())]
    Refused {
        /// The spec.
        file: PathBuf,
        /// Where in it.
        key: String,
        /// Why.
        source: Box<SimulateError>,
    },
    /// The true robot's motion ran away.
    #[error("{}: {log}: {source}", file.display())]
    Diverged {
        /// The spec.
        file: PathBuf,
        /// The log.
        log: String,
        /// When and why.
        source: Box<Diverged>,
    },
    /// A described robot that cannot be read, or cannot be simulated.
    #[error(transparent)]
    Described(Box<ClampedCaseError>),
    /// The worker threads cannot be started.
    #[error("cannot start the worker threads: {0}")]
    Threads(String),
}

/// Makes errors that name the spec and the key.
pub(super) struct Blame<'a> {
    pub file: &'a std::path::Path,
}

impl Blame<'_> {
    pub(super) fn value(&self, key: &str, found: impl ToString, expected: impl ToString) -> SynthError {
        SynthError::Value {
            file: self.file.to_path_buf(),
            key: key.to_owned(),
            found: found.to_string(),
            expected: expected.to_string(),
        }
    }

    pub(super) fn refused(&self, key: &str, source: impl Into<SimulateError>) -> SynthError {
        match source.into() {
            SimulateError::File(source) | SimulateError::Robot(RobotError::File(source)) => SynthError::File(source),
            source => {
                SynthError::Refused { file: self.file.to_path_buf(), key: key.to_owned(), source: Box::new(source) }
            }
        }
    }

    pub(super) fn geometry(&self, key: &str, source: GeometryError) -> SynthError {
        self.refused(key, SimulateError::Geometry(source))
    }

    /// A number in its range.
    pub(super) fn number(
        &self,
        key: &str,
        value: f64,
        is_right: impl Fn(f64) -> bool,
        expected: &str,
    ) -> Result<f64, SynthError> {
        if value.is_finite() && is_right(value) { Ok(value) } else { Err(self.value(key, value, expected)) }
    }
}
