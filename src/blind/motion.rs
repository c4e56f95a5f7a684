//! Setpoints of driven logs: steps, sweeps, minimum-jerk moves, sums of sines.

use super::dice::{Dice, significant};
use super::joint::Joint;
use crate::number::math;
use std::f64::consts::TAU;

/// Draws a motion: the instants at which the setpoint changes \[s\], and its values from there on \[rad\].
///
/// It begins with a rest, changes on sample times only, and moves by 0.2 to 1.2 rad.
pub(super) fn motion(joint: &Joint, times_s: &[f64], dice: &mut Dice) -> Vec<(f64, f64)> {
    let end_s = times_s.last().copied().unwrap_or(0.0);
    let rest_s = dice.uniform(0.05, 0.4);
    let amplitude = dice.uniform(0.2, 1.2);
    let curve = Curve::draw(rest_s, end_s, amplitude, dice);
    let mut changes: Vec<(f64, f64)> = Vec::new();
    for t_s in times_s.iter().step_by(joint.setpoint_every) {
        let value = significant(curve.at(*t_s), 4);
        let value = if value.abs() < 1e-5 { 0.0 } else { value };
        if changes.last().is_none_or(|(_, last)| *last != value) {
            changes.push((*t_s, value));
        }
    }
    changes
}

/// A smooth or stepped course, zero until it begins.
enum Curve {
    /// From each instant on, that value.
    Steps(Vec<(f64, f64)>),
    /// From each instant, a move of so long to that value.
    Moves(Vec<(f64, f64, f64)>),
    /// Amplitude, lowest and highest frequency \[Hz\], from, length \[s\].
    Sweep([f64; 5]),
    /// From this instant, amplitudes and frequencies \[Hz\].
    Sines(f64, Vec<(f64, f64)>),
}

impl Curve {
    fn draw(rest_s: f64, end_s: f64, amplitude: f64, dice: &mut Dice) -> Self {
        match dice.whole(0, 3) {
            0 => {
                let mut steps = Vec::new();
                let mut t = rest_s;
                while t < end_s {
                    steps.push((t, dice.uniform(-1.0, 1.0) * amplitude));
                    t += dice.uniform(0.4, 1.2);
                }
                if let Some(first) = steps.first_mut() {
                    first.1 = amplitude * dice.sign();
                }
                Curve::Steps(steps)
            }
            1 => {
                let mut moves = Vec::new();
                let (mut t, mut side) = (rest_s, dice.sign());
                while t < end_s {
                    let lasts = dice.uniform(0.3, 1.0);
                    moves.push((t, lasts, side * amplitude * dice.uniform(0.4, 1.0)));
                    side = -side;
                    t += lasts + if dice.chance(0.5) { dice.uniform(0.1, 0.5) } else { 0.0 };
                }
                Curve::Moves(moves)
            }
            2 => {
                let (low, high) = (dice.uniform(0.15, 0.4), dice.uniform(1.2, 3.0));
                // no drive follows a wide motion at a high rate
                Curve::Sweep([amplitude.min(1.6 / high), low, high, rest_s, end_s - rest_s])
            }
            _ => {
                let count = dice.whole(3, 5);
                let sines: Vec<(f64, f64)> =
                    (0..count).map(|_| (dice.uniform(0.3, 1.0) * dice.sign(), dice.log_uniform(0.2, 2.5))).collect();
                let sum: f64 = sines.iter().map(|(a, _)| a.abs()).sum();
                Curve::Sines(rest_s, sines.into_iter().map(|(a, f)| (1.3 * amplitude * a / sum, f)).collect())
            }
        }
    }

    fn at(&self, t_s: f64) -> f64 {
        match self {
            Curve::Steps(steps) => steps.iter().rev().find(|(from, _)| t_s >= *from).map_or(0.0, |(_, value)| *value),
            Curve::Moves(moves) => {
                let mut value = 0.0;
                for (from, lasts, to) in moves {
                    let s = ((t_s - from) / lasts).clamp(0.0, 1.0);
                    value += (to - value) * s.powi(3) * (10.0 + s * (6.0 * s - 15.0));
                }
                value
            }
            Curve::Sweep([a, low, high, from, lasts]) => {
                let t = (t_s - from).max(0.0);
                // the frequency rises as a geometric series
                let rate = math::ln(high / low) / lasts;
                a * math::sin(TAU * low / rate * (math::exp(rate * t) - 1.0))
            }
            Curve::Sines(from, sines) => {
                let t = (t_s - from).max(0.0);
                sines.iter().map(|(a, f)| a * math::sin(TAU * f * t)).sum()
            }
        }
    }
}
