//! The unit of stamps that nobody names, by their steps: no logger of a joint is slower than half a second.

/// Nanoseconds of a second.
pub(super) const NS: i64 = 1_000_000_000;

/// Nanoseconds of the unit in which stamps have this median step.
pub(super) fn ns_per_unit(median_step: f64) -> i64 {
    match median_step {
        step if step >= 5e5 => 1,
        step if step >= 500.0 => 1_000,
        step if step >= 0.5 => 1_000_000,
        _ => NS,
    }
}

/// The unit as a word.
pub(super) fn unit_word(ns_per_unit: i64) -> &'static str {
    match ns_per_unit {
        1 => "nanoseconds",
        1_000 => "microseconds",
        1_000_000 => "milliseconds",
        _ => "seconds",
    }
}
