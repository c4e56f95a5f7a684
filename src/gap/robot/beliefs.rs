//! What became of the numbers that a study believes: which of them had to move, and how far.

use super::attained::counts_from_sd;
use super::bench::Bench;
use super::cause::{Cause, Change};
use super::decide::Decision;
use super::diagnosis::Found;
use super::place::Place;
use super::scatter::Number as Uncertain;
use crate::gap::{BeliefFound, Number};
use crate::number::chance::HALF_95;

/// Friction that moved by so many of its standard deviations is part of the repaired robot.
const REPAIRED_SD: f64 = 1.0;

impl Uncertain {
    /// The calibration that it is, with its joint; masses are none.
    fn friction(self) -> Option<(Cause, usize)> {
        match self {
            Self::Mass(_) => None,
            Self::Coulomb(joint) => Some((Cause::Coulomb, joint)),
            Self::Viscous(joint) => Some((Cause::Viscous, joint)),
        }
    }
}

/// The standard deviation of a number, in its unit.
fn sd(bench: &Bench<'_>, number: Uncertain) -> f64 {
    match number {
        Uncertain::Mass(_) => bench.spreads.sd(number) * bench.believed(number),
        _ => bench.spreads.sd(number),
    }
}

fn name(bench: &Bench<'_>, number: Uncertain) -> String {
    match number {
        Uncertain::Mass(body) => format!("{}.mass", bench.case.model().bodies()[body].name),
        Uncertain::Coulomb(joint) => format!("{}.coulomb", bench.case.names[joint]),
        Uncertain::Viscous(joint) => format!("{}.viscous", bench.case.names[joint]),
    }
}

/// Numbers by how far they moved, the farthest first; those of a cause that is named have no belief left.
fn moved<'a>(bench: &'a Bench<'_>, decision: &'a Decision<'_>) -> Vec<(usize, Uncertain, f64)> {
    let is_named = |number: Uncertain| {
        let parts = decision.answer.parts.iter();
        number.friction().is_some_and(|(cause, joint)| {
            parts.clone().any(|part| part.cause == cause && part.place.joints.contains(&joint))
        })
    };
    let sizes = bench.numbers.iter().zip(&decision.answer.attained.sizes).enumerate();
    let mut moved: Vec<_> = sizes.map(|(k, (number, size))| (k, *number, *size)).collect();
    moved.retain(|(_, number, _)| !is_named(*number));
    moved.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
    moved
}

/// Every number that is uncertain, the one that moved farthest first.
pub(super) fn beliefs(bench: &Bench<'_>, decision: &Decision<'_>) -> Vec<BeliefFound> {
    let of = |(_, number, moved_sd): (usize, Uncertain, f64)| {
        let (believed, sd) = (bench.believed(number), sd(bench, number));
        let unit = match number {
            Uncertain::Mass(_) => "kg",
            Uncertain::Coulomb(_) => "N m",
            Uncertain::Viscous(_) => "N m s/rad",
        };
        let found = (believed + moved_sd * sd).max(0.0);
        BeliefFound { name: name(bench, number), believed, sd, found, moved_sd, unit: unit.to_owned() }
    };
    moved(bench, decision).into_iter().map(of).collect()
}

/// Numbers that are others than the study believes.
pub(super) fn broken(beliefs: &[BeliefFound]) -> Vec<&BeliefFound> {
    let from_sd = counts_from_sd(beliefs.first().map_or(0.0, |farthest| farthest.moved_sd));
    beliefs.iter().filter(|belief| belief.moved_sd.abs() > from_sd).collect()
}

/// The friction that moved farthest, on all joints on which it moved far.
pub(super) fn off(bench: &Bench<'_>, decision: &Decision<'_>) -> Option<Found> {
    let moved = moved(bench, decision);
    let from_sd = counts_from_sd(moved.iter().find(|(_, number, _)| number.friction().is_some())?.2);
    let far: Vec<_> = moved.iter().filter(|(_, _, size)| size.abs() > from_sd).collect();
    let (k, number, size) = **far.iter().find(|(_, number, _)| number.friction().is_some())?;
    let (cause, _) = number.friction()?;
    let (name, unit) = cause.named()[0];
    let sd = sd(bench, number);
    let value = (bench.believed(number) + size * sd).max(0.0);
    let around = |spread: f64| Some([-1.0, 1.0].map(|side| (value + side * HALF_95 * spread * sd).max(0.0)));
    let spread = bench.noise.spread(k);
    let left = (decision.excess + 1.0).max(1.0).sqrt();
    let same = far.iter().filter_map(|(_, number, _)| number.friction()).filter(|(of, _)| *of == cause);
    let mut joints: Vec<usize> = same.map(|(_, joint)| joint).collect();
    joints.sort_unstable();
    Some(Found {
        cause,
        joints: joints.into_iter().map(|joint| bench.case.names[joint].clone()).collect(),
        parameters: vec![Number {
            name: name.to_owned(),
            value,
            unit: unit.to_owned(),
            interval: around(left * spread),
            interval_naive: around(spread),
        }],
    })
}

/// The changes of the answer, and friction that moved beside them.
pub(super) fn changes(bench: &Bench<'_>, decision: &Decision<'_>) -> Vec<Change> {
    let of = |(_, number, size): (usize, Uncertain, f64)| {
        let (cause, joint) = number.friction().filter(|_| size.abs() > REPAIRED_SD)?;
        let value = (bench.believed(number) + size * sd(bench, number)).max(0.0);
        Some(Change { cause, place: Place::joint(joint), values: vec![value] })
    };
    let mut changes: Vec<Change> = moved(bench, decision).into_iter().filter_map(of).collect();
    changes.extend(decision.answer.changes(bench));
    changes
}
