//! A walk as its recording shows it: how far the trunk went on its floor, which feet were down, and how far the setpoints
//! were from the gait.

use super::{BaseSample, Recording};
use crate::number::extent;
use crate::robot::{BodyId, Dynamics, Floor, Gait, Model, Setpoints as _, State};
use serde::Serialize;

/// The bobbing is measured after the first second of walking \[s\].
const BOB_AFTER_S: f64 = 1.0;
/// A foot that is up for less has only bounced \[s\].
const UP_S: f64 = 0.04;
/// A joint that a gait moves by less is not moved by it \[rad\].
const STILL_RAD: f64 = 1e-4;

/// How far the trunk went.
#[derive(Clone, Debug, Serialize)]
pub struct Walked {
    /// The walk begins, and is measured from then to the end \[s\].
    pub from_s: f64,
    /// Forward, horizontally \[m\].
    pub displacement_m: f64,
    /// To the right \[m\].
    pub drift_m: f64,
    /// To the left about the vertical \[rad\].
    pub turn_rad: f64,
    /// Forward, on average \[m/s\].
    pub speed_m_s: f64,
    /// Between the trunk's lowest and highest place over the floor, the walk's first second left out \[m\].
    pub bob_m: f64,
    /// Of the trunk's centre over the floor when the walk begins \[m\].
    pub height_m: f64,
    /// Steps: how often the robot's first foot, the left front one, came down on the floor.
    pub steps: usize,
    /// Largest angle between the trunk's vertical axis and the floor's normal since the walk began \[rad\].
    pub tilt_rad: f64,
}

impl Walked {
    /// From a time to the end; `None` where nothing was recorded after it.
    pub fn of(floor: &Floor, model: &Model, recording: &Recording, from_s: f64) -> Option<Self> {
        let after = |t_s: f64| recording.t_s.partition_point(|t| *t < t_s - 1e-6);
        let first = after(from_s);
        let (from, to) = (recording.base.get(first)?, recording.base.last()?);
        let span_s = recording.t_s.last()? - recording.t_s[first];
        if !(span_s > 0.0) {
            return None;
        }
        let bob_from = after(from_s + BOB_AFTER_S.min(0.5 * span_s));
        let heights = recording.base[bob_from..].iter().map(|base| -floor.depth_m(&base.position_m));
        let [low, high] = extent(heights);
        let went = to.position_m - from.position_m;
        let turned = to.roll_pitch_yaw_rad()[2] - from.roll_pitch_yaw_rad()[2];
        Some(Self {
            from_s: recording.t_s[first],
            displacement_m: -went.z,
            drift_m: went.x,
            turn_rad: turned,
            speed_m_s: -went.z / span_s,
            bob_m: high - low,
            height_m: -floor.depth_m(&from.position_m),
            steps: Footfalls::of(floor, model, recording)
                .feet
                .first()
                .map_or(0, |(_, down)| landings(&recording.t_s, down, from_s)),
            tilt_rad: recording.base[first..].iter().map(|base| tilt_rad(floor, base)).fold(0.0, f64::max),
        })
    }
}

/// Which feet are on the floor.
#[derive(Clone, Debug)]
pub struct Footfalls {
    /// \[s\]
    pub t_s: Vec<f64>,
    /// Each foot's name, and whether it is down at each time.
    pub feet: Vec<(String, Vec<bool>)>,
}

impl Footfalls {
    /// Sample by sample.
    pub fn of(floor: &Floor, model: &Model, recording: &Recording) -> Self {
        let (mut dynamics, mut state) = (Dynamics::new(model), State::at_rest(model));
        let name = |body: BodyId| model.bodies()[body.index()].name.clone();
        let is_foot = |body: &BodyId| model.bodies()[body.index()].touches_floor();
        // A body may touch at several points; it is down where one of them is.
        let mut bodies: Vec<BodyId> = floor.bodies().filter(is_foot).collect();
        bodies.dedup();
        let mut feet: Vec<(String, Vec<bool>)> = bodies.iter().map(|body| (name(*body), Vec::new())).collect();
        for k in 0..recording.t_s.len() {
            recording.state_at(k, &mut state);
            feet.iter_mut().for_each(|(_, down)| down.push(false));
            for (body, point) in floor.lowest_points(dynamics.motions(&state)) {
                let foot = bodies.iter().position(|foot| *foot == body);
                if let Some(down) = foot.and_then(|foot| feet[foot].1.last_mut()) {
                    *down |= floor.depth_m(&point) > 0.0;
                }
            }
        }
        Self { t_s: recording.t_s.clone(), feet }
    }
}

/// The trunk over time.
#[derive(Clone, Debug)]
pub struct TrunkCurves {
    /// \[s\]
    pub t_s: Vec<f64>,
    /// From the start \[m\].
    pub forward_m: Vec<f64>,
    /// From the start \[m\].
    pub right_m: Vec<f64>,
    /// Over the floor \[m\].
    pub height_m: Vec<f64>,
}

impl TrunkCurves {
    /// From where it began; `None` where nothing was recorded.
    pub fn of(floor: &Floor, recording: &Recording) -> Option<Self> {
        let begin = recording.base.first()?.position_m;
        let of = |f: fn(&nalgebra::Vector3<f64>) -> f64| -> Vec<f64> {
            recording.base.iter().map(|base| f(&(base.position_m - begin))).collect()
        };
        Some(Self {
            t_s: recording.t_s.clone(),
            forward_m: of(|p| -p.z),
            right_m: of(|p| p.x),
            height_m: recording.base.iter().map(|base| -floor.depth_m(&base.position_m)).collect(),
        })
    }
}

/// Angle between the trunk's vertical axis and the floor's normal at a sample \[rad\].
pub fn tilt_rad(floor: &Floor, base: &BaseSample) -> f64 {
    (base.orientation * nalgebra::Vector3::y()).angle(&floor.normal())
}

/// Root mean square of setpoints less gait while it walks, over the joints that it moves \[rad\].
pub fn distortion_rad(gait: &Gait, model: &Model, recording: &Recording) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for id in model.joint_ids() {
        let still = (0..=50).all(|k| {
            let t_s = gait.stand_s() + gait.period_s() * (1.0 + f64::from(k) / 50.0);
            (gait.angle_rad(id, t_s) - gait.angle_rad(id, 0.0)).abs() < STILL_RAD
        });
        if still {
            continue;
        }
        for (t, asked) in recording.t_s.iter().zip(&recording.setpoint_rad[id.index()]) {
            if *t > gait.stand_s() {
                sum += (asked - gait.angle_rad(id, *t)).powi(2);
                count += 1;
            }
        }
    }
    (sum / f64::from(count.max(1))).sqrt()
}

/// How often a foot came down after it had been up for a while, from a time on.
fn landings(t_s: &[f64], down: &[bool], from_s: f64) -> usize {
    let (mut up_since_s, mut count) = (None, 0);
    for (t, is_down) in t_s.iter().zip(down).filter(|(t, _)| **t >= from_s) {
        if !is_down {
            up_since_s = up_since_s.or(Some(*t));
        } else if up_since_s.take().is_some_and(|since_s| t - since_s > UP_S) {
            count += 1;
        }
    }
    count
}
