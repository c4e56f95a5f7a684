//! Exceptions with the program's own words.

use aibo_fit::progress::Cancelled;
use pyo3::exceptions::PyValueError;
use pyo3::{PyErr, create_exception};
use std::fmt::Display;

create_exception!(aibo_fit, Error, PyValueError, "What the program would have said after `error:`.");
create_exception!(aibo_fit, NeverMoved, Error, "The joint never moved in any log that is to be fitted.");
create_exception!(aibo_fit, Unreadable, Error, "A file cannot be read for now, or is not there.");

/// Why there is no answer.
pub enum Failed {
    /// In the program's words.
    Error(String),
    /// The same, of a joint that never moves.
    NeverMoved(String),
    /// The same, of a file that cannot be read.
    Unreadable(String),
}

impl Failed {
    /// An error in its own words.
    pub fn of(error: impl Display) -> Self {
        Self::Error(error.to_string())
    }
}

impl<E: Display> From<E> for Failed {
    fn from(error: E) -> Self {
        Self::of(error)
    }
}

impl From<Failed> for PyErr {
    fn from(failed: Failed) -> Self {
        match failed {
            Failed::Error(words) => Error::new_err(words),
            Failed::NeverMoved(words) => NeverMoved::new_err(words),
            Failed::Unreadable(words) => Unreadable::new_err(words),
        }
    }
}

/// What unwinds a computation that cannot be told to end.
pub struct Unwanted(pub Cancelled);
