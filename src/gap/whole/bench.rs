//! A clamped robot and its causes on the logs that setpoints drive, simulated at sizes of what is never quite right about
//! them, and made linear there.

use super::noise::{LEAST_NOISE_RAD, mean_square};
use super::parts::{append, parts};
use super::robot::{Beginning, PlacedCause, Stretch, WholeRobot};
use super::unknown::{Quantity, Unknown, believed, is_body};
use crate::gap::clamped::ClampedSetup;
use crate::gap::hypothesis::reach::mean_period_s;
use crate::log::{DriveMode, JointColumns, RobotLog, Role};
use crate::number::chance::HALF_95;
use crate::robot::description::FoundNumber;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;

/// Time of all fitted logs that steps are told by \[s\].
const SIMULATED_S: f64 = 45.0;
/// Halvings of a step that explains less.
const HALVINGS: i32 = 3;
/// Change of a number to either side for what it does, in its standard deviations: what scales masses, gains and friction
/// together changes nothing, and is seen to change nothing only where each of them is told well.
const NUDGE: f64 = 0.05;
/// To first order a change is at most so many times what it was told at.
const LARGEST: f64 = 10.0;
/// Where all torques are scaled alike nothing moves; what seems to, by this share of what each of them moves, does so by the
/// errors of differences, or as something small is known that was not scaled.
const NOTHING: f64 = 0.05;

/// To which sides numbers are changed for what they do: to both where it matters which of them do nothing together, to one
/// where a robot is so far from its logs that it is only asked whether it comes nearer.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Sides {
    Both,
    One,
}

/// Where each part of each log begins.
pub(super) type Beginnings = Vec<Vec<Beginning>>;

/// What a robot leaves of its logs.
pub(super) struct Point {
    /// In standard deviations of the unknowns.
    pub sizes: Vec<f64>,
    /// Measured less simulated \[rad\], joint by joint of log by log.
    pub left: Vec<Vec<f64>>,
    /// Where each part of each log begins.
    pub from: Beginnings,
    /// How well the sizes are known, as told where the last step began; 1 before any.
    pub sd: Vec<f64>,
}

/// A robot made linear about a point.
pub(super) struct Slopes {
    /// What one standard deviation of each unknown changes \[rad\]; `None` where the robot runs away.
    columns: Vec<Option<Vec<Vec<f64>>>>,
    /// One over the variance of each row.
    pub weights: Vec<f64>,
    factors: Cholesky<f64, Dyn>,
    /// How well the unknowns are known.
    sd: Vec<f64>,
}

impl Slopes {
    /// What a point leaves, and what it asks of the beliefs.
    pub fn price(&self, point: &Point) -> f64 {
        dot(&self.weights, &point.left, &point.left) + point.sizes.iter().map(|size| size * size).sum::<f64>()
    }

    /// What the robot moves by to first order where each unknown changes by so many standard deviations \[rad\].
    #[cfg(test)]
    pub fn along(&self, sizes: &[f64]) -> Vec<Vec<f64>> {
        let columns = || sizes.iter().zip(self.columns.iter().flatten());
        let rows = self.columns.iter().flatten().next().map_or(0, Vec::len);
        let row = |k: usize| {
            let samples = self.columns.iter().flatten().next().map_or(0, |column| column[k].len());
            (0..samples).map(|s| columns().map(|(size, column)| size * column[k][s]).sum()).collect()
        };
        (0..rows).map(row).collect()
    }

    /// How fast that falls to first order with each unknown, halved.
    fn falls(&self, here: &Point) -> DVector<f64> {
        let of = |(size, column): (&f64, &Option<Vec<Vec<f64>>>)| self.overlap(column.as_deref(), &here.left) - size;
        DVector::from_iterator(here.sizes.len(), here.sizes.iter().zip(&self.columns).map(of))
    }

    /// The price to first order where the unknowns are at their best.
    pub fn left(&self, here: &Point) -> f64 {
        let falls = self.falls(here);
        self.price(here) - falls.dot(&self.factors.solve(&falls))
    }

