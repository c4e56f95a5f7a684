//! Probabilities that were measured, not computed from losses.
use super::decide::Decision;
use super::diagnosis::{Candidate, Verdict};

pub(super) fn probability(decision: &Decision<'_>) -> (f64, String) {
    let p = match decision.verdict {
        Verdict::Effect => 0.9,
        _ => 0.9,
    };
    (p, "to be measured".into())
}

pub(super) fn share_out(candidates: &mut [Candidate], decision: &Decision<'_>) {
    for c in candidates {
        c.probability =
            if decision.equivalent.contains(&c.effect) { 0.9 / decision.equivalent.len() as f64 } else { 0.0 };
    }
}
