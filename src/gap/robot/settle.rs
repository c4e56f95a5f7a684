//! A clamped robot with the values of its causes and the numbers that are never quite right at their best together.
//!
//! Both are found by steps of Gauss and Newton, the whole robot simulated at every one, and what each changes there: friction
//! that is three times the believed one is far from what it does to first order, and so is friction beside a strong cause.
//! What is far off is weighed by how far it is off: as if that were noise, so that no step trusts a first order that does
//! not hold.

use super::attained::Attained;
use super::bench::Bench;
use super::noise::Noise;
use super::part::{LONGEST, Part, changes, free_values, left, stepped};
use super::scatter::Scatter;
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Steps with what is changed at one point, and halvings of one that explains less.
const STEPS: usize = 3;
const HALVINGS: i32 = 3;
/// A step gains less than this, and less than this share of what is left beyond noise: done.
const DONE: f64 = 1.0;
const DONE_OF_REST: f64 = 2e-3;
/// Change of a value for what it does, in units of its scale, and how well it is known before.
const NUDGE: f64 = 0.03;
const KNOWN: f64 = 30.0;

/// Causes and numbers at their best.
pub(super) struct Settled {
    pub parts: Vec<Part>,
    pub attained: Attained,
    /// Of the values, in units of their scales; `None` where what they change is not known there.
    pub covariance: Option<DMatrix<f64>>,
}

/// A robot that was simulated.
#[derive(Clone)]
struct Point {
    parts: Vec<Part>,
    /// How far the uncertain numbers are off, in their standard deviations.
    sizes: Vec<f64>,
    /// What the sensors have in common, in units of its standard deviation.
    offset: f64,
    /// Measured less simulated.
    left: Vec<f64>,
}

/// What numbers, the sensors' offset and values change of a robot.
struct Slopes {
    columns: Vec<Vec<f64>>,
    has_values: bool,
}

/// The best near causes and sizes of the numbers that are given, from so many points on at which is simulated what all
/// changes; `None` where the robot runs away there.
pub(super) fn settled(bench: &Bench<'_>, parts: Vec<Part>, sizes: Vec<f64>, points: usize) -> Option<Settled> {
    let mut here = Point::of(bench, parts, sizes, 0.0)?;
    let mut slopes = Slopes { columns: bench.noise.columns().to_vec(), has_values: false };
    for _ in 0..points {
        if bench.deadline.leaves_out("fits to their end") {
            break;
        }
        slopes = here.slopes(bench).unwrap_or(slopes);
        let mut worth = 0;
        for _ in 0..STEPS {
            let times = bench.noise.temper(&here.left);
            let Some((there, gained)) = here.step(bench, &slopes, times) else { break };
            here = there;
            let rest = bench.noise.count() as f64 * (1.0 - 1.0 / times);
            if gained < DONE + DONE_OF_REST * rest {
                break;
            }
            worth += 1;
        }
        if worth == 0 {
            break;
        }
    }
    let covariance = slopes.has_values.then(|| slopes.covariance(bench)).flatten();
    let attained = Attained { price: here.price(bench, 1.0), residual: here.read(bench), sizes: here.sizes };
    Some(Settled { parts: here.parts, attained, covariance })
}

impl Point {
    fn of(bench: &Bench<'_>, parts: Vec<Part>, sizes: Vec<f64>, offset: f64) -> Option<Self> {
        let left = left(bench, &scattered(bench, &sizes), &parts)?;
        Some(Self { parts, sizes, offset, left })
    }

    /// Measured less simulated, what the sensors have in common taken out.
    fn read(&self, bench: &Bench<'_>) -> Vec<f64> {
        let offset = &bench.noise.columns()[self.sizes.len()];
        self.left.iter().zip(offset).map(|(left, offset)| left - self.offset * offset).collect()
    }

    /// The weighed sum of squares of readings so many times as noisy, with the price of the numbers.
    fn price(&self, bench: &Bench<'_>, times: f64) -> f64 {
        let squares: f64 =
            bench.noise.weight.iter().zip(self.read(bench)).map(|(weight, left)| weight * left.powi(2)).sum();
        squares / times + self.sizes.iter().chain([&self.offset]).map(|size| size.powi(2)).sum::<f64>()
    }

