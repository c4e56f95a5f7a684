//! A clamped robot with the values of its causes and the numbers that are never quite right at their best together.
//!
//! Both are found by steps of Gauss and Newton, at every one of which the limbs that may change are simulated, and what each
//! value and number changes there: friction that is three times the believed one is far from what it does to first order, and
//! so is friction beside a strong cause. What is far off is weighed by how far it is off, limb by limb, as if that were noise:
//! no step trusts a first order that does not hold.

use super::attained::Attained;
use super::bench::{Bench, Logs};
use super::noise::Noise;
use super::part::{LONGEST, Part, changes, free_values, stepped};
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
    /// Measured less simulated; in a search that of logs which no fit sees is out of date.
    left: Vec<f64>,
}

/// What may move, and on which limbs.
struct Open {
    limbs: Vec<usize>,
    /// Places of their numbers among those of the bench.
    numbers: Vec<usize>,
}

/// What numbers, the sensors' offset and values change of a robot.
struct Slopes {
    columns: Vec<Vec<f64>>,
    /// How many of them are numbers.
    numbers: usize,
    has_values: bool,
}

/// The best near causes and sizes of the numbers that are given, from so many points on at which is simulated what all
/// changes; `None` where the robot runs away there. `from` has what its numbers leave of all limbs but those with a cause.
/// Numbers of other limbs than those given stay as they are; the causes are on these.
pub(super) fn settled(
    bench: &Bench<'_>,
    parts: Vec<Part>,
    from: &Attained,
    limbs: Vec<usize>,
    points: usize,
) -> Option<Settled> {
    let numbers = (0..bench.numbers.len()).filter(|k| bench.limbs.have(&limbs, bench.numbers[*k])).collect();
    let open = Open { limbs, numbers };
    let begins = Point::of(bench, parts, from)?;
    let mut here = begins.clone();
    let mut slopes = Slopes::stated(bench, &open);
    for _ in 0..points {
        if bench.deadline.leaves_out("fits to their end") {
            break;
        }
        slopes = here.slopes(bench, &open).unwrap_or(slopes);
        let mut worth = 0;
        for _ in 0..STEPS {
            let weight = tempered(bench, &here.left);
            let Some((there, gained)) = here.step(bench, &open, &slopes, &weight) else { break };
            here = there;
            if gained < DONE + DONE_OF_REST * beyond_noise(bench, &weight) {
                break;
            }
            worth += 1;
        }
        if worth == 0 {
            break;
        }
    }
    let covariance = slopes.has_values.then(|| slopes.covariance(bench)).flatten();
    // What runs away in a log that no fit sees is none; where it begins it may not.
    let here = here.in_full(bench, &open).or_else(|| begins.in_full(bench, &open))?;
    let (price, residual) = (here.price(bench, &bench.noise.weight), here.read(bench));
    let Point { parts, sizes, offset, .. } = here;
    Some(Settled { parts, attained: Attained { price, residual, sizes, offset }, covariance })
}

/// Weights of readings as noisy as what is left on their limb.
fn tempered(bench: &Bench<'_>, left: &[f64]) -> Vec<f64> {
    let mut weight = bench.noise.weight.clone();
    for joints in bench.limbs.joints() {
        let rows =
            || bench.layout.joints().filter(|(joint, _)| joints.contains(joint)).map(|(_, row)| row.range.clone());
        let times = bench.noise.temper_of(left, rows().flatten());
        rows().flatten().for_each(|k| weight[k] /= times);
    }
    weight
}

/// How much more than noise is left, in its variances.
fn beyond_noise(bench: &Bench<'_>, tempered: &[f64]) -> f64 {
    let counted = bench.noise.weight.iter().zip(tempered).filter(|(weight, _)| **weight > 0.0);
    counted.map(|(weight, tempered)| 1.0 - tempered / weight).sum()
}

impl Point {
    fn of(bench: &Bench<'_>, parts: Vec<Part>, from: &Attained) -> Option<Self> {
        let common = &bench.noise.columns()[from.sizes.len()];
        let left = from.residual.iter().zip(common).map(|(left, common)| left + from.offset * common).collect();
        let limbs = bench.limbs.of_places(parts.iter().map(|part| &part.place));
        let mut here = Self { parts, sizes: from.sizes.clone(), offset: from.offset, left };
        here.left = here.left_by(bench, &limbs, Logs::Fitted)?;
        Some(here)
    }

    /// The robot with something else on some limbs.
    fn with(&self, bench: &Bench<'_>, limbs: &[usize], parts: Vec<Part>, sizes: Vec<f64>, offset: f64) -> Option<Self> {
        let mut there = Self { parts, sizes, offset, left: self.left.clone() };
        there.left = there.left_by(bench, limbs, Logs::Fitted)?;
        Some(there)
    }

    /// The same with what is left of logs that no fit sees.
    fn in_full(&self, bench: &Bench<'_>, open: &Open) -> Option<Self> {
        if bench.fits_see_all_logs() {
            return Some(self.clone());
        }
        Some(Self { left: self.left_by(bench, &open.limbs, Logs::All)?, ..self.clone() })
    }

    /// What is left, some limbs simulated anew.
    fn left_by(&self, bench: &Bench<'_>, limbs: &[usize], logs: Logs) -> Option<Vec<f64>> {
        let scatter = scattered(bench, &self.sizes);
        let change = bench.difference_of(limbs, logs, (&scatter, &changes(bench, &self.parts)))?;
        let joints = bench.limbs.joints_of(limbs);
        let mut left = self.left.clone();
        for (_, row) in bench.layout.joints().filter(|(joint, _)| joints.contains(joint)) {
            for k in row.range.clone() {
                left[k] = bench.measured[k] - bench.stated[k] - change[k];
            }
        }
        Some(left)
    }

