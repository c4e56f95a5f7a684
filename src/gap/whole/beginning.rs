//! Where a log without holes begins: readings smoothed, and from there on as the robot follows its first samples best.
//!
//! Rates out of a few readings are as rough as these. A joint on a soft servo swings from there for a second, which would be
//! told as a cause.

use super::noise::{LEAST_NOISE_RAD, mean_square};
use super::robot::{Beginning, Stretch, WholeRobot};
use crate::fit::correlation_length;
use crate::gap::clamped::ClampedSetup;
use crate::gap::hypothesis::reach::mean_period_s;
use crate::identify::{best_window, smooth_along};
use crate::log::RobotLog;
use nalgebra::{DMatrix, DVector};

/// The first samples by which a beginning is told \[s\].
const EARLY_S: f64 = 0.6;
/// Steps of Gauss and Newton, halvings of one that leaves more, and the share of the squares that is worth another.
const STEPS: usize = 3;
const HALVINGS: i32 = 3;
const WORTH_A_STEP: f64 = 0.01;
/// A reading may be off by so many times the noise, and a rate by that within the time along which it was smoothed, beside what
/// it gains in that time: \[s\], or samples where those take longer.
const OFF: f64 = 3.0;
const SMOOTHED_S: f64 = 0.02;
const SMOOTHED: f64 = 3.0;
/// Change of each for what it does, in what it may be off.
const NUDGE: f64 = 0.05;

/// What is read where a log begins.
fn as_read(log: &RobotLog) -> Beginning {
    let first = |q_rad: &[f64]| {
        let [angle_rad, rate_rad_s, _] = smooth_along(&log.t_s, q_rad)[0];
        [angle_rad, rate_rad_s]
    };
    log.joints.iter().map(|joint| first(&joint.q_rad)).collect()
}

impl WholeRobot {
    /// Where a log begins so that the robot follows its first samples best, near what is read.
    pub(super) fn beginning(&mut self, setup: &ClampedSetup, log: &RobotLog) -> Beginning {
        let read = as_read(log);
        let early = Early::of(log);
        let mut best = read.clone();
        let Some(mut left) = early.left(self, setup, &best) else { return best };
        for _ in 0..STEPS {
            // What is left is taken as noise that hangs together: a robot that is another than this one bends no beginning far.
            let weight =
                |(row, noise): (&Vec<f64>, &f64)| (correlation_length(row) * mean_square(row).max(*noise)).recip();
            let weights: Vec<f64> = left.iter().zip(&early.noise_rad2).map(weight).collect();
            let strained = |at: &Beginning| {
                let both = at.iter().flatten().zip(read.iter().flatten()).zip(early.off.iter().flatten());
                both.map(|((at, read), off)| (at - read) / off).collect::<Vec<f64>>()
            };
            let price = |left: &[Vec<f64>], at: &Beginning| {
                let rows =
                    weights.iter().zip(left).map(|(weight, row)| weight * row.iter().map(|r| r * r).sum::<f64>());
                rows.sum::<f64>() + strained(at).iter().map(|x| x * x).sum::<f64>()
            };
            let Some(step) = early.step(self, setup, (&best, &left), &weights, &strained(&best)) else { break };
            let before = price(&left, &best);
            let along = |share: f64| -> Beginning {
                let moved = |(at, by): ([f64; 2], &[f64; 2])| [at[0] + share * by[0], at[1] + share * by[1]];
                best.iter().copied().zip(&step).map(moved).collect()
            };
            let better = (0..=HALVINGS).find_map(|halving| {
                let there = along(0.5_f64.powi(halving));
                let left = early.left(self, setup, &there)?;
                let price = price(&left, &there);
                (price < before).then_some((there, left, price))
            });
            let Some((there, now, price)) = better else { break };
            (best, left) = (there, now);
            if price > (1.0 - WORTH_A_STEP) * before {
                break;
            }
        }
        best
    }
}

/// The first samples of a log.
struct Early<'a> {
    log: &'a RobotLog,
    samples: usize,
    /// Variance of each joint's readings.
    noise_rad2: Vec<f64>,
    /// By how much what is read of each joint may be off.
    off: Beginning,
}

