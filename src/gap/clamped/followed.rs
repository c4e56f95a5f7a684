//! How a robot's joints moved along a log: as read, or, where the samples are too far apart to follow a motion that the robot
//! as stated makes as well, as simulated and by as much as the readings differ from that.

use crate::identify::{smooth_along, smooth_along_at};
use crate::log::{JointColumns, RobotLog};

/// What is read is followed by way of a simulation where that leaves less than this share of what stays without it.
const FOLLOWS: f64 = 0.7;

/// The motion of a log's joints as a simulation makes it, at instants of its own.
#[derive(Clone, Debug)]
pub struct SimulatedMotion {
    /// Along the log's time, denser than its samples \[s\].
    pub t_s: Vec<f64>,
    /// Of each of the log's joints, in its order: angle, rate and acceleration \[rad, rad/s, rad/s^2; or m\].
    pub joints: Vec<Vec<[f64; 3]>>,
    /// What each of them reads at the log's samples \[rad or m\].
    pub readings: Vec<Vec<f64>>,
}

/// The motion of a log's joints at common instants.
pub(super) struct Followed<'a> {
    log: &'a RobotLog,
    simulated: Option<&'a SimulatedMotion>,
}

impl<'a> Followed<'a> {
    /// By way of a simulation only where that follows any joint better.
    pub fn new(log: &'a RobotLog, simulated: Option<&'a SimulatedMotion>) -> Self {
        let follows = |simulated: &&SimulatedMotion| {
            log.joints.iter().zip(&simulated.readings).any(|(joint, readings)| is_followed(log, joint, readings))
        };
        Self { log, simulated: simulated.filter(follows) }
    }

    /// The instants \[s\].
    pub fn t_s(&self) -> &'a [f64] {
        self.simulated.map_or(&self.log.t_s, |simulated| &simulated.t_s)
    }

    /// Angle, rate and acceleration of a joint at each instant; `None` where the log does not have it.
    pub fn joint(&self, name: &str) -> Option<Vec<[f64; 3]>> {
        let place = self.log.joints.iter().position(|joint| joint.name == name)?;
        let joint = &self.log.joints[place];
        let smooth = |q: &[f64]| smooth_along_at(&self.log.t_s, q, self.t_s());
        let Some(simulated) = self.simulated else { return Some(smooth(&joint.q_rad)) };
        let readings = &simulated.readings[place];
        if !is_followed(self.log, joint, readings) {
            return Some(smooth(&joint.q_rad));
        }
        let beyond = smooth(&differences(&joint.q_rad, readings));
        let pairs = simulated.joints[place].iter().zip(beyond);
        Some(pairs.map(|(motion, beyond)| [0, 1, 2].map(|k| motion[k] + beyond[k])).collect())
    }
}

/// Whether smoothing keeps more of a joint's motion by way of a simulation.
fn is_followed(log: &RobotLog, joint: &JointColumns, readings: &[f64]) -> bool {
    let lost = |q: &[f64]| {
        let smooth = smooth_along(&log.t_s, q);
        q.iter().zip(smooth).map(|(q, [smooth, ..])| (q - smooth).powi(2)).sum::<f64>()
    };
    lost(&differences(&joint.q_rad, readings)) < FOLLOWS * FOLLOWS * lost(&joint.q_rad)
}

fn differences(read: &[f64], simulated: &[f64]) -> Vec<f64> {
    read.iter().zip(simulated).map(|(read, simulated)| read - simulated).collect()
}