    /// How many times what something else changes \[rad\] is best beside them, and by how much the price is less with it.
    pub fn saved(&self, here: &Point, change: &[Vec<f64>]) -> (f64, f64) {
        let columns = self.columns.iter().map(|column| self.overlap(column.as_deref(), change));
        let along = DVector::from_iterator(here.sizes.len(), columns);
        let slope = dot(&self.weights, change, &here.left) - along.dot(&self.factors.solve(&self.falls(here)));
        let curvature = dot(&self.weights, change, change) - along.dot(&self.factors.solve(&along));
        let times = (slope / curvature).clamp(0.0, LARGEST);
        if times.is_finite() { (times, times * (2.0 * slope - times * curvature)) } else { (0.0, 0.0) }
    }

    fn overlap(&self, column: Option<&[Vec<f64>]>, with: &[Vec<f64>]) -> f64 {
        column.map_or(0.0, |column| dot(&self.weights, column, with))
    }
}

/// What the unknowns are tried on.
pub(super) struct Bench<'a> {
    pub setup: &'a ClampedSetup,
    pub logs: Vec<&'a RobotLog>,
    pub unknowns: Vec<Unknown>,
    /// Those that are not uncertain.
    others: Vec<FoundNumber>,
    /// Bodies that were found, where they were.
    bodies: Vec<FoundNumber>,
    pub causes: &'a [PlacedCause],
}

impl<'a> Bench<'a> {
    /// A robot with numbers and causes; of each of the `alike` all have the values of the first. `None` where no log is driven
    /// by setpoints, or nothing is uncertain.
    pub fn new(
        setup: &'a ClampedSetup,
        numbers: &[FoundNumber],
        causes: &'a [PlacedCause],
        alike: Vec<Vec<usize>>,
    ) -> Option<Self> {
        let logs = driven(setup, |role| role != Role::Validate);
        let mut unknowns = believed(setup, &logs, numbers);
        for those in alike {
            let Some(first) = those.first().map(|first| &causes[*first]) else { continue };
            let known = first.values.iter().zip(&first.spreads).enumerate().filter(|(_, (_, sd))| **sd > 0.0);
            unknowns.extend(known.map(|(value, (was, sd))| Unknown {
                quantity: Quantity::Value { causes: those.clone(), value },
                was: *was,
                centre: *was,
                sd: *sd,
            }));
        }
        if logs.is_empty() || unknowns.is_empty() {
            return None;
        }
        let is_unknown = |number: &FoundNumber| {
            unknowns.iter().any(|unknown| match &unknown.quantity {
                Quantity::Number { key, name, .. } => *key == number.key && *name == number.name,
                Quantity::Body { .. } | Quantity::Value { .. } => false,
            })
        };
        let known = numbers.iter().filter(|number| !is_unknown(number)).cloned();
        let (bodies, others) = known.partition(is_body);
        Some(Self { setup, logs, unknowns, others, bodies, causes })
    }

    /// The robot where the unknowns have these sizes, known so well.
    pub fn robot(&self, sizes: &[f64], sd: &[f64]) -> (Vec<FoundNumber>, Vec<PlacedCause>) {
        let (mut numbers, mut causes) = (self.others.clone(), self.causes.to_vec());
        let mut bodies = self.bodies.clone();
        for (unknown, (size, sd)) in self.unknowns.iter().zip(sizes.iter().zip(sd)) {
            let at = |size: f64| unknown.at(size);
            match &unknown.quantity {
                Quantity::Number { key, name, unit } => numbers.push(FoundNumber {
                    name: name.clone(),
                    key: *key,
                    was: Some(unknown.was),
                    value: at(*size).max(0.0),
                    interval: Some([-HALF_95, HALF_95].map(|side| at(size + side * sd).max(0.0))),
                    unit: (*unit).to_owned(),
                    place_m: None,
                }),
                Quantity::Body { key, name, axis } => {
                    let own = bodies.iter_mut().filter(|body| body.key == *key && body.name == *name);
                    own.for_each(|body| match (axis, &mut body.place_m) {
                        (None, _) => {
                            body.value = at(*size);
                            body.interval = Some([-HALF_95, HALF_95].map(|side| at(size + side * sd).max(0.0)));
                        }
                        (Some(axis), Some(place_m)) => place_m[*axis] = at(*size),
                        (Some(_), None) => {}
                    });
                }
                Quantity::Value { causes: those, value } => {
                    for cause in those {
                        causes[*cause].values[*value] = at(*size);
                        causes[*cause].spreads[*value] = sd * unknown.sd;
                    }
                }
            }
        }
        // What hangs on a link comes after the link's own mass.
        numbers.extend(bodies);
        (numbers, causes)
    }

