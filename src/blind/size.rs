//! How much a cause matters in the logs of a study.

use super::dice::Dice;
use super::mechanism::Mechanism;
use super::plan::LogPlan;
use super::sim::{Machine, Trace, simulate};
use crate::number::math;
use nalgebra::{DMatrix, DVector};

/// Step while sizes are sought \[s\].
const COARSE_S: f64 = 2.5e-4;
/// Change of a number for its effect on the logs, as a share.
const NUDGE: f64 = 0.01;
/// The same for the angle at the start \[rad\] and its speed \[rad/s\].
const START_NUDGE: [f64; 2] = [1e-3, 1e-2];

/// Moves a joint through all logs.
pub(super) fn all_logs(machine: &Machine, plans: &[LogPlan], longest_s: f64) -> Vec<Trace> {
    plans.iter().enumerate().map(|(i, plan)| simulate(machine, plan, i, longest_s)).collect()
}

/// Moves a joint through all logs, in steps good enough to judge by.
pub(super) fn coarse(machine: &Machine, plans: &[LogPlan]) -> Vec<Trace> {
    all_logs(machine, plans, COARSE_S)
}

/// RMS difference of two motions after the release \[rad\].
pub(super) fn rms_rad(a: &[Trace], b: &[Trace], plans: &[LogPlan]) -> f64 {
    let (mut sum, mut count) = (0.0, 0_usize);
    for ((a, b), plan) in a.iter().zip(b).zip(plans) {
        let from = plan.first_free();
        sum += a.q_rad.iter().zip(&b.q_rad).skip(from).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        count += a.q_rad.len() - from;
    }
    (sum / count.max(1) as f64).sqrt()
}

/// RMS speed of a motion after the release \[rad/s\].
pub(super) fn rms_speed_rad_s(traces: &[Trace], plans: &[LogPlan]) -> f64 {
    let (mut sum, mut count) = (0.0, 0_usize);
    for (trace, plan) in traces.iter().zip(plans) {
        let steps = plan.times_s.windows(2).zip(trace.q_rad.windows(2)).skip(plan.first_free());
        for (t, q) in steps {
            sum += ((q[1] - q[0]) / (t[1] - t[0])).powi(2);
            count += 1;
        }
    }
    (sum / count.max(1) as f64).sqrt()
}

/// A joint with which nothing is the matter, as the measure of what is.
pub(super) struct Yardstick<'a> {
    plans: &'a [LogPlan],
    noise_rad: f64,
    /// The motion without the cause.
    pub plain: Vec<Trace>,
    /// Change of every log with the four numbers ...
    by_number: [Vec<Trace>; 4],
    /// ... and with angle and speed at its start.
    by_start: [Vec<Trace>; 2],
}

impl<'a> Yardstick<'a> {
    /// Simulates the joint without the cause, and how the four numbers and the starts would change that.
    pub(super) fn new(machine: &Machine, plans: &'a [LogPlan], noise_rad: f64) -> Self {
        let nudged = |k: usize| {
            let mut other = machine.clone();
            let up = 1.0 + NUDGE;
            match k {
                0 => other.inertia_kg_m2 *= up,
                1 => other.peak_gravity_nm *= up,
                2 => other.friction.coulomb_nm *= up,
                _ => other.friction.viscous_nm_s_rad *= up,
            }
            coarse(&other, plans)
        };
        let started = |k: usize| {
            let mut other = plans.to_vec();
            for plan in &mut other {
                match k {
                    0 => plan.start_rad += START_NUDGE[0],
                    _ => plan.start_rad_s += START_NUDGE[1],
                }
            }
            coarse(machine, &other)
        };
        Self {
            plans,
            noise_rad,
            plain: coarse(machine, plans),
            by_number: [nudged(0), nudged(1), nudged(2), nudged(3)],
            by_start: [started(0), started(1)],
        }
    }

    /// Moves a joint through the logs, in steps good enough to judge by.
    pub(super) fn move_all(&self, machine: &Machine) -> Vec<Trace> {
        coarse(machine, self.plans)
    }

    /// RMS difference of two motions after the release, over the noise.
    pub(super) fn ratio(&self, a: &[Trace], b: &[Trace]) -> f64 {
        rms_rad(a, b, self.plans) / self.noise_rad
    }

    /// What of [`Yardstick::ratio`] is left when numbers and starts are adapted to the difference, to first order.
    pub(super) fn left(&self, a: &[Trace], b: &[Trace]) -> f64 {
        self.left_beside(a, b, &[])
    }

