//! What is said: the kind of answer, its numbers, how sure it is, what it closes, and what to record next.

pub(in crate::gap) mod as_given;
pub(in crate::gap) mod decide;
pub(in crate::gap) mod detect;
pub(in crate::gap) mod doubts;
pub(in crate::gap) mod law_found;
pub(in crate::gap) mod next;
pub(in crate::gap) mod notes;
pub(in crate::gap) mod numbers;
pub(in crate::gap) mod place;
pub(in crate::gap) mod rates;
pub(in crate::gap) mod recalibrated;
pub(in crate::gap) mod sentence;
pub(in crate::gap) mod told;
pub(in crate::gap) mod twins;
pub(in crate::gap) mod waterfall;
