//! Everything that is wrong with a file, in one error: the first of each kind, how many more, and what would mend it.

use std::mem::Discriminant;

use crate::log::columns::Columns;
use crate::log::error::{CellFault, LogError};

/// Kinds that are told one by one; a file with more than these is none of ours.
const MOST_KINDS: usize = 12;

/// What makes two defects one kind: the error, what is wrong with the cell, and the column.
type Kind = (Discriminant<LogError>, Option<Discriminant<CellFault>>, Option<usize>);

/// Defects as they are found.
#[derive(Default)]
pub(in crate::log) struct Defects {
    first: Vec<(Kind, LogError, usize)>,
    beyond: usize,
}

impl Defects {
    /// Whether nothing is wrong so far.
    pub fn is_empty(&self) -> bool {
        self.first.is_empty()
    }

    /// Counts a defect of a column; `error` is made only for the first of its kind, since that reads the file again.
    pub fn add(&mut self, like: &LogError, column: Option<usize>, error: impl FnOnce() -> LogError) {
        let fault = match like {
            LogError::Cell { fault, .. } => Some(std::mem::discriminant(fault)),
            _ => None,
        };
        self.count((std::mem::discriminant(like), fault, column), error);
    }

    /// Counts a defect that is at hand.
    pub fn push(&mut self, column: Option<usize>, error: LogError) {
        let kind = (std::mem::discriminant(&error), None, column);
        self.count(kind, || error);
    }

    fn count(&mut self, kind: Kind, error: impl FnOnce() -> LogError) {
        if let Some((_, _, count)) = self.first.iter_mut().find(|(known, _, _)| *known == kind) {
            *count += 1;
        } else if self.first.len() < MOST_KINDS {
            self.first.push((kind, error(), 1));
        } else {
            self.beyond += 1;
        }
    }

    /// All of them as one error; `mend` is the table `[columns]` that would, empty where none can.
    ///
    /// # Errors
    /// [`LogError`], of a single defect as it is, unless there is more to say of it.
    pub fn into_result(self, mend: Columns) -> Result<(), LogError> {
        let mut all = self.first.into_iter();
        let Some((_, first, count)) = all.next() else { return Ok(()) };
        let others: Vec<(LogError, usize)> = all.map(|(_, error, count)| (error, count)).collect();
        let is_all = others.is_empty() && count == 1 && mend.0.is_empty();
        if is_all && first.names_without_angle().is_none() {
            return Err(first);
        }
        Err(LogError::Defects { first: Box::new(first), count, others, beyond: self.beyond, mend })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::ColumnSpec;
    use std::path::PathBuf;

    fn empty(name: &str) -> LogError {
        LogError::Empty { file: PathBuf::from(name) }
    }

    #[test]
    fn each_kind_is_told_once_and_counted() {
        let mut defects = Defects::default();
        (0..3).for_each(|k| defects.push(Some(1), empty(&format!("a{k}"))));
        defects.push(Some(2), empty("b"));
        let message =
            defects.into_result(Columns([("t".to_owned(), ColumnSpec::named("x"))].into())).unwrap_err().to_string();
        assert!(message.starts_with("a0: the file is empty") && !message.contains("a1"), "{message}");
        assert!(message.contains("and 2 more of this kind\nalso: b:"), "{message}");
        assert!(message.ends_with("[columns]\nt = { name = \"x\" }"), "{message}");
    }

    #[test]
    fn one_defect_is_told_as_it_is_and_none_is_no_error() {
        let mut defects = Defects::default();
        defects.push(None, empty("a"));
        assert!(matches!(defects.into_result(Columns::default()), Err(LogError::Empty { .. })));
        assert!(Defects::default().into_result(Columns::default()).is_ok());
    }
}