impl<'a> Early<'a> {
    fn of(log: &'a RobotLog) -> Self {
        let samples = log.t_s.partition_point(|t| *t <= log.t_s[0] + EARLY_S);
        let smoothed_s = SMOOTHED_S.max(SMOOTHED * mean_period_s(&log.t_s));
        let of_joint = |q_rad: &Vec<f64>| {
            let variance = best_window(&log.t_s, q_rad).1.max(LEAST_NOISE_RAD.powi(2));
            let first = log.t_s.iter().zip(smooth_along(&log.t_s, q_rad));
            let first = first.take_while(|(t, _)| **t <= log.t_s[0] + 2.0 * smoothed_s);
            let most_rad_s2 = first.map(|(_, [_, _, acceleration])| acceleration.abs()).fold(0.0, f64::max);
            let off_rad = OFF * variance.sqrt();
            (variance, [off_rad, off_rad / smoothed_s + most_rad_s2 * smoothed_s])
        };
        let (noise_rad2, off) = log.joints.iter().map(|joint| of_joint(&joint.q_rad)).unzip();
        Self { log, samples, noise_rad2, off }
    }

    /// Measured less simulated of each joint \[rad\].
    fn left(&self, robot: &mut WholeRobot, setup: &ClampedSetup, from: &Beginning) -> Option<Vec<Vec<f64>>> {
        let until_s = self.log.t_s[0] + EARLY_S;
        let stretch = Stretch::searched(mean_period_s(&self.log.t_s), until_s);
        let recording = robot.motion(setup, self.log, from, &stretch).ok()?;
        let read = robot.read(&recording, self.log).ok()?;
        let rows = self.log.joints.iter().zip(read);
        let left: Vec<Vec<f64>> = rows
            .map(|(joint, read)| joint.q_rad.iter().zip(read).take(self.samples).map(|(a, b)| a - b).collect())
            .collect();
        left.iter().flatten().all(|left| left.is_finite()).then_some(left)
    }

    /// The step to what is best to first order.
    fn step(
        &self,
        robot: &mut WholeRobot,
        setup: &ClampedSetup,
        (here, left): (&Beginning, &[Vec<f64>]),
        weights: &[f64],
        strained: &[f64],
    ) -> Option<Beginning> {
        let n = 2 * here.len();
        let off: Vec<f64> = self.off.iter().flatten().copied().collect();
        // In what each may be off.
        let mut columns = Vec::with_capacity(n);
        for k in 0..n {
            let mut there = here.clone();
            there[k / 2][k % 2] += NUDGE * off[k];
            let moved = self.left(robot, setup, &there)?;
            let rows = left.iter().zip(moved).zip(weights);
            let change = rows.flat_map(|((before, after), weight)| {
                before.iter().zip(after).map(|(a, b)| weight.sqrt() * (a - b) / NUDGE).collect::<Vec<f64>>()
            });
            columns.push(DVector::from_vec(change.collect()));
        }
        let target = left.iter().zip(weights).flat_map(|(row, weight)| row.iter().map(|r| weight.sqrt() * r));
        let target = DVector::from_iterator(columns.first()?.len(), target);
        let columns = DMatrix::from_columns(&columns);
        let normal = columns.tr_mul(&columns) + DMatrix::identity(n, n);
        let falls = columns.tr_mul(&target) - DVector::from_column_slice(strained);
        let step = normal.cholesky()?.solve(&falls);
        Some((0..here.len()).map(|j| [0, 1].map(|k| step[2 * j + k] * off[2 * j + k])).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::whole::found_robot;
    use std::path::Path;

    /// MuJoCo's chirp begins at rest at 0; its payload is not described, so that this robot would follow better from elsewhere.
    #[test]
    fn an_arm_at_rest_begins_at_rest_though_another_robot_would_follow_it_better() {
        let study = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/logs/loaded_arm/study.toml"));
        let setup = ClampedSetup::read(study).unwrap();
        let mut robot = WholeRobot::of(&setup, &found_robot(&setup, None).unwrap().numbers, &[]).unwrap();
        let chirp = setup.logs.iter().find(|log| log.file.ends_with("chirp.csv")).unwrap();
        let found = robot.beginning(&setup, chirp);
        assert!(found.iter().all(|[angle, rate]| angle.abs() < 1e-3 && rate.abs() < 0.1), "{found:?}");
    }
}
