//! What can be wrong with a robot description, said so that its author can mend it.

use crate::log::LogError;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A line of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct At {
    /// The file.
    pub file: Arc<Path>,
    /// Its line, from 1.
    pub line: u32,
}

impl fmt::Display for At {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: line {}", self.file.display(), self.line)
    }
}

/// Why a description cannot be used; every message names the file, mostly the line and the element.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are the words of the message above them")]
pub enum DescriptionError {
    /// The file could not be opened or read, or is a TOML file that is wrong.
    #[error(transparent)]
    File(#[from] LogError),
    /// The file is no XML.
    #[error("{at}: not well-formed XML: {what}")]
    Xml { at: At, what: String },
    /// Something that changes the dynamics and is not read here.
    #[error("{at}: {element}: {feature} is not supported; {hint}")]
    Unsupported { at: At, element: String, feature: String, hint: String },
    /// A value that cannot be.
    #[error("{at}: {element}: {attribute}: found {found}, expected {expected}")]
    Value { at: At, element: String, attribute: String, found: String, expected: String },
    /// An element that cannot be so.
    #[error("{at}: {element}: {what}")]
    Wrong { at: At, element: String, what: String },
    /// Something about the whole file.
    #[error("{}: {what}", file.display())]
    Whole { file: PathBuf, what: String },
}

impl DescriptionError {
    /// Whether a file could not be opened or read (exit code 5), as opposed to bad data in it (3).
    pub fn is_io(&self) -> bool {
        matches!(self, Self::File(error) if error.is_io())
    }
}
