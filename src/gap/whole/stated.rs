//! A robot's joints as cases of the bench, with the robot as stated to follow motions by that its logs hardly resolve.

use super::numbers::found_robot;
use super::robot::WholeRobot;
use crate::gap::clamped::{ClampedCase, ClampedCaseError, ClampedSetup, SimulatedMotion};
use crate::log::{DriveMode, RobotLog};

/// Instants between which a load is taken as linear lie no further apart \[s\].
const DENSE_S: f64 = 5e-3;

impl ClampedCase {
    /// The case of a robot and its logs.
    ///
    /// # Errors
    /// [`ClampedCaseError`] where a joint's logs make no case.
    pub fn of(setup: &ClampedSetup) -> Result<Self, ClampedCaseError> {
        Self::along(setup, &as_stated(setup))
    }
}

/// Each log as the robot as stated moves under its setpoints, where anything drives it so and it does not run away.
fn as_stated(setup: &ClampedSetup) -> Vec<Option<SimulatedMotion>> {
    let stated = found_robot(setup, None).map_err(|error| error.to_string());
    let robot = stated.and_then(|stated| WholeRobot::of(setup, &stated.numbers, &[]));
    let Ok(mut robot) = robot else { return vec![None; setup.logs.len()] };
    let logs = setup.study.logs.iter().zip(&setup.logs);
    logs.map(|(entry, log)| match entry.drive {
        DriveMode::Position => motion(&mut robot, setup, log),
        _ => None,
    })
    .collect()
}

fn motion(robot: &mut WholeRobot, setup: &ClampedSetup, log: &RobotLog) -> Option<SimulatedMotion> {
    let period_s = (log.t_s.last()? - log.t_s[0]) / (log.len() - 1) as f64;
    let recording = robot.motion(setup, log, period_s / (period_s / DENSE_S).ceil()).ok()?;
    let t_s: Vec<f64> = recording.t_s.clone();
    let joints = log.joints.iter().map(|joint| {
        let id = robot.model.joint(&joint.name).ok()?.index();
        let (angle, rate) = (&recording.angle_rad[id], &recording.rate_rad_s[id]);
        let acceleration = |k: usize| {
            let (from, to) = (k.saturating_sub(1), (k + 1).min(t_s.len() - 1));
            (rate[to] - rate[from]) / (t_s[to] - t_s[from])
        };
        Some((0..t_s.len()).map(|k| [angle[k], rate[k], acceleration(k)]).collect())
    });
    let joints: Vec<Vec<[f64; 3]>> = joints.collect::<Option<_>>()?;
    let readings = robot.read(&recording, log).ok()?;
    Some(SimulatedMotion { t_s, joints, readings })
}
