//! How a robot's joints moved along a log: as read, or, where samples are too far apart to follow a motion that a simulation of
//! the robot follows better, as simulated and by as much as the readings differ from that.

use crate::identify::{smooth_along, smooth_along_at};
use crate::log::RobotLog;

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

impl SimulatedMotion {
    /// Whether any joint is followed better by way of this simulation than by what is read, or by way of another.
    pub(in crate::gap) fn follows_better(&self, log: &RobotLog, than: Option<&Self>) -> bool {
        (0..log.joints.len()).any(|place| self.follows(log, place, than))
    }

    /// Whether smoothing keeps so much more of a joint's motion; not where a number is not finite.
    fn follows(&self, log: &RobotLog, place: usize, than: Option<&Self>) -> bool {
        let rival = than.map_or(f64::INFINITY, |than| lost(log, place, Some(than)));
        lost(log, place, Some(self)) < FOLLOWS * FOLLOWS * lost(log, place, None).min(rival)
    }
}

/// The motion of a log's joints at common instants.
pub(super) struct Followed<'a> {
    log: &'a RobotLog,
    simulated: Option<&'a SimulatedMotion>,
}

impl<'a> Followed<'a> {
    /// By way of a simulation only where that follows any joint better.
    pub fn new(log: &'a RobotLog, simulated: Option<&'a SimulatedMotion>) -> Self {
        Self { log, simulated: simulated.filter(|simulated| simulated.follows_better(log, None)) }
    }

    /// Whether any joint is followed by way of a simulation.
    pub fn is_simulated(&self) -> bool {
        self.simulated.is_some()
    }

    /// The instants \[s\].
    pub fn t_s(&self) -> &'a [f64] {
        self.simulated.map_or(&self.log.t_s, |simulated| &simulated.t_s)
    }

    /// Angle, rate and acceleration of a joint at each instant; `None` where the log does not have it.
    pub fn joint(&self, name: &str) -> Option<Vec<[f64; 3]>> {
        let place = self.log.joints.iter().position(|joint| joint.name == name)?;
        let smooth = |q: &[f64]| smooth_along_at(&self.log.t_s, q, self.t_s());
        let Some(simulated) = self.simulated.filter(|simulated| simulated.follows(self.log, place, None)) else {
            return Some(smooth(&self.log.joints[place].q_rad));
        };
        let beyond = smooth(&beyond(self.log, place, Some(simulated)));
        let pairs = simulated.joints[place].iter().zip(beyond);
        Some(pairs.map(|(motion, beyond)| [0, 1, 2].map(|k| motion[k] + beyond[k])).collect())
    }
}

/// Squares that smoothing takes from a joint's readings, or from what they are beyond a simulation \[rad^2\].
fn lost(log: &RobotLog, place: usize, simulated: Option<&SimulatedMotion>) -> f64 {
    let q = beyond(log, place, simulated);
    let smooth = smooth_along(&log.t_s, &q);
    q.iter().zip(smooth).map(|(q, [smooth, ..])| (q - smooth).powi(2)).sum()
}

/// What a joint reads, beyond a simulation where there is one.
fn beyond(log: &RobotLog, place: usize, simulated: Option<&SimulatedMotion>) -> Vec<f64> {
    let read = &log.joints[place].q_rad;
    match simulated {
        None => read.clone(),
        Some(simulated) => read.iter().zip(&simulated.readings[place]).map(|(q, simulated)| q - simulated).collect(),
    }
}
