//! Hypotheses refitted in full: the whole robot is simulated anew at every trial point.

use super::attained::BELIEVED_SD;
use super::beliefs::believed;
use super::bench::Bench;
use super::cause::{Cause, Change};
use super::noise::Weighed;
use super::place::Place;
use super::scatter::Number;
use super::screen::change;
use crate::joint::{EffectParameter, Scan};
use crate::number::math;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// One cause of a hypothesis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    pub cause: Cause,
    pub place: Place,
    /// As they are searched.
    pub values: Vec<f64>,
}

/// A hypothesis about the robot: some causes, or none.
#[derive(Clone, Debug)]
pub(super) struct Hypothesis {
    pub parts: Vec<Part>,
    /// Weighed sum of squares over the samples that fits see.
    pub loss: f64,
    /// Measured less predicted.
    pub residual: Vec<f64>,
    /// Values that were searched: part, and place in its values.
    free: Vec<(usize, usize)>,
    /// Their covariance, in units of their scales (of their logarithm where that is searched).
    covariance: Option<DMatrix<f64>>,
}

/// Trial points for one hypothesis. On the floor, where each is a walk, few are spent on most, and more on the best.
const CLAMPED: usize = 26;
const ROUGHLY: usize = 6;
const ON_THE_FLOOR: usize = 24;
/// The same with free play, of which every trial takes as long as dozens of others.
const HUNTING: usize = 12;
/// A step gains less than this: done.
const DONE: f64 = 0.5;
/// Change of a value for its slope, in units of its scale: on the floor only large changes rise above where feet happen
/// to land, in free play above the joint's hunting.
const NUDGE_SMOOTH: f64 = 0.03;
const NUDGE_ROUGH: f64 = 0.15;
/// Longest step in a value, in units of its scale.
const LONGEST: f64 = 1.5;
const HALVINGS: usize = 4;

impl Hypothesis {
    /// The study's robot as given.
    pub fn given(bench: &Bench<'_>) -> Self {
        Self::of(bench, Vec::new(), bench.left())
    }

    fn of(bench: &Bench<'_>, parts: Vec<Part>, residual: Vec<f64>) -> Self {
        let weighed = bench.noise.weigh(residual);
        let loss = bench.noise.dot(&weighed, &weighed);
        Self { parts, loss, residual: weighed.column, free: Vec::new(), covariance: None }
    }

    pub fn changes(&self, bench: &Bench<'_>) -> Vec<Change> {
        self.parts.iter().map(|part| change(bench, part.cause, &part.place, &part.values)).collect()
    }

    /// How many values were searched.
    pub fn free(&self) -> usize {
        self.free.len()
    }

    /// Standard deviation of a value in units of its scale; `None` where it was held, or the logs do not determine it.
    pub fn sd(&self, part: usize, value: usize) -> Option<f64> {
        let k = self.free.iter().position(|of| *of == (part, value))?;
        let variance = self.covariance.as_ref()?[(k, k)];
        (variance.is_finite() && variance >= 0.0).then(|| variance.sqrt())
    }
}

impl Part {
    /// Whether it is friction that is off by no more than the study allows for.
    pub fn is_believed(&self, bench: &Bench<'_>) -> bool {
        let number = match self.cause {
            Cause::Coulomb => Number::Coulomb,
            Cause::Viscous => Number::Viscous,
            _ => return false,
        };
        let off = |joint: &usize| {
            let number = number(*joint);
            (self.values[0] - believed(bench, number)).abs() <= BELIEVED_SD * bench.spreads.sd(number)
        };
        self.place.joints.iter().all(off)
    }

    pub fn parameters(&self, bench: &Bench<'_>) -> Vec<EffectParameter> {
        let joint = self.place.joints.first().copied().unwrap_or(0);
        self.cause.parameters(&bench.reach[joint], &bench.body)
    }
}

