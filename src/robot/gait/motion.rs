//! A motion: angles at times for each joint, as Tekkotsu plays them.

use super::wave::Setpoints;
use crate::robot::{JointId, Model};

/// A key: when \[ms\] and which angle \[rad\].
pub(super) type Key = (u32, f64);

/// Keys of each joint. Between two of its keys a joint goes in a straight line; before the first and after the last it
/// stays; a joint without keys stays at 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    pub(super) keys: Vec<Vec<Key>>,
}

impl Motion {
    /// Shortest delay between frames of a motion file that the robot bears \[ms\] (section 4.2.1; at 96 ms it crashed).
    pub const FRAME_MS: u32 = 128;

    /// Setpoints at every frame from 0 until the end, the last frame not before it. Keys that lie on the line between
    /// their neighbours because nothing moves there are left out.
    ///
    /// `frame_ms` is at least 1.
    pub fn of(source: &impl Setpoints, model: &Model, frame_ms: u32, end_s: f64) -> Self {
        let frame_ms = frame_ms.max(1);
        let frames = (end_s.max(0.0) * 1e3 / f64::from(frame_ms) - 1e-6).ceil().max(0.0) as u32;
        let key = |joint, frame: u32| {
            let ms = frame * frame_ms;
            (ms, source.angle_rad(joint, f64::from(ms) * 1e-3))
        };
        let keys = model.joint_ids().take(source.joints()).map(|joint| {
            let all: Vec<Key> = (0..=frames).map(|frame| key(joint, frame)).collect();
            let still = |k: usize| k > 0 && k + 1 < all.len() && all[k - 1].1 == all[k].1 && all[k + 1].1 == all[k].1;
            (0..all.len()).filter(|&k| !still(k)).map(|k| all[k]).collect()
        });
        Self { keys: keys.collect() }
    }

    /// Time of the last key \[s\].
    pub fn end_s(&self) -> f64 {
        let last = self.keys.iter().filter_map(|keys| keys.last()).map(|key| key.0).max();
        f64::from(last.unwrap_or(0)) * 1e-3
    }
}

impl Setpoints for Motion {
    fn joints(&self) -> usize {
        self.keys.len()
    }

    fn angle_rad(&self, joint: JointId, t_s: f64) -> f64 {
        let (keys, ms) = (&self.keys[joint.index()], t_s * 1e3);
        let next = keys.partition_point(|key| f64::from(key.0) <= ms);
        match (next.checked_sub(1).map(|k| keys[k]), keys.get(next)) {
            (Some((_, angle)), None) | (None, Some(&(_, angle))) => angle,
            (Some((from, low)), Some(&(to, high))) => {
                low + (high - low) * (ms - f64::from(from)) / f64::from(to - from)
            }
            (None, None) => 0.0,
        }
    }
}
