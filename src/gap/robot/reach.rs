//! How far the joints of a robot go in its logs, which gives every cause its typical sizes.

use super::case::{CaseLog, RobotCase};
use super::forward::Predicted;
use crate::gap::hypothesis::reach::mean_period_s;
use crate::joint::{DrivenReach, Reach, Setpoint};
use crate::robot::{Dynamics, State};

/// A torque that so small a share of the time exceeds is no more than a kink of the setpoint \[0 to 1\].
const KINKS: f64 = 0.01;
/// Of so many poses of a motion gravity is looked at in one.
const POSES: usize = 8;

/// How far a joint goes in the logs, by the study's robot.
pub(super) fn reach_of(case: &RobotCase, given: &[Predicted], joint: usize) -> Reach {
    let id = case.model().joint_ids().nth(joint);
    let drive = id.map(|id| case.nominal.joints.drive(id));
    let motor = drive.and_then(|drive| drive.chain.motor.as_ref());
    let mut torques: Vec<f64> = Vec::new();
    let (mut speed_rad_s, mut angle_rad) = (0.1_f64, [f64::INFINITY, f64::NEG_INFINITY]);
    let mut duration_s = 0.1_f64;
    for (log, predicted) in case.logs.iter().zip(given) {
        let begin = log.log.t_s.partition_point(|t| *t < log.log.t_s[0] + 0.4);
        let readings = &predicted.reading_rad[joint][begin..];
        for q in readings {
            angle_rad = [angle_rad[0].min(*q), angle_rad[1].max(*q)];
        }
        speed_rad_s = predicted.rate_rad_s[joint].iter().fold(speed_rad_s, |most, w| most.max(w.abs()));
        duration_s = duration_s.max(log.end_s() - log.log.t_s[0]);
        let Some((motor, id)) = motor.zip(id) else { continue };
        let t_s = &log.log.t_s[begin..];
        let is_on = |t: f64| log.release.is_none_or(|(released, at_s)| released != joint || t < at_s);
        let asked = |k: usize| log.scene.setpoints.at(id, t_s[k]).unwrap_or(readings[k]);
        for k in (1..t_s.len()).filter(|k| is_on(t_s[*k])) {
            let dt_s = t_s[k] - t_s[k - 1];
            let setpoint = Setpoint { angle_rad: asked(k), rate_rad_s: (asked(k) - asked(k - 1)) / dt_s };
            let rate_rad_s = (readings[k] - readings[k - 1]) / dt_s;
            torques.push(motor.unlimited_nm(motor.command(setpoint, readings[k], rate_rad_s, 0.0), 0.0).abs());
        }
    }
    torques.sort_by(f64::total_cmp);
    let gravity_nm =
        case.logs.iter().zip(given).map(|(log, predicted)| gravity_nm(log, predicted, joint)).fold(0.0, f64::max);
    let command_nm = torques.get(((1.0 - KINKS) * torques.len() as f64) as usize).copied().unwrap_or(0.0);
    let period_s = case.logs.first().map_or(0.008, |log| mean_period_s(&log.log.t_s));
    Reach {
        torque_nm: command_nm.max(gravity_nm).max(1e-3),
        coulomb_nm: drive.map_or(0.0, |drive| drive.chain.friction.coulomb_nm),
        inertia_kg_m2: drive.map_or(1e-4, |drive| drive.chain.link.inertia_kg_m2),
        speed_rad_s,
        angle_rad,
        duration_s,
        resolution_rad: case.study.sensor.resolution_rad.unwrap_or(0.0).max(1e-5),
        driven: (command_nm > 0.0).then_some(DrivenReach {
            command_nm,
            speed_rad_s,
            period_s,
            by_setpoint: true,
            by_derivative: false,
            by_integral: false,
        }),
    }
}

/// Gravity's largest torque on a joint that is let go, along a log as predicted \[N m\]; 0 of one that a motor holds.
fn gravity_nm(log: &CaseLog, predicted: &Predicted, joint: usize) -> f64 {
    if log.release.is_none_or(|(released, _)| released != joint) {
        return 0.0;
    }
    let model = &log.scene.model;
    let (mut dynamics, mut state) = (Dynamics::new(model), State::at_rest(model));
    state.base_orientation = log.scene.start.base_orientation;
    let mut bias = vec![0.0_f64; 6 + state.angle_rad.len()];
    let at = |k: usize| {
        state.angle_rad.iter_mut().zip(&predicted.reading_rad).for_each(|(q, readings)| *q = readings[k]);
        dynamics.bias(&state, &mut bias);
        bias[6 + joint].abs()
    };
    (0..predicted.reading_rad[joint].len()).step_by(POSES).map(at).fold(0.0, f64::max)
}
