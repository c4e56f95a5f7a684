//! Shapes in words.

use super::shape::Shape;
use crate::joint::{LawActs, LawVariable};
use crate::number::significant;
use std::f64::consts::FRAC_PI_2;

/// What repeats within this angle \[rad\], four times a turn or more often, is made by teeth or magnets.
const OF_TEETH_RAD: f64 = FRAC_PI_2;

/// A step narrower than this share of the range is one; a wider one is a rise that saturates.
const SUDDEN: f64 = 0.06;
/// A level below this share of what else a shape does is not worth a word.
const ASIDE: f64 = 0.15;

/// What the numbers of a shape mean.
pub(super) struct Words {
    pub variable: LawVariable,
    pub acts: LawActs,
    pub range: [f64; 2],
}

impl Words {
    /// Whether a shape is a torque or friction that teeth or magnets make.
    pub fn is_of_teeth(&self, shape: &Shape) -> bool {
        let by_angle = self.variable == LawVariable::Angle && matches!(self.acts, LawActs::Torque | LawActs::Friction);
        by_angle
            && matches!(*shape, Shape::Periodic { period, amplitude, slope }
                if period <= OF_TEETH_RAD && !self.is_mostly_line(amplitude, slope))
    }

    /// Whether the line under a wave changes by more than the wave over the range.
    fn is_mostly_line(&self, amplitude: f64, slope: f64) -> bool {
        let [from, to] = self.range;
        (slope * (to - from)).abs() > amplitude
    }

    pub fn of(&self, shape: &Shape) -> String {
        let [from, to] = self.range;
        match *shape {
            Shape::Constant { value } => format!("constant, {}", self.value(value)),
            Shape::Line { offset, slope } => self.line(offset, slope),
            Shape::Periodic { period, amplitude, slope } => {
                let cogging = if self.is_of_teeth(shape) { " (cogging, or teeth)" } else { "" };
                let on_line = if self.is_mostly_line(amplitude, slope) {
                    format!(", on a line of {}", self.slope(slope))
                } else {
                    String::new()
                };
                let (period, amplitude) = (self.place(period), self.value(amplitude));
                format!("repeats every {period}, amplitude {amplitude}{cogging}{on_line}")
            }
            Shape::Square { offset, factor, is_odd } => {
                let most = from.abs().max(to.abs());
                let level = self.level(offset, factor * most * most);
                let grows = match self.acts {
                    LawActs::Friction if factor < 0.0 => "falls",
                    _ => "grows",
                };
                let of = format!("{}{}", self.variable_words(), if is_odd { " and its sign" } else { "" });
                let brakes =
                    (self.acts, self.variable) == (LawActs::Torque, LawVariable::Speed) && is_odd && factor < 0.0;
                let like = if brakes { ", like drag" } else { "" };
                let at_most = format!("{} at {}", self.value(factor * most * most), self.place(most));
                format!("{grows} with the square of the {of}: {at_most}{like}{level}")
            }
            Shape::Step { at, before, behind, width } => self.step(at, [before, behind], width),
            Shape::Settling { at_zero, far, width } => {
                let ends = format!("from {} at zero to {}", self.value(at_zero), self.value(far));
                let within = self.place(2.0 * width);
                let stribeck = (self.acts, self.variable) == (LawActs::Friction, LawVariable::Speed);
                match at_zero.abs() > far.abs() {
                    true if stribeck => format!("falls {ends} within about {within}, like Stribeck's friction"),
                    true => format!("dies away {ends} within about {within}"),
                    false => format!("saturates: {ends} within about {within}"),
                }
            }
            Shape::DeadBand { band, slope } => {
                format!("nothing within {} of zero, then {} (a dead band)", self.place(band), self.slope(slope))
            }
            Shape::Beyond { from: at, side, slope, level } => {
                let room = if side > 0.0 { to - at } else { at - from };
                let level = self.level(level, slope * room);
                let where_to = if side > 0.0 { "above" } else { "below" };
                let like = match (self.acts, self.variable) {
                    (LawActs::Torque, LawVariable::Angle) if slope < 0.0 => ", like a stop or a rope",
                    _ => "",
                };
                format!("only {where_to} {}: {}{like}{level}", self.place(at), self.slope(slope))
            }
            Shape::Bump { at, height, width, level } => {
                let kind = if height < 0.0 { "a dip" } else { "a bump" };
                let (at, wide, level) = (self.place(at), self.place(2.0 * width), self.level(level, height));
                format!("{kind} of {} at {at}, about {wide} wide{level}", self.value(height.abs()))
            }
            Shape::TwoSlopes { offset, below, above } => {
                let level = self.level(offset, (below * from).abs().max((above * to).abs()));
                format!("asymmetric: {} below zero and {} above{level}", self.slope(below), self.slope(above))
            }
        }
    }