    /// What is changed here by all that may; `None` where the robot runs away with one of them.
    fn slopes(&self, bench: &Bench<'_>) -> Option<Slopes> {
        // Free play takes dozens of times as long to simulate: with it numbers change what they do as stated.
        if self.parts.iter().any(|part| part.cause.is_play()) {
            return None;
        }
        let scatter = scattered(bench, &self.sizes);
        let of_value = |k: &(usize, usize)| -> Vec<f64> {
            let nudged = |by: f64| {
                let parts = Some(stepped(bench, &self.parts, *k, by)).filter(|parts| *parts != self.parts)?;
                let there = left(bench, &scatter, &parts)?;
                Some(self.left.iter().zip(there).map(|(here, there)| (here - there) / by).collect())
            };
            [NUDGE, -NUDGE].into_iter().find_map(nudged).unwrap_or_else(|| vec![0.0; self.left.len()])
        };
        let (uncertain, values) = rayon::join(
            || bench.uncertain(&scatter, &changes(bench, &self.parts)),
            || free_values(bench, &self.parts).par_iter().map(of_value).collect::<Vec<_>>(),
        );
        let (mut columns, numbers) = uncertain?;
        columns.extend(values);
        (numbers == bench.numbers).then_some(Slopes { columns, has_values: !self.parts.is_empty() })
    }

    /// Goes towards what is best to first order as far as that explains more, and by how much; `None` where it does not.
    fn step(&self, bench: &Bench<'_>, slopes: &Slopes, times: f64) -> Option<(Self, f64)> {
        let count = self.sizes.len();
        let noise = slopes.noise(bench, times)?;
        // What would be left with the numbers as stated.
        let undone: Vec<f64> = self.sizes.iter().map(|size| -size).collect();
        let wanted = noise.sizes(&noise.less(self.left.clone(), &undone));
        let here = self.price(bench, times);
        (0..=HALVINGS).find_map(|halving| {
            let share = 0.5_f64.powi(halving);
            let towards = |(from, to): (&f64, &f64)| from + share * (to - from);
            let sizes: Vec<f64> = self.sizes.iter().zip(&wanted).map(towards).collect();
            let mut there = self.clone();
            if slopes.has_values {
                for (k, step) in free_values(bench, &self.parts).into_iter().zip(&wanted[count + 1..]) {
                    there.parts = stepped(bench, &there.parts, k, (share * KNOWN * step).clamp(-LONGEST, LONGEST));
                }
            }
            let there = Self::of(bench, there.parts, sizes, wanted[count])?;
            let gained = here - there.price(bench, times);
            (gained > 0.0).then_some((there, gained))
        })
    }
}

impl Slopes {
    /// The noise of which values are one more uncertainty, hardly known before.
    fn noise(&self, bench: &Bench<'_>, times: f64) -> Option<Noise> {
        let values_from = bench.numbers.len() + 1;
        let scaled = |(k, column): (usize, &Vec<f64>)| match k < values_from {
            true => column.clone(),
            false => column.iter().map(|change| KNOWN * change).collect(),
        };
        let weight = bench.noise.weight.iter().map(|weight| weight / times).collect();
        Noise::new(weight, self.columns.iter().enumerate().map(scaled).collect())
    }

    fn covariance(&self, bench: &Bench<'_>) -> Option<DMatrix<f64>> {
        let values = bench.numbers.len() + 1..self.columns.len();
        Some(KNOWN.powi(2) * self.noise(bench, 1.0)?.covariance(values))
    }
}

/// The robot whose numbers are off by so many of their standard deviations.
fn scattered(bench: &Bench<'_>, sizes: &[f64]) -> Scatter {
    let mut scatter = Scatter::none(bench.case.model());
    let numbers = bench.numbers.iter().zip(sizes);
    numbers.for_each(|(number, size)| scatter.put(*number, size * bench.spreads.sd(*number)));
    scatter
}
