//! What was tried in full.

use super::column::Column;
use super::refine::Hypothesis;

/// Everything that was tried in full.
pub(super) struct Attribution {
    /// What each cause changes, to first order.
    pub columns: Vec<Column>,
    pub given: Hypothesis,
    /// One cause each, best first.
    pub firsts: Vec<Hypothesis>,
    /// Two causes each, best first; empty where one is not needed.
    pub seconds: Vec<Hypothesis>,
}
