//! How a robot's joints moved along a log: as read, or, where a simulation of the robot follows samples better which are left
//! out, as simulated and by as much as the readings differ from that: smoothed along wider windows, because it moves less, and
//! because samples may be too far apart for what moves more.

use crate::identify::{best_window, smooth_along_at};
use crate::log::RobotLog;

/// What is read is followed by way of a simulation where that misses samples by less than this share of the squares.
const FOLLOWS: f64 = 0.9;

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

    /// Whether a joint is followed so much better; not where a number is not finite.
    fn follows(&self, log: &RobotLog, place: usize, than: Option<&Self>) -> bool {
        let missed = |simulated| best_window(&log.t_s, &beyond(log, place, simulated)).1;
        let rival = than.map_or(f64::INFINITY, |than| missed(Some(than)));
        missed(Some(self)) < FOLLOWS * missed(None).min(rival)
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
        let smooth = |q: &[f64]| smooth_along_at(&self.log.t_s, q, self.t_s(), best_window(&self.log.t_s, q).0);
        let Some(simulated) = self.simulated.filter(|simulated| simulated.follows(self.log, place, None)) else {
            return Some(smooth(&self.log.joints[place].q_rad));
        };
        let beyond = smooth(&beyond(self.log, place, Some(simulated)));
        let pairs = simulated.joints[place].iter().zip(beyond);
        Some(pairs.map(|(motion, beyond)| [0, 1, 2].map(|k| motion[k] + beyond[k])).collect())
    }
}

/// What a joint reads, beyond a simulation where there is one.
fn beyond(log: &RobotLog, place: usize, simulated: Option<&SimulatedMotion>) -> Vec<f64> {
    let read = &log.joints[place].q_rad;
    match simulated {
        None => read.clone(),
        Some(simulated) => read.iter().zip(&simulated.readings[place]).map(|(q, simulated)| q - simulated).collect(),
    }
}
