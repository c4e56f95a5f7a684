//! The kind of an answer about a robot and how clearly it stands, in words that are counted.

use super::bench::Bench;
use super::decide::Decision;
use crate::gap::Verdict;

/// How far the next hypothesis must be behind, as a share of what the answer gains, for an answer to stand out.
const STANDS_OUT: f64 = 0.05;

/// In words, the wider kind first.
pub(super) fn standing(bench: &Bench<'_>, decision: &Decision<'_>) -> String {
    let where_from = if bench.case.is_clamped() { "clamped" } else { "floor" };
    let kind = match (decision.verdict, decision.answer.parts.len()) {
        (Verdict::Effect, 2) => "two causes",
        (Verdict::Effect, _) if decision.answer.parts[0].cause.is_of_robot() => "robot cause",
        (Verdict::Effect, _) => "joint effect",
        (verdict, _) => verdict.name(),
    };
    let clear = match decision.verdict {
        Verdict::Effect | Verdict::Calibration if decision.equivalent.len() > 1 || decision.places.len() > 1 => {
            "one of several"
        }
        Verdict::Effect | Verdict::Calibration if decision.margin > STANDS_OUT * decision.gain => "clear",
        Verdict::Effect | Verdict::Calibration => "narrow",
        Verdict::Unexplained if !decision.answer.parts.is_empty() => "nearest cause named",
        _ => "plain",
    };
    format!("{kind}, {where_from}, {clear}")
}
