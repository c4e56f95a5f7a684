//! The torque that a joint lacks, by inverse dynamics of the measured motion: a joint is blamed for its own fault and not
//! for its neighbour's reaction.

use super::bench::Bench;
use super::case::CaseLog;
use crate::joint::{Contact, Setpoint};
use crate::robot::{Dynamics, State};

/// Samples to either side of the local parabola that smooths what is measured less what the robot as given does.
const HALF: usize = 12;
/// Friction of a joint that is slower says nothing of its torque \[rad/s\].
const STICKS_RAD_S: f64 = 0.02;

/// Residual torque of every joint of the robot along a log of a clamped robot \[N m\]; NaN where a joint sticks. A joint
/// that the log does not have is taken to move as the robot as given.
pub(super) fn residual_torque_nm(bench: &Bench<'_>, index: usize) -> Vec<Vec<f64>> {
    let case = bench.case;
    let log = &case.logs[index];
    let model = &log.scene.model;
    let n = model.joints().len();
    let samples = log.log.len();
    let motion: Vec<Motion> = (0..n).map(|joint| Motion::of(bench, log, index, joint)).collect();
    let mut dynamics = Dynamics::new(model);
    let mut state = State::at_rest(model);
    state.base_orientation = log.scene.start.base_orientation;
    let mut torques = vec![vec![f64::NAN; samples]; n];
    let mut still = State::at_rest(model);
    still.base_orientation = state.base_orientation;
    let (mut acceleration, mut needed) = (vec![0.0; 6 + n], vec![0.0; 6 + n]);
    let mut weight = vec![0.0; 6 + n];
    for (k, &t_s) in log.log.t_s.iter().enumerate() {
        for (joint, motion) in motion.iter().enumerate() {
            state.angle_rad[joint] = motion.angle_rad[k];
            state.rate_rad_s[joint] = motion.rate_rad_s[k];
            still.angle_rad[joint] = motion.angle_rad[k];
            acceleration[6 + joint] = motion.acceleration_rad_s2[k];
        }
        dynamics.inverse(&state, &acceleration, &[], &mut needed);
        dynamics.bias(&still, &mut weight);
        for (joint, id) in model.joint_ids().enumerate() {
            let drive = case.nominal.joints.drive(id);
            let (angle_rad, rate_rad_s) = (state.angle_rad[joint], state.rate_rad_s[joint]);
            let is_off = log.release.is_some_and(|(released, at_s)| released == joint && t_s >= at_s);
            let setpoint_rad = |t: f64| log.scene.setpoints.at(id, t).unwrap_or(angle_rad);
            let rate = (setpoint_rad(t_s + 1e-3) - setpoint_rad(t_s - 1e-3)) / 2e-3;
            let setpoint = Setpoint { angle_rad: setpoint_rad(t_s), rate_rad_s: rate };
            let motor_nm = if is_off { 0.0 } else { drive.chain.motor_nm(t_s, setpoint, [angle_rad, rate_rad_s], 0.0) };
            if rate_rad_s.abs() < STICKS_RAD_S {
                continue;
            }
            let direction = rate_rad_s.signum();
            let friction_nm = drive.resistance_nm(&Contact {
                t_s,
                angle_rad,
                speed_rad_s: rate_rad_s.abs(),
                direction,
                gravity_nm: -weight[6 + joint],
                motor_nm,
            });
            let made_nm = motor_nm + drive.elastic_nm(angle_rad, rate_rad_s) - direction * friction_nm;
            torques[joint][k] = needed[6 + joint] - made_nm;
        }
    }
    torques
}

/// A joint's measured motion, smoothed.
struct Motion {
    angle_rad: Vec<f64>,
    rate_rad_s: Vec<f64>,
    acceleration_rad_s2: Vec<f64>,
}

impl Motion {
    /// What is measured less what the robot as given does is smoothed by local parabolas; the rest is exact.
    fn of(bench: &Bench<'_>, log: &CaseLog, index: usize, joint: usize) -> Self {
        let given = &bench.given_logs[index];
        let (q, w) = (&given.reading_rad[joint], &given.rate_rad_s[joint]);
        let n = log.log.len();
        let dt_s = (log.end_s() - log.log.t_s[0]) / (n - 1) as f64;
        let slope = |k: usize| {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(n - 1));
            (w[after] - w[before]) / (dt_s * (after - before) as f64)
        };
        let left: Option<Vec<f64>> =
            log.measured_rad(joint).map(|measured| measured.iter().zip(q).map(|(m, q)| m - q).collect());
        let mut motion = Self { angle_rad: q.clone(), rate_rad_s: w[..n].to_vec(), acceleration_rad_s2: Vec::new() };
        motion.acceleration_rad_s2 = (0..n).map(slope).collect();
        let Some(left) = left else { return motion };
        for k in 0..n {
            // At the ends the window leans inwards.
            let from = k.saturating_sub(HALF).min(n.saturating_sub(2 * HALF + 1));
            let window = from..(from + 2 * HALF + 1).min(n);
            let [value, rate, acceleration] = parabola(&left, window, k, dt_s);
            motion.angle_rad[k] += value;
            motion.rate_rad_s[k] += rate;
            motion.acceleration_rad_s2[k] += acceleration;
        }
        motion
    }
}

/// Value, slope and curvature at a sample of the parabola that fits a window best; zeros where the window has fewer than
/// the three samples that it takes.
fn parabola(values: &[f64], window: std::ops::Range<usize>, at: usize, dt_s: f64) -> [f64; 3] {
    use nalgebra::{Matrix3, Vector3};
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for k in window {
        let t = (k as f64 - at as f64) * dt_s;
        let row = Vector3::new(1.0, t, 0.5 * t * t);
        normal += row * row.transpose();
        right += row * values[k];
    }
    normal.lu().solve(&right).map_or([0.0; 3], |fit| [fit[0], fit[1], fit[2]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn a_parabola_is_found_off_its_centre_too() {
        let at = |k: usize| 0.3 + 0.5 * (0.01 * k as f64) - 2.0 * (0.01 * k as f64).powi(2);
        let values: Vec<f64> = (0..20).map(at).collect();
        let [value, slope, curvature] = parabola(&values, 2..15, 4, 0.01);
        assert_relative_eq!(value, at(4), epsilon = 1e-12);
        assert_relative_eq!(slope, 0.5 - 4.0 * 0.04, epsilon = 1e-9);
        assert_relative_eq!(curvature, -4.0, epsilon = 1e-7);
    }
}
