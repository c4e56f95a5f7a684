//! The sensor test of section B.1: a joint set to one place after another, and what its encoder says there.

use super::{Column, Joints, Method, PositionSensor, Recording, Scenario, Setpoints, SimulateError, readings, run};
use crate::log::Hold;
use crate::number::extent;
use crate::robot::{JointId, Model, State};
use serde::Serialize;

/// One measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepPoint {
    /// \[rad\]
    pub setpoint_rad: f64,
    /// Where the joint truly is \[rad\].
    pub angle_rad: f64,
    /// What the encoder says \[rad\].
    pub reading_rad: f64,
}

/// A sweep, and what in it is the sensor's and what the controller's.
#[derive(Clone, Debug, Serialize)]
pub struct Swept {
    /// First and last setpoint \[rad\].
    pub range_rad: [f64; 2],
    /// Measurements.
    pub measurements: usize,
    /// RMS of reading less setpoint \[rad\].
    pub rms_rad: f64,
    /// RMS of reading less true angle: the sensor \[rad\].
    pub sensor_rms_rad: f64,
    /// RMS of true angle less setpoint: the controller under gravity and friction \[rad\].
    pub droop_rms_rad: f64,
    /// Largest of these \[rad\].
    pub droop_worst_rad: f64,
    /// Least and greatest of reading less true angle \[rad\].
    pub sensor_range_rad: [f64; 2],
    /// Share of readings that are not below their setpoint.
    pub not_below: f64,
    /// Setpoints \[rad\].
    #[serde(skip)]
    pub setpoint_rad: Vec<f64>,
    /// Readings \[rad\].
    #[serde(skip)]
    pub reading_rad: Vec<f64>,
    /// True angles \[rad\].
    #[serde(skip)]
    pub angle_rad: Vec<f64>,
}

impl Swept {
    /// Of the measurements of a sweep.
    pub fn of(points: &[SweepPoint]) -> Self {
        let rms = |of: &dyn Fn(&SweepPoint) -> f64| {
            (points.iter().map(|p| of(p).powi(2)).sum::<f64>() / points.len().max(1) as f64).sqrt()
        };
        let not_below = points.iter().filter(|p| p.reading_rad >= p.setpoint_rad - 1e-12).count();
        let column = |of: fn(&SweepPoint) -> f64| points.iter().map(of).collect::<Vec<f64>>();
        let end = |point: Option<&SweepPoint>| point.map_or(f64::NAN, |point| point.setpoint_rad);
        Self {
            range_rad: [end(points.first()), end(points.last())],
            measurements: points.len(),
            rms_rad: rms(&|p| p.reading_rad - p.setpoint_rad),
            sensor_rms_rad: rms(&|p| p.reading_rad - p.angle_rad),
            droop_rms_rad: rms(&|p| p.angle_rad - p.setpoint_rad),
            droop_worst_rad: points.iter().map(|p| (p.angle_rad - p.setpoint_rad).abs()).fold(0.0, f64::max),
            sensor_range_rad: extent(points.iter().map(|p| p.reading_rad - p.angle_rad)),
            not_below: not_below as f64 / points.len().max(1) as f64,
            setpoint_rad: column(|p| p.setpoint_rad),
            reading_rad: column(|p| p.reading_rad),
            angle_rad: column(|p| p.angle_rad),
        }
    }
}

/// Each setpoint is held for so long, and read at the end \[s\].
const HELD_S: f64 = 0.5;

/// Sets a joint to `count` places from `from_rad` to `to_rad`, as far as the software's limits let it, all others at rest
/// and the base as the model has it.
///
/// # Errors
/// [`SimulateError::Value`] for fewer than two places, where the limits leave nothing of the range, or where the motion
/// runs away.
pub fn sweep(
    model: &Model,
    joints: &Joints,
    joint: JointId,
    [from_rad, to_rad]: [f64; 2],
    count: usize,
    (sensor, seed): (PositionSensor, u64),
) -> Result<Vec<SweepPoint>, SimulateError> {
    let wrong = |what, value, allowed| Err(SimulateError::Value { what, value, allowed });
    if !(2..=5000).contains(&count) {
        return wrong("the number of measurements", count as f64, "2 to 5000");
    }
    // The software would clip what is beyond, which is no droop of the controller.
    let within = |angle_rad: f64| match model.joints()[joint.index()].software_rad {
        Some([low, high]) => angle_rad.clamp(low, high),
        None => angle_rad,
    };
    let [first_rad, last_rad] = [from_rad, to_rad].map(within);
    if first_rad == last_rad {
        return wrong(
            "the end of the sweep [rad]",
            to_rad,
            "a sweep that lies within the joint's software limits in part",
        );
    }
    let place = |k: usize| match k + 1 == count {
        true => last_rad,
        false => first_rad + (last_rad - first_rad) * k as f64 / (count - 1) as f64,
    };
    // One more place at the end, so that the last is read before anything changes.
    let t_s: Vec<f64> = (0..=count).map(|k| k as f64 * HELD_S).collect();
    let columns = model
        .joints()
        .iter()
        .enumerate()
        .map(|(j, other)| {
            let rest_rad = other.resting_rad();
            let angle_rad =
                (0..=count).map(|k| if j == joint.index() { place(k.min(count - 1)) } else { rest_rad }).collect();
            Some(Column { angle_rad, on: None })
        })
        .collect();
    let setpoints = Setpoints { t_s, columns, hold: Hold::Step };
    let mut start = State::at_rest(model);
    for id in model.joint_ids() {
        start.angle_rad[id.index()] = setpoints.at(id, 0.0).unwrap_or(0.0);
    }
    let scenario =
        Scenario { model, joints, setpoints: &setpoints, start: &start, surroundings: None, period_s: HELD_S };
    let recording: Recording = run(&scenario, Method::Stiff { step_s: 2e-3 })?;
    if let Some(diverged) = &recording.diverged {
        return wrong("the time until the sweep ran away [s]", diverged.at_s, "a sweep that stays bounded");
    }
    let readings = readings(joints, &recording, sensor, seed);
    let j = joint.index();
    let point = |k: usize| SweepPoint {
        setpoint_rad: place(k),
        angle_rad: recording.angle_rad[j][k + 1],
        reading_rad: readings[j][k + 1],
    };
    Ok((0..count.min(recording.t_s.len().saturating_sub(1))).map(point).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::robot_file::Base;

    #[test]
    fn a_sweep_stays_within_the_software_limits() {
        let model = Model::ers7().with_base(Base::Clamped);
        let joints = Joints::of_thesis(&model).unwrap();
        let joint = model.joint("lf2").unwrap();
        let swept = |range_rad| sweep(&model, &joints, joint, range_rad, 5, (PositionSensor::of(&model), 1));
        let points = swept([-2.0, 2.0]).unwrap();
        // Table A.3.
        assert_eq!((points[0].setpoint_rad, points[4].setpoint_rad), (-0.1745, 1.5359));
        // It begins where it is asked to be: what is left is droop, not what the software clips.
        assert!((points[0].angle_rad - points[0].setpoint_rad).abs() < 0.05, "{points:?}");
        assert!(matches!(swept([-2.0, -1.0]), Err(SimulateError::Value { .. })));
    }
}
