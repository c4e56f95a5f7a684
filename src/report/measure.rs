//! In what a gap is shown: angles in mrad, torques in N m.

use crate::report::number::significant;

/// Digits of an error.
const DIGITS: i32 = 3;

/// How errors of one kind are shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::report) struct Measure {
    /// Shown per error.
    pub scale: f64,
    /// As shown.
    pub unit: &'static str,
    /// `angle error`
    pub what: &'static str,
}

/// Errors of angles.
pub(in crate::report) const ANGLE: Measure = Measure { scale: 1e3, unit: "mrad", what: "angle error" };
const TORQUE: Measure = Measure { scale: 1.0, unit: "N m", what: "torque error" };

impl Measure {
    /// Of a gap's unit.
    pub fn of(unit: &str) -> Self {
        if unit == "rad" { ANGLE } else { TORQUE }
    }

    /// An error without its unit.
    pub fn number(self, error: f64) -> String {
        significant(self.scale * error, DIGITS)
    }

    /// An error with its unit.
    pub fn quantity(self, error: f64) -> String {
        format!("{} {}", self.number(error), self.unit)
    }

    /// A heading over errors, the unit in its second line.
    pub fn over(self, heading: &str) -> String {
        format!("{heading}\n[{}]", self.unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_shown_in_mrad_and_torques_as_they_are() {
        assert_eq!(Measure::of("rad").quantity(0.0123), "12.3 mrad");
        assert_eq!(Measure::of("N m").quantity(0.0123), "0.0123 N m");
        assert_eq!(Measure::of("N m").over("after"), "after\n[N m]");
    }
}