    /// [`Yardstick::left`] when also any mixture of other motions' differences from the plain one may be added.
    pub(super) fn left_beside(&self, a: &[Trace], b: &[Trace], others: &[Vec<Trace>]) -> f64 {
        let shapes: Vec<&Vec<Trace>> = self.by_number.iter().chain(others).collect();
        let n = shapes.len();
        let (mut normal, mut right) = (DMatrix::<f64>::zeros(n, n), DVector::<f64>::zeros(n));
        let (mut rest, mut count) = (0.0, 0_usize);
        for (i, plan) in self.plans.iter().enumerate() {
            let column = |other: &[Trace], from: &[Trace]| -> Vec<f64> {
                let pairs = other[i].q_rad.iter().zip(&from[i].q_rad);
                pairs.skip(plan.first_free()).map(|(x, y)| x - y).collect()
            };
            let mut starts = [column(&self.by_start[0], &self.plain), column(&self.by_start[1], &self.plain)];
            let (first, second) = starts.split_at_mut(1);
            normalise(&mut first[0]);
            without(&mut second[0], &first[0]);
            normalise(&mut second[0]);
            let cleaned = |mut column: Vec<f64>| {
                without(&mut column, &starts[0]);
                without(&mut column, &starts[1]);
                column
            };
            let difference = cleaned(column(a, b));
            let columns: Vec<Vec<f64>> = shapes.iter().map(|shape| cleaned(column(shape, &self.plain))).collect();
            for j in 0..n {
                right[j] += dot(&columns[j], &difference);
                for k in 0..=j {
                    normal[(j, k)] += dot(&columns[j], &columns[k]);
                }
            }
            rest += dot(&difference, &difference);
            count += difference.len();
        }
        // each shape to length one; two that are the same are no trouble, only a singular matrix
        let lengths: Vec<f64> = (0..n).map(|k| normal[(k, k)].sqrt().max(1e-9)).collect();
        for j in 0..n {
            right[j] /= lengths[j];
            for k in 0..=j {
                let value = normal[(j, k)] / (lengths[j] * lengths[k]);
                (normal[(j, k)], normal[(k, j)]) = (value, value);
            }
            normal[(j, j)] += 1e-8;
        }
        if let Some(solution) = normal.cholesky().map(|c| c.solve(&right)) {
            rest -= solution.dot(&right);
        }
        (rest.max(0.0) / count.max(1) as f64).sqrt() / self.noise_rad
    }

    /// How a mechanism may change the plain motion: at a smaller and at a larger size.
    pub(super) fn shapes(&self, mechanism: &Mechanism, machine: &Machine) -> [Vec<Trace>; 2] {
        [0.35, 0.7].map(|share| {
            let [low, high] = mechanism.range;
            let mut other = machine.clone();
            mechanism.install(low * math::powf(high / low, share), &mut other);
            coarse(&other, self.plans)
        })
    }

    /// A size for a mechanism, and the motion with it: as nature has it, or so that it changes the logs by `wanted`.
    ///
    /// Half of the sizes are natural, unless they are out of `allowed`; the other half is sought between the smallest
    /// and the largest plausible. `None` where no plausible size is within `allowed`.
    pub(super) fn size(
        &self,
        mechanism: &Mechanism,
        machine: &Machine,
        wanted: [f64; 2],
        allowed: [f64; 2],
        dice: &mut Dice,
    ) -> Option<f64> {
        let ratio_of = |size: f64| {
            let mut other = machine.clone();
            mechanism.install(size, &mut other);
            self.ratio(&coarse(&other, self.plans), &self.plain)
        };
        let is_allowed = |ratio: f64| within(ratio, allowed);
        let [mut low, mut high] = mechanism.range;
        let natural = dice.log_uniform(low, high);
        let target = dice.log_uniform(wanted[0], wanted[1]);
        let at_natural = ratio_of(natural);
        if dice.chance(0.5) && is_allowed(at_natural) {
            return Some(natural);
        }
        if at_natural > target {
            high = natural;
        } else {
            low = natural;
        }
        let mut best: Option<(f64, f64)> = None;
        let mut size = natural;
        let mut ratio = at_natural;
        for step in 0..8 {
            if step > 0 {
                size = (low * high).sqrt();
                ratio = ratio_of(size);
                if ratio > target {
                    high = size;
                } else {
                    low = size;
                }
            }
            let off = math::ln(ratio / target).abs();
            if is_allowed(ratio) && best.is_none_or(|(_, least)| off < least) {
                best = Some((size, off));
            }
            if off < 0.1 {
                break;
            }
        }
        best.map(|(size, _)| size)
    }
}

/// Whether a ratio lies in a range, its ends included.
pub(super) fn within(ratio: f64, [low, high]: [f64; 2]) -> bool {
    ratio >= low && ratio <= high
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// To length one; a column of nothing stays so.
fn normalise(column: &mut [f64]) {
    let length = dot(column, column).sqrt();
    if length > 1e-12 {
        column.iter_mut().for_each(|x| *x /= length);
    } else {
        column.fill(0.0);
    }
}

/// Takes a unit column's share out.
fn without(column: &mut [f64], unit: &[f64]) {
    let share = dot(column, unit);
    column.iter_mut().zip(unit).for_each(|(x, u)| *x -= share * u);
}
