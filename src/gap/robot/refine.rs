//! Hypotheses refitted in full: the robot, or the limbs of it that have a cause, is simulated anew at every trial point.

use super::attained::Attained;
use super::bench::{Bench, Logs};
use super::cause::Change;
use super::noise::Weighed;
use super::part::{LONGEST, Part, changes, free_values, left, stepped};
use super::scatter::Scatter;
use super::settle::{Settled, settled};
use super::unseen::Unseen;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// A hypothesis about the robot: some causes, or none.
#[derive(Clone, Debug)]
pub(super) struct Hypothesis {
    pub parts: Vec<Part>,
    /// What it leaves with the uncertain numbers as they are best beside it.
    pub attained: Attained,
    /// Measured less predicted with the numbers as stated.
    pub residual: Vec<f64>,
    /// Values that were searched: part, and place in its values.
    free: Vec<(usize, usize)>,
    /// Their covariance, in units of their scales (of their logarithm where that is searched).
    covariance: Option<DMatrix<f64>>,
}

/// How much is spent on a hypothesis: little on most, more on the best.
#[derive(Clone, Copy)]
struct Effort {
    /// Trial points beside a clamped trunk; on the floor each is a walk.
    clamped: usize,
    on_the_floor: usize,
    /// Clamped: points about which values and numbers then settle together.
    points: usize,
    /// Clamped: the numbers of all limbs, and not of those only that have a cause.
    on_all_limbs: bool,
}

impl Effort {
    fn points(self, bench: &Bench<'_>) -> usize {
        self.points * if bench.case.is_let_go() { TIMES_LET_GO } else { 1 }
    }
}

/// Points about which the robot's numbers alone are fitted at most.
const POINTS: usize = 6;

const ROUGHLY: Effort = Effort { clamped: 14, on_the_floor: 6, points: 1, on_all_limbs: false };
const IN_FULL: Effort = Effort { clamped: 26, on_the_floor: 24, points: 3, on_all_limbs: true };
/// A leg that is let go goes far from what its numbers do to first order: so many times the points.
const TIMES_LET_GO: usize = 3;
/// The same with free play, of which every trial takes as long as dozens of others.
const HUNTING: usize = 12;
/// A step gains less than this, and, where values settle beside the numbers afterwards, than this share of what is left
/// beyond noise: done.
const DONE: f64 = 0.5;
const DONE_OF_REST: f64 = 3e-3;
/// Change of a value for its slope, in units of its scale: on the floor only large changes rise above where feet happen
/// to land, in free play above the joint's hunting.
const NUDGE_SMOOTH: f64 = 0.03;
const NUDGE_ROUGH: f64 = 0.15;
const HALVINGS: usize = 4;

impl Hypothesis {
    /// The study's robot as given, with the uncertain numbers adapted; `None` where a clamped one runs away with these.
    pub fn given(bench: &Bench<'_>) -> Option<Self> {
        let residual = bench.gap();
        let attained = match bench.case.is_clamped() {
            true => {
                let sizes = vec![0.0; bench.numbers.len()];
                let stated = Attained { price: f64::INFINITY, residual: residual.clone(), sizes, offset: 0.0 };
                settled(bench, Vec::new(), &stated, bench.limbs.all(), POINTS)?.attained
            }
            false => to_first_order(bench, &residual),
        };
        Some(Self { parts: Vec::new(), attained, residual, free: Vec::new(), covariance: None })
    }

    /// What settled beside a clamped trunk, with what was known of its values before.
    fn of(bench: &Bench<'_>, settled: Settled, known: Option<DMatrix<f64>>) -> Option<Self> {
        let Settled { parts, attained, covariance } = settled;
        let residual = left(bench, Logs::All, &Scatter::none(bench.case.model()), &parts)?;
        let free = free_values(bench, &parts);
        Some(Self { parts, attained, residual, free, covariance: covariance.or(known) })
    }

    /// Weighed sum of squares over the samples that fits see, the price of the numbers included.
    pub fn loss(&self) -> f64 {
        self.attained.price
    }

