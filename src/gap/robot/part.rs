//! Causes with their values, and the robot that has them.

use super::attained::BELIEVED_SD;
use super::bench::{Bench, Logs};
use super::cause::{Cause, Change};
use super::place::Place;
use super::scatter::{Number, Scatter};
use crate::joint::{EffectParameter, Scan};
use crate::number::math;

/// One cause of a hypothesis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    pub cause: Cause,
    pub place: Place,
    /// As they are searched.
    pub values: Vec<f64>,
}

impl Part {
    /// Whether it is this cause on this place.
    pub fn is_where(&self, cause: Cause, place: &Place) -> bool {
        self.cause == cause && self.place == *place
    }

    /// Whether it is friction that is off by no more than the study allows for.
    pub fn is_believed(&self, bench: &Bench<'_>) -> bool {
        let number = match self.cause {
            Cause::Coulomb => Number::Coulomb,
            Cause::Viscous => Number::Viscous,
            _ => return false,
        };
        let off = |joint: &usize| {
            let number = number(*joint);
            (self.values[0] - bench.believed(number)).abs() <= BELIEVED_SD * bench.spreads.sd(number)
        };
        self.place.joints.iter().all(off)
    }

    pub fn parameters(&self, bench: &Bench<'_>) -> Vec<EffectParameter> {
        let joint = self.place.joints.first().copied().unwrap_or(0);
        self.cause.parameters(&bench.reach[joint], &bench.body)
    }
}

/// Values that are searched: part, and place in its values.
pub(super) fn free_values(bench: &Bench<'_>, parts: &[Part]) -> Vec<(usize, usize)> {
    let of = |(part, of): (usize, &Part)| {
        let parameters = of.parameters(bench);
        (0..parameters.len()).filter(move |k| parameters[*k].scan != Scan::Held).map(move |value| (part, value))
    };
    parts.iter().enumerate().flat_map(of).collect()
}

/// A value after a step in units of its scale.
pub(super) fn moved(parameter: &EffectParameter, value: f64, by: f64) -> f64 {
    let there = match parameter.scan {
        Scan::Logarithm => value * math::exp(by),
        Scan::Linear(scale) => value + scale * by,
        Scan::Held => value,
    };
    there.clamp(parameter.lower, parameter.upper)
}

/// Longest step of a search in a value, in units of its scale.
pub(super) const LONGEST: f64 = 1.5;

/// Causes of which one value, by part and place in its values, moved by a step in units of its scale.
pub(super) fn stepped(bench: &Bench<'_>, parts: &[Part], (part, value): (usize, usize), by: f64) -> Vec<Part> {
    let mut there = parts.to_vec();
    let parameter = &parts[part].parameters(bench)[value];
    there[part].values[value] = moved(parameter, parts[part].values[value], by);
    there
}

pub(super) fn change(bench: &Bench<'_>, cause: Cause, place: &Place, values: &[f64]) -> Change {
    let coulomb_nm = place.joints.first().map_or(0.0, |joint| bench.reach[*joint].coulomb_nm);
    Change { cause, place: place.clone(), values: cause.to_named(values, coulomb_nm) }
}

pub(super) fn changes(bench: &Bench<'_>, parts: &[Part]) -> Vec<Change> {
    parts.iter().map(|part| change(bench, part.cause, &part.place, &part.values)).collect()
}

/// Measured less what a robot reads with causes, as stated in logs that are not simulated; `None` where it runs away.
pub(super) fn left(bench: &Bench<'_>, logs: Logs, scatter: &Scatter, parts: &[Part]) -> Option<Vec<f64>> {
    let difference = bench.difference(logs, scatter, &changes(bench, parts))?;
    Some(bench.gap().iter().zip(&difference).map(|(gap, change)| gap - change).collect())
}
