//! Setpoints as a controller gets them.

use super::wave::Setpoints;
use crate::geometry::robot_file::FRAME_S;
use crate::robot::JointId;

/// A time this share of a period before a frame counts as that frame's: 0.128 / 0.008 is not 16 in binary numbers.
const SAME_FRAME: f64 = 1e-6;

/// What happens between two frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// The setpoint stays until the next frame.
    Hold,
    /// It goes to the next frame's in a straight line.
    Linear,
}

/// Setpoints that are read at a period only.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampled<S> {
    /// What is read.
    pub source: S,
    /// Period of the frames, above 0 \[s\].
    pub period_s: f64,
    /// What happens between two frames.
    pub between: Between,
}

impl<S> Sampled<S> {
    /// Frames of 8 ms joined by lines: the reference walk's.
    pub fn frames(source: S) -> Self {
        Self { source, period_s: FRAME_S, between: Between::Linear }
    }

    /// Frames of a motion file, 128 ms (section 4.2.1).
    pub fn motion_frames(source: S, between: Between) -> Self {
        Self { source, period_s: 0.128, between }
    }
}

impl<S: Setpoints> Setpoints for Sampled<S> {
    fn joints(&self) -> usize {
        self.source.joints()
    }

    fn angle_rad(&self, joint: JointId, t_s: f64) -> f64 {
        let frame = (t_s / self.period_s + SAME_FRAME).floor();
        let here = self.source.angle_rad(joint, frame * self.period_s);
        match self.between {
            Between::Hold => here,
            Between::Linear => {
                let next = self.source.angle_rad(joint, (frame + 1.0) * self.period_s);
                here + (next - here) * (t_s / self.period_s - frame)
            }
        }
    }
}
