//! How well joints follow their setpoints: "without any delay or amplitude difference" (4.2), as numbers.

use super::Recording;
use crate::number::math;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{PI, TAU};

/// A joint against its setpoint, at the frequency of the gait.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follow {
    /// Place of the joint in the model's order.
    pub joint: usize,
    /// Amplitude of the setpoint's fundamental \[rad\].
    pub amplitude_rad: f64,
    /// Amplitude of the joint's fundamental, in units of the setpoint's.
    pub ratio: f64,
    /// How much later the joint is \[s\]; negative: earlier.
    pub delay_s: f64,
    /// Root mean square of setpoint less angle \[rad\].
    pub rms_rad: f64,
    /// Largest difference \[rad\].
    pub worst_rad: f64,
}

/// A setpoint that moves less than this does not move \[rad\].
const STILL_RAD: f64 = 1e-4;

/// Compares every joint that is moved with its setpoint, over the last whole periods from `from_s` on.
///
/// `readings` are what the encoders say, by joint.
pub fn follow(recording: &Recording, readings: &[Vec<f64>], frequency_hz: f64, from_s: f64) -> Vec<Follow> {
    let Some(last_s) = recording.t_s.last() else { return Vec::new() };
    let periods = ((last_s - from_s) * frequency_hz + 1e-6).floor();
    let begin_s = if periods >= 1.0 { last_s - periods / frequency_hz } else { from_s };
    // A whole number of periods holds each phase equally often: the end belongs to the next one.
    let within: Vec<usize> =
        (0..recording.t_s.len()).filter(|k| (begin_s - 1e-9..last_s - 1e-9).contains(&recording.t_s[*k])).collect();
    let one = |joint: usize| {
        let fundamental = |column: &[f64]| {
            let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
            for k in &within {
                let phase = TAU * frequency_hz * recording.t_s[*k];
                let row = Vector3::new(math::cos(phase), math::sin(phase), 1.0);
                normal += row * row.transpose();
                right += row * column[*k];
            }
            let fit = normal.lu().solve(&right)?;
            Some((math::hypot(fit[0], fit[1]), math::atan2(fit[1], fit[0])))
        };
        let (asked, found) = (fundamental(&recording.setpoint_rad[joint])?, fundamental(&readings[joint])?);
        if !(asked.0 > STILL_RAD) {
            return None;
        }
        let lag = (found.1 - asked.1 + PI).rem_euclid(TAU) - PI;
        let errors = || within.iter().map(|k| recording.setpoint_rad[joint][*k] - readings[joint][*k]);
        Some(Follow {
            joint,
            amplitude_rad: asked.0,
            ratio: found.0 / asked.0,
            delay_s: lag / (TAU * frequency_hz),
            rms_rad: (errors().map(|e| e * e).sum::<f64>() / within.len() as f64).sqrt(),
            worst_rad: errors().fold(0.0, |most, e| most.max(e.abs())),
        })
    };
    (0..readings.len().min(recording.setpoint_rad.len())).filter_map(one).collect()
}