    /// Measured less simulated, what the sensors have in common taken out.
    fn read(&self, bench: &Bench<'_>) -> Vec<f64> {
        let offset = &bench.noise.columns()[self.sizes.len()];
        self.left.iter().zip(offset).map(|(left, offset)| left - self.offset * offset).collect()
    }

    /// The weighed sum of squares with the price of the numbers.
    fn price(&self, bench: &Bench<'_>, weight: &[f64]) -> f64 {
        let squares: f64 = weight.iter().zip(self.read(bench)).map(|(weight, left)| weight * left.powi(2)).sum();
        squares + self.sizes.iter().chain([&self.offset]).map(|size| size.powi(2)).sum::<f64>()
    }

    /// What is changed here by all that may; `None` where the robot runs away with one of them.
    fn slopes(&self, bench: &Bench<'_>, open: &Open) -> Option<Slopes> {
        // Free play takes dozens of times as long to simulate: with it numbers change what they do as stated.
        if self.parts.iter().any(|part| part.cause.is_play()) {
            return None;
        }
        let scatter = scattered(bench, &self.sizes);
        let own = bench.limbs.of_places(self.parts.iter().map(|part| &part.place));
        let of_value = |k: &(usize, usize)| -> Vec<f64> {
            let nudged = |by: f64| {
                let parts = Some(stepped(bench, &self.parts, *k, by)).filter(|parts| *parts != self.parts)?;
                let there = self.with(bench, &own, parts, self.sizes.clone(), self.offset)?;
                Some(self.left.iter().zip(there.left).map(|(here, there)| (here - there) / by).collect())
            };
            [NUDGE, -NUDGE].into_iter().find_map(nudged).unwrap_or_else(|| vec![0.0; self.left.len()])
        };
        let (uncertain, values) = rayon::join(
            || bench.uncertain(&open.limbs, Logs::Fitted, (&scatter, &changes(bench, &self.parts))),
            || free_values(bench, &self.parts).par_iter().map(of_value).collect::<Vec<_>>(),
        );
        let (all, numbers) = uncertain?;
        let of_number = |k: &usize| numbers.iter().position(|number| *number == bench.numbers[*k]);
        let places = open.numbers.iter().map(of_number).collect::<Option<Vec<usize>>>()?;
        let mut columns: Vec<Vec<f64>> = places.iter().map(|k| all[*k].clone()).collect();
        columns.extend(all.last().cloned());
        columns.extend(values);
        Some(Slopes { columns, numbers: places.len(), has_values: !self.parts.is_empty() })
    }

    /// Goes towards what is best to first order as far as that explains more, and by how much; `None` where it does not.
    fn step(&self, bench: &Bench<'_>, open: &Open, slopes: &Slopes, weight: &[f64]) -> Option<(Self, f64)> {
        let noise = slopes.noise(weight)?;
        // What would be left with the numbers as stated.
        let undone: Vec<f64> = open.numbers.iter().map(|k| -self.sizes[*k]).collect();
        let wanted = noise.sizes(&noise.less(self.left.clone(), &undone));
        let (numbers, rest) = wanted.split_at(slopes.numbers);
        let (offset, values) = rest.split_first()?;
        let here = self.price(bench, weight);
        (0..=HALVINGS).find_map(|halving| {
            let share = 0.5_f64.powi(halving);
            let mut sizes = self.sizes.clone();
            for (k, wanted) in open.numbers.iter().zip(numbers) {
                sizes[*k] += share * (wanted - sizes[*k]);
            }
            let mut parts = self.parts.clone();
            for (k, step) in free_values(bench, &self.parts).into_iter().zip(values) {
                parts = stepped(bench, &parts, k, (share * KNOWN * step).clamp(-LONGEST, LONGEST));
            }
            let there = self.with(bench, &open.limbs, parts, sizes, *offset)?;
            let gained = here - there.price(bench, weight);
            (gained > 0.0).then_some((there, gained))
        })
    }
}

impl Slopes {
    /// What numbers and offset change of the robot as stated.
    fn stated(bench: &Bench<'_>, open: &Open) -> Self {
        let offset = bench.numbers.len();
        let columns = open.numbers.iter().chain([&offset]).map(|k| bench.noise.columns()[*k].clone()).collect();
        Self { columns, numbers: open.numbers.len(), has_values: false }
    }

    /// The noise of which values are one more uncertainty, hardly known before.
    fn noise(&self, weight: &[f64]) -> Option<Noise> {
        let scaled = |(k, column): (usize, &Vec<f64>)| match k <= self.numbers {
            true => column.clone(),
            false => column.iter().map(|change| KNOWN * change).collect(),
        };
        Noise::new(weight.to_vec(), self.columns.iter().enumerate().map(scaled).collect())
    }

    fn covariance(&self, bench: &Bench<'_>) -> Option<DMatrix<f64>> {
        let values = self.numbers + 1..self.columns.len();
        Some(KNOWN.powi(2) * self.noise(&bench.noise.weight)?.covariance(values))
    }
}

/// The robot whose numbers are off by so many of their standard deviations.
fn scattered(bench: &Bench<'_>, sizes: &[f64]) -> Scatter {
    let mut scatter = Scatter::none(bench.case.model());
    let numbers = bench.numbers.iter().zip(sizes);
    numbers.for_each(|(number, size)| scatter.put(*number, size * bench.spreads.sd(*number)));
    scatter
}