    /// The robot as it is stated, with beginnings of its own where none are given.
    pub fn stated(&self, from: Option<&Beginnings>) -> Option<Point> {
        self.point(vec![0.0; self.unknowns.len()], from)
    }

    /// The robot with numbers, with beginnings of its own where none are given.
    pub fn with(&self, numbers: &[FoundNumber], from: Option<&Beginnings>) -> Option<Point> {
        self.point(self.unknowns.iter().map(|unknown| unknown.size_in(numbers)).collect(), from)
    }

    fn point(&self, sizes: Vec<f64>, from: Option<&Beginnings>) -> Option<Point> {
        let sd = vec![1.0; sizes.len()];
        let (numbers, causes) = self.robot(&sizes, &sd);
        let until_s = SIMULATED_S / self.logs.len() as f64;
        let (from, left) = along(self.setup, (&numbers, &causes), &self.logs, from, until_s)?;
        Some(Point { sizes, left, from, sd })
    }

    /// One over the variance of each row: what it leaves is taken as its noise.
    fn weights(&self, left: &[Vec<f64>]) -> Vec<f64> {
        let rounding_rad = self.setup.study.sensor.resolution_rad.map_or(0.0, |step| step / 12f64.sqrt());
        let least = rounding_rad.max(LEAST_NOISE_RAD).powi(2);
        left.iter().map(|row| mean_square(row).max(least).recip()).collect()
    }

    /// The robot made linear about a point.
    pub fn slopes(&self, here: &Point, sides: Sides) -> Option<Slopes> {
        let n = self.unknowns.len();
        let column = |k: usize| -> Option<Vec<Vec<f64>>> {
            let nudged = |by: f64| {
                let mut sizes = here.sizes.clone();
                sizes[k] += by;
                Some(self.point(sizes, Some(&here.from))?.left)
            };
            let down = here.sizes[k] - NUDGE;
            let is_both = sides == Sides::Both && self.unknowns[k].within(down) <= down;
            let less = if is_both { Some(nudged(-NUDGE)?) } else { None };
            let (less, apart) = less.as_ref().map_or((&here.left, NUDGE), |less| (less, 2.0 * NUDGE));
            let rows = less.iter().zip(nudged(NUDGE)?);
            Some(rows.map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b) / apart).collect()).collect())
        };
        let mut columns: Vec<Option<Vec<Vec<f64>>>> = (0..n).into_par_iter().map(column).collect();
        let weights = self.weights(&here.left);
        self.free_scale(here, &weights, &mut columns);
        let mut inner = DMatrix::zeros(n, n);
        for (a, of_a) in columns.iter().enumerate() {
            for (b, of_b) in columns.iter().enumerate() {
                inner[(a, b)] = of_a.as_ref().zip(of_b.as_ref()).map_or(0.0, |(a, b)| dot(&weights, a, b));
            }
        }
        // Samples that hang together say less; what is believed is not said by samples.
        let told = &inner / self.correlation(here).max(1.0) + DMatrix::identity(n, n);
        let variances = told.cholesky()?.inverse().diagonal();
        let sd = variances.iter().map(|variance: &f64| variance.max(0.0).sqrt()).collect();
        let factors = (inner + DMatrix::identity(n, n)).cholesky()?;
        Some(Slopes { columns, weights, factors, sd })
    }

    /// Takes out of the columns what they say of the scale of all torques: only the ratios of masses, friction and gains move a
    /// robot, and what differences are off by would tell each of them far better than it is believed.
    fn free_scale(&self, here: &Point, weights: &[f64], columns: &mut [Option<Vec<Vec<f64>>>]) {
        let value = |(unknown, size): (&Unknown, &f64)| unknown.at(*size) / unknown.sd;
        let is_scaled = |unknown: &Unknown| unknown.is_of_torque(self.causes);
        let both = self.unknowns.iter().zip(&here.sizes);
        let scaled: Vec<f64> = both.map(|both| if is_scaled(both.0) { value(both) } else { 0.0 }).collect();
        let mut moved: Vec<Vec<f64>> = here.left.iter().map(|row| vec![0.0; row.len()]).collect();
        let mut apart = 0.0;
        for (times, column) in scaled.iter().zip(&*columns).filter(|(times, _)| **times != 0.0) {
            let Some(column) = column else { return };
            apart += times * times * dot(weights, column, column);
            let pairs = moved.iter_mut().zip(column);
            pairs.for_each(|(sum, row)| sum.iter_mut().zip(row).for_each(|(sum, by)| *sum += times * by));
        }
        let length: f64 = scaled.iter().map(|times| times * times).sum();
        if length == 0.0 || dot(weights, &moved, &moved) > NOTHING * NOTHING * apart {
            return;
        }
        for (times, column) in scaled.iter().zip(columns) {
            let pairs = column.iter_mut().flatten().zip(&moved);
            pairs.for_each(|(row, sum)| row.iter_mut().zip(sum).for_each(|(by, sum)| *by -= times / length * sum));
        }
    }

    /// Goes to what is best to first order as far as that explains more, and by which share.
    pub fn stepped(&self, here: &Point, slopes: &Slopes) -> Option<(Point, f64)> {
        let step = slopes.factors.solve(&slopes.falls(here));
        (0..=HALVINGS).find_map(|halving| {
            let share = 0.5_f64.powi(halving);
            let sizes = here.sizes.iter().zip(step.iter()).zip(&self.unknowns);
            let sizes = sizes.map(|((size, by), unknown)| unknown.within(size + share * by));
            let there = self.point(sizes.collect(), Some(&here.from))?;
            let gained = 1.0 - slopes.price(&there) / slopes.price(here);
            (gained > 0.0).then(|| {
                // From where it begins best it leaves no more.
                let anew = self.point(there.sizes.clone(), None).filter(|a| slopes.price(a) < slopes.price(&there));
                (Point { sd: slopes.sd.clone(), ..anew.unwrap_or(there) }, gained)
            })
        })
    }
}

