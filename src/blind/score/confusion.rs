//! What was there against what was answered.

use super::Trial;
use crate::blind::answer::Answered;
use crate::blind::truth::Truth;
use crate::gap::Verdict;
use crate::joint::EffectId;
use serde::Serialize;

/// More than one effect at once.
const SEVERAL: &str = "several effects";
/// Something that the catalogue does not have.
const OUTSIDE: &str = "outside";
/// No answer.
const FAILED: &str = "failed";

/// A table of counts; only rows and columns that occur.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Table {
    /// What was there.
    pub rows: Vec<&'static str>,
    /// What was answered.
    pub columns: Vec<&'static str>,
    /// `counts[row][column]`
    pub counts: Vec<Vec<u32>>,
}

impl Table {
    /// Counts trials.
    pub fn of(trials: &[Trial]) -> Self {
        let cells = trials.iter().map(|trial| (row(&trial.truth), column(&trial.answer))).collect();
        let names: Vec<&'static str> = EffectId::ALL.iter().map(|effect| effect.id()).chain([SEVERAL]).collect();
        Self::count(cells, &names)
    }

    /// Counts pairs of what was there and what was answered; `names` are of what may be named.
    pub(in crate::blind) fn count(cells: Vec<(&'static str, &'static str)>, names: &[&'static str]) -> Self {
        let tail = ["none", "calibration", OUTSIDE, "unexplained", FAILED];
        let all: Vec<&'static str> = names.iter().copied().chain(tail).collect();
        let kept = |used: &dyn Fn(&str) -> bool| all.iter().copied().filter(|name| used(name)).collect::<Vec<_>>();
        let rows = kept(&|name| cells.iter().any(|(row, _)| *row == name));
        // a column beside each row that is also an answer, so that the diagonal is whole
        let columns = kept(&|name| {
            cells.iter().any(|(row, column)| *column == name || (*row == name && name != OUTSIDE))
                || (name == "unexplained" && rows.contains(&OUTSIDE))
        });
        let mut counts = vec![vec![0; columns.len()]; rows.len()];
        for (row, column) in cells {
            let at = rows.iter().position(|name| *name == row).zip(columns.iter().position(|name| *name == column));
            if let Some((i, j)) = at {
                counts[i][j] += 1;
            }
        }
        Self { rows, columns, counts }
    }

    /// Whether a column is the right answer to a row.
    pub fn is_right(row: &str, column: &str) -> bool {
        row == column || (row == OUTSIDE && column == "unexplained")
    }
}

fn row(truth: &Truth) -> &'static str {
    match truth.verdict {
        Verdict::None => "none",
        Verdict::Calibration => "calibration",
        Verdict::Unexplained => OUTSIDE,
        Verdict::Effect if truth.causes.len() > 1 => SEVERAL,
        Verdict::Effect => truth.causes.first().map_or(OUTSIDE, |effect| effect.id()),
    }
}

fn column(answer: &Result<Answered, String>) -> &'static str {
    let Ok(answer) = answer else { return FAILED };
    match answer.verdict {
        Verdict::None => "none",
        Verdict::Calibration => "calibration",
        Verdict::Unexplained => "unexplained",
        Verdict::Effect if answer.causes.len() > 1 => SEVERAL,
        Verdict::Effect => answer.causes.first().map_or(FAILED, |effect| effect.id()),
    }
}