fn free_of(parameters: &[EffectParameter]) -> Vec<usize> {
    (0..parameters.len()).filter(|k| parameters[*k].scan != Scan::Held).collect()
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

/// The hypothesis with the best values near those given; `None` where the robot runs away there, or it is too late to try.
pub(super) fn refine(bench: &Bench<'_>, parts: Vec<Part>) -> Option<Hypothesis> {
    refine_within(bench, parts, if bench.case.is_clamped() { CLAMPED } else { ON_THE_FLOOR })
}

/// The same, on the floor with a few trials only.
pub(super) fn refine_roughly(bench: &Bench<'_>, parts: Vec<Part>) -> Option<Hypothesis> {
    refine_within(bench, parts, if bench.case.is_clamped() { CLAMPED } else { ROUGHLY })
}

fn refine_within(bench: &Bench<'_>, parts: Vec<Part>, most: usize) -> Option<Hypothesis> {
    if bench.deadline.leaves_out("fits of some likely causes") {
        return None;
    }
    let parameters: Vec<Vec<EffectParameter>> = parts.iter().map(|part| part.parameters(bench)).collect();
    let free: Vec<(usize, usize)> = parameters
        .iter()
        .enumerate()
        .flat_map(|(part, parameters)| free_of(parameters).into_iter().map(move |value| (part, value)))
        .collect();
    let mut parts = parts;
    for (part, parameters) in parts.iter_mut().zip(&parameters) {
        for (value, parameter) in part.values.iter_mut().zip(parameters) {
            *value = value.clamp(parameter.lower, parameter.upper);
        }
    }
    let residual = |parts: &[Part]| -> Option<Weighed> {
        let changes: Vec<Change> =
            parts.iter().map(|part| change(bench, part.cause, &part.place, &part.values)).collect();
        let difference = bench.difference(&bench.base, &changes)?;
        let given = bench.left();
        Some(bench.noise.weigh(given.iter().zip(&difference).map(|(given, change)| given - change).collect()))
    };
    let hunts = parts.iter().any(|part| part.cause.is_play());
    let nudge = if bench.case.is_clamped() && !hunts { NUDGE_SMOOTH } else { NUDGE_ROUGH };
    let most = if hunts { most.min(HUNTING) } else { most };
    let stepped = |parts: &[Part], (part, value): (usize, usize), by: f64| {
        let mut there = parts.to_vec();
        there[part].values[value] = moved(&parameters[part][value], there[part].values[value], by);
        there
    };
    let mut here = residual(&parts)?;
    let mut loss = bench.noise.dot(&here, &here);
    let (mut simulations, mut damping) = (1, 1e-2);
    let n = free.len();
    let mut curvature = DMatrix::zeros(n, n);
    loop {
        if n == 0 || bench.deadline.leaves_out("fits to their end") {
            break;
        }
        let slope = |k: &(usize, usize)| -> Option<Weighed> {
            [nudge, -nudge].into_iter().find_map(|by| {
                let there = stepped(&parts, *k, by);
                if there == parts {
                    return None;
                }
                let there = residual(&there)?;
                let difference = there.column.iter().zip(&here.column).map(|(there, here)| (there - here) / by);
                Some(bench.noise.weigh(difference.collect()))
            })
        };
        let slopes: Vec<Option<Weighed>> = free.par_iter().map(slope).collect();
        simulations += n;
        let mut gradient = DVector::zeros(n);
        curvature = DMatrix::zeros(n, n);
        for (a, of_a) in slopes.iter().enumerate() {
            let Some(of_a) = of_a else { continue };
            gradient[a] = bench.noise.dot(of_a, &here);
            for (b, of_b) in slopes.iter().enumerate() {
                curvature[(a, b)] = of_b.as_ref().map_or(0.0, |of_b| bench.noise.dot(of_a, of_b));
            }
        }
        let mut gained = None;
        for _ in 0..HALVINGS {
            let mut damped = curvature.clone();
            for a in 0..n {
                damped[(a, a)] = damped[(a, a)] * (1.0 + damping) + 1e-9;
            }
            let Some(step) = damped.lu().solve(&-&gradient) else { break };
            let trial = free
                .iter()
                .zip(step.iter())
                .fold(parts.clone(), |parts, (k, by)| stepped(&parts, *k, by.clamp(-LONGEST, LONGEST)));
            simulations += 1;
            if let Some(there) = residual(&trial) {
                let then = bench.noise.dot(&there, &there);
                if then < loss {
                    gained = Some(loss - then);
                    (parts, here, loss) = (trial, there, then);
                    damping = f64::max(0.2 * damping, 1e-4);
                    break;
                }
            }
            damping *= 8.0;
        }
        if gained.is_none_or(|gained| gained < DONE) || simulations >= most {
            break;
        }
    }
    let mut hypothesis = Hypothesis::of(bench, parts, here.column);
    hypothesis.covariance = curvature.try_inverse();
    hypothesis.free = free;
    Some(hypothesis)
}