    /// Where a curve without a shape lies.
    pub fn extremes(&self, [low, high]: [f64; 2]) -> String {
        format!("between {} and {}", self.number(low), self.value(high))
    }

    fn line(&self, offset: f64, slope: f64) -> String {
        let [from, to] = self.range;
        let slack = -offset / slope;
        let level = self.level(offset, slope * from.abs().max(to.abs()));
        let size = self.slope(slope.abs());
        match (self.acts, self.variable) {
            (LawActs::Torque, LawVariable::Angle) => {
                let room = 0.5 * (to - from);
                let at = match (from - room..to + room).contains(&slack) {
                    true => format!("slack at {}", self.place(slack)),
                    false => format!("with {} at zero", self.value(offset)),
                };
                if slope < 0.0 {
                    format!("like a spring of {size}, {at}")
                } else {
                    format!("pushes away like a spring of \u{2212}{size}, {at}")
                }
            }
            (LawActs::Torque, LawVariable::Speed) if slope < 0.0 => format!("like viscous friction of {size}{level}"),
            (LawActs::Friction, LawVariable::Speed) if slope > 0.0 => format!("like viscous friction of {size}{level}"),
            (LawActs::Torque, LawVariable::Load) => {
                format!("proportional to the load, like a moment that is {} % off{level}", self.percent(slope))
            }
            (LawActs::Friction, LawVariable::Load) if slope > 0.0 => format!("like load friction of {size}{level}"),
            (LawActs::Torque, LawVariable::MotorTorque) => {
                format!("proportional to the motor's torque, like a gain that is {} % off{level}", self.percent(slope))
            }
            (LawActs::Friction, LawVariable::MotorTorque) if slope > 0.0 => {
                format!("like gear friction of {size}{level}")
            }
            (LawActs::Reading, LawVariable::Angle) => {
                format!("like a sensor gain that is {} % off{level}", self.percent(slope))
            }
            (_, LawVariable::Time) => format!("drifts by {}{level}", self.slope(slope)),
            _ => format!("proportional to the {}, {}{level}", self.variable_words(), self.slope(slope)),
        }
    }

    fn step(&self, at: f64, [before, behind]: [f64; 2], width: f64) -> String {
        let [from, to] = self.range;
        let ends = format!("from {} to {}", self.number(before), self.value(behind));
        if width > SUDDEN * (to - from) {
            let middle = self.place(at);
            return format!("saturates on both sides: {ends} about {middle}, within about {}", self.place(4.0 * width));
        }
        let at_zero = at.abs() < 0.03 * (to - from);
        let dry = (self.acts, self.variable) == (LawActs::Torque, LawVariable::Speed) && at_zero && behind < before;
        let like = match dry {
            true => format!(", like dry friction of {}", self.value(0.5 * (before - behind))),
            false => String::new(),
        };
        let place = if at_zero { "zero".to_owned() } else { self.place(at) };
        format!("a step at {place}, {ends}{like}")
    }

    /// What there is besides something of a size.
    fn level(&self, level: f64, size: f64) -> String {
        if level.abs() < ASIDE * size.abs() { String::new() } else { format!(", beside {}", self.value(level)) }
    }

    fn variable_words(&self) -> &'static str {
        match self.variable {
            LawVariable::MotorTorque => "motor's torque",
            LawVariable::SetpointRate => "setpoint's rate",
            other => other.name(),
        }
    }

    fn value(&self, value: f64) -> String {
        match self.acts {
            LawActs::Gain => format!("{} %", self.percent(value)),
            _ => format!("{} {}", signed(value), self.acts.unit()),
        }
    }

    /// A value to which another one gives the unit.
    fn number(&self, value: f64) -> String {
        if self.acts == LawActs::Gain { self.percent(value) } else { significant(value, 2) }
    }

    fn place(&self, at: f64) -> String {
        format!("{} {}", signed(at), self.variable.unit())
    }

    fn percent(&self, share: f64) -> String {
        signed(1e2 * share)
    }

    fn slope(&self, slope: f64) -> String {
        if self.acts == LawActs::Gain {
            let per = if self.variable == LawVariable::Speed {
                " % s/rad".to_owned()
            } else {
                format!(" %/{}", self.variable.unit())
            };
            return format!("{}{per}", self.percent(slope));
        }
        let unit = match (self.acts.unit(), self.variable.unit()) {
            (value, at) if value == at => "",
            ("N m", "rad") => " N m/rad",
            ("N m", "rad/s") => " N m s/rad",
            ("rad", "s") => " rad/s",
            _ => " N m/s",
        };
        format!("{}{unit}", signed(slope))
    }
}

/// Two digits, with a minus sign as it is printed.
fn signed(value: f64) -> String {
    significant(value, 2).replace('-', "\u{2212}")
}
