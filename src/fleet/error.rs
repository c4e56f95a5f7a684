//! Why a fleet cannot run. A study without an answer is no such reason.

use crate::log::LogError;
use crate::report::ReportError;
use std::path::PathBuf;

/// Why a fleet cannot run, or its table cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FleetError {
    /// A pattern cannot be understood.
    #[error("`{pattern}`: {what}; expected a path, or a pattern such as 'logs/**/study.toml'")]
    Pattern {
        /// The pattern.
        pattern: String,
        /// What is wrong with it.
        what: String,
    },
    /// A pattern matches no file.
    #[error("`{pattern}`: no such study; expected a path, or a pattern such as 'logs/**/study.toml' (in quotes)")]
    Nothing {
        /// The pattern.
        pattern: String,
    },
    /// The folder cannot be used.
    #[error("{}: {source}", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Another fleet is at work there.
    #[error("{}: another fleet writes there; wait for it, or choose another --out", folder.display())]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
    /// An answer has gone since it was written.
    #[error("{}: its answer has gone; run again", study.display())]
    Missing {
        /// The study.
        study: PathBuf,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Log(#[from] LogError),
    /// An answer cannot be written down.
    #[error("an answer cannot be written down: {0}; please report this")]
    Encode(String),
    /// Table or page cannot be made.
    #[error(transparent)]
    Report(#[from] ReportError),
}