/// Where a robot with numbers and causes begins each part of logs, unless that is given, and measured less simulated of every
/// joint of them, up to so long after their start \[rad, s\]; `None` where it runs away.
pub(super) fn along(
    setup: &ClampedSetup,
    (numbers, causes): (&[FoundNumber], &[PlacedCause]),
    logs: &[&RobotLog],
    from: Option<&Beginnings>,
    until_s: f64,
) -> Option<(Beginnings, Vec<Vec<f64>>)> {
    let of_log = |(at, log): (usize, &&RobotLog)| {
        let mut robot = WholeRobot::of(setup, numbers, causes).ok()?;
        let (mut begins, mut left) = (Vec::new(), Vec::new());
        let until_s = log.t_s[0] + until_s;
        let parts = parts(log);
        for (k, part) in parts.iter().take_while(|part| part.t_s[0] <= until_s).enumerate() {
            let begin = from.map_or_else(|| robot.beginning(setup, part), |from| from[at][k].clone());
            let stretch = Stretch::searched(mean_period_s(&part.t_s), until_s);
            let recording = robot.motion(setup, part, &begin, &stretch).ok()?;
            let samples = part.t_s.partition_point(|t| *t <= until_s);
            let of_joint = |(joint, read): (&JointColumns, Vec<f64>)| {
                joint.q_rad.iter().zip(read).take(samples).map(|(measured, read)| measured - read).collect()
            };
            let read = robot.read(&recording, part).ok()?;
            append(&mut left, part.joints.iter().zip(read).map(of_joint).collect());
            begins.push(begin);
        }
        Some((begins, left))
    };
    let all: Vec<(Vec<Beginning>, Vec<Vec<f64>>)> = logs.par_iter().enumerate().map(of_log).collect::<Option<_>>()?;
    let (begins, left): (Beginnings, Vec<Vec<Vec<f64>>>) = all.into_iter().unzip();
    let left = left.concat();
    left.iter().flatten().all(|left: &f64| left.is_finite()).then_some((begins, left))
}

/// Rows times rows, each with its weight.
pub(super) fn dot(weights: &[f64], a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let rows = weights.iter().zip(a.iter().zip(b));
    rows.map(|(weight, (a, b))| weight * a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>()).sum()
}

/// Logs that setpoints drive.
pub(super) fn driven(setup: &ClampedSetup, is_asked: impl Fn(Role) -> bool) -> Vec<&RobotLog> {
    let entries = setup.study.logs.iter().zip(&setup.logs);
    let those = entries.filter(|(entry, _)| entry.drive == DriveMode::Position && is_asked(entry.role));
    those.map(|(_, log)| log).filter(|log| log.len() > 1).collect()
}