    pub fn changes(&self, bench: &Bench<'_>) -> Vec<Change> {
        changes(bench, &self.parts)
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

/// What is attained with numbers that change only what they do to first order.
fn to_first_order(bench: &Bench<'_>, residual: &[f64]) -> Attained {
    let weighed = bench.noise.weigh(residual.to_vec());
    let price = bench.noise.dot(&weighed, &weighed);
    Attained { price, residual: Unseen::of(bench).adapted(residual), sizes: Vec::new(), offset: 0.0 }
}

/// The hypothesis with the best values near those of some parts, numbers of limbs without a cause near those of the robot as
/// given; `None` where the robot runs away there, or it is too late to try.
pub(super) fn refine(bench: &Bench<'_>, given: &Hypothesis, parts: Vec<Part>) -> Option<Hypothesis> {
    refine_by(bench, given, parts, IN_FULL)
}

/// The same with a few trials only.
pub(super) fn refine_roughly(bench: &Bench<'_>, given: &Hypothesis, parts: Vec<Part>) -> Option<Hypothesis> {
    refine_by(bench, given, parts, ROUGHLY)
}

/// What was refined roughly, in full where that explains more.
pub(super) fn refine_on(bench: &Bench<'_>, given: &Hypothesis, rough: Hypothesis) -> Hypothesis {
    let parts = rough.parts.clone();
    let fine = match bench.case.is_clamped() {
        true => settled(bench, parts, &rough.attained, bench.limbs.all(), IN_FULL.points(bench))
            .and_then(|settled| Hypothesis::of(bench, settled, rough.covariance.clone())),
        false => refine(bench, given, parts),
    };
    fine.filter(|fine| fine.loss() < rough.loss()).unwrap_or(rough)
}

fn refine_by(bench: &Bench<'_>, given: &Hypothesis, parts: Vec<Part>, effort: Effort) -> Option<Hypothesis> {
    if bench.deadline.leaves_out("fits of some likely causes") {
        return None;
    }
    let free = free_values(bench, &parts);
    let mut parts = parts;
    for part in &mut parts {
        let parameters = part.parameters(bench);
        for (value, parameter) in part.values.iter_mut().zip(parameters) {
            *value = value.clamp(parameter.lower, parameter.upper);
        }
    }
    let none = Scatter::none(bench.case.model());
    let left = |logs: Logs, parts: &[Part]| left(bench, logs, &none, parts);
    let weighed = left(Logs::Fitted, &parts)?;
    let noise = bench.noise.stiffer(bench.noise.temper(&weighed));
    let residual = |parts: &[Part]| -> Option<Weighed> { Some(noise.weigh(left(Logs::Fitted, parts)?)) };
    let hunts = parts.iter().any(|part| part.cause.is_play());
    let nudge = if bench.case.is_clamped() && !hunts { NUDGE_SMOOTH } else { NUDGE_ROUGH };
    let most = if bench.case.is_clamped() { effort.clamped } else { effort.on_the_floor };
    let most = if hunts { most.min(HUNTING) } else { most };
    let stepped = |parts: &[Part], k: (usize, usize), by: f64| stepped(bench, parts, k, by);
    let mut here = noise.weigh(weighed);
    let mut loss = noise.dot(&here, &here);
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
                Some(noise.weigh(difference.collect()))
            })
        };
        let slopes: Vec<Option<Weighed>> = free.par_iter().map(slope).collect();
        simulations += n;
        let mut gradient = DVector::zeros(n);
        curvature = DMatrix::zeros(n, n);
        for (a, of_a) in slopes.iter().enumerate() {
            let Some(of_a) = of_a else { continue };
            gradient[a] = noise.dot(of_a, &here);
            for (b, of_b) in slopes.iter().enumerate() {
                curvature[(a, b)] = of_b.as_ref().map_or(0.0, |of_b| noise.dot(of_a, of_b));
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
                let then = noise.dot(&there, &there);
                if then < loss {
                    gained = Some(loss - then);
                    (parts, here, loss) = (trial, there, then);
                    damping = f64::max(0.2 * damping, 1e-4);
                    break;
                }
            }
            damping *= 8.0;
        }
        let rest = if bench.case.is_clamped() { (loss - bench.noise.count() as f64).max(0.0) } else { 0.0 };
        if gained.is_none_or(|gained| gained < DONE + DONE_OF_REST * rest) || simulations >= most {
            break;
        }
    }
    let covariance = curvature.try_inverse();
    if !bench.case.is_clamped() {
        let residual = if bench.fits_see_all_logs() { here.column } else { left(Logs::All, &parts)? };
        let attained = to_first_order(bench, &residual);
        return Some(Hypothesis { parts, attained, residual, free, covariance });
    }
    let own = bench.limbs.of_places(parts.iter().map(|part| &part.place));
    let mut from = given.attained.clone();
    let own_sizes = from.sizes.iter_mut().zip(&bench.numbers).filter(|(_, number)| bench.limbs.have(&own, **number));
    own_sizes.for_each(|(size, _)| *size = 0.0);
    let limbs = if effort.on_all_limbs { bench.limbs.all() } else { own };
    let settled = settled(bench, parts, &from, limbs, effort.points(bench))?;
    Hypothesis::of(bench, settled, covariance)
}
