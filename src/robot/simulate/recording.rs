//! What a run leaves behind.

use crate::integrate::Counts;
use crate::number::math;
use crate::robot::{JointId, State};
use nalgebra::{UnitQuaternion, Vector3};

/// The base at a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseSample {
    /// World axes \[m\].
    pub position_m: Vector3<f64>,
    /// Body to world.
    pub orientation: UnitQuaternion<f64>,
    /// What an accelerometer at its centre feels, body axes: acceleration less gravity \[m/s^2\].
    pub felt_m_s2: Vector3<f64>,
}

impl BaseSample {
    /// Roll about z, pitch about x, yaw about y \[rad\]: `R = Ry(yaw) Rx(pitch) Rz(roll)`.
    pub fn roll_pitch_yaw_rad(&self) -> [f64; 3] {
        let r = self.orientation.to_rotation_matrix();
        let r = r.matrix();
        [
            math::atan2(r[(1, 0)], r[(1, 1)]),
            math::asin((-r[(1, 2)]).clamp(-1.0, 1.0)),
            math::atan2(r[(0, 2)], r[(2, 2)]),
        ]
    }
}

/// A joint that was faster than its limit (Table A.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedWarning {
    /// The joint.
    pub joint: JointId,
    /// First sample beyond the limit \[s\].
    pub from_s: f64,
    /// Samples beyond it.
    pub samples: usize,
    /// Largest speed \[rad/s\].
    pub peak_rad_s: f64,
    /// The limit \[rad/s\].
    pub limit_rad_s: f64,
}

/// A motion that ran away.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the simulation diverged at t = {at_s:.4} s{}: {why}", joint_name.as_ref().map_or(String::new(), |name| format!(", joint {name} first")))]
pub struct Diverged {
    /// When \[s\].
    pub at_s: f64,
    /// The joint that ran away first; `None`: the base.
    pub joint: Option<JointId>,
    /// Its name.
    pub joint_name: Option<String>,
    /// What may help.
    pub why: String,
}

/// Samples of a run, by joint and then by time.
#[derive(Clone, Debug)]
pub struct Recording {
    /// \[s\]
    pub t_s: Vec<f64>,
    /// True angles \[rad\].
    pub angle_rad: Vec<Vec<f64>>,
    /// \[rad/s\]
    pub rate_rad_s: Vec<Vec<f64>>,
    /// As the table has it, clipped \[rad\]; NaN where a joint has no setpoint.
    pub setpoint_rad: Vec<Vec<f64>>,
    /// What the motor delivers \[N m\].
    pub motor_nm: Vec<Vec<f64>>,
    /// The base.
    pub base: Vec<BaseSample>,
    /// Joints beyond their speed limits, in joint order.
    pub warnings: Vec<SpeedWarning>,
    /// Joints whose setpoints were clipped to their limits.
    pub clipped: Vec<JointId>,
    /// Where the motion ran away; the samples before are kept.
    pub diverged: Option<Diverged>,
    /// Evaluations of the robot's equations of motion and steps.
    pub counts: Counts,
    /// The state at the end.
    pub end: State,
}

impl Recording {
    /// A joint's angle between two samples, by the cubic through angles and rates \[rad\]; NaN beyond the recording.
    pub fn angle_at_rad(&self, joint: JointId, t_s: f64) -> f64 {
        let j = joint.index();
        let k = self.t_s.partition_point(|t| *t <= t_s);
        if k == self.t_s.len() && self.t_s.last() == Some(&t_s) {
            return self.angle_rad[j][k - 1];
        }
        if k == 0 || k >= self.t_s.len() {
            return f64::NAN;
        }
        let (t0, t1) = (self.t_s[k - 1], self.t_s[k]);
        let (q0, q1) = (self.angle_rad[j][k - 1], self.angle_rad[j][k]);
        let h = t1 - t0;
        let (m0, m1) = (self.rate_rad_s[j][k - 1] * h, self.rate_rad_s[j][k] * h);
        let x = (t_s - t0) / h;
        let y = 1.0 - x;
        q0 * (1.0 + 2.0 * x) * y * y + m0 * x * y * y + q1 * x * x * (3.0 - 2.0 * x) - m1 * x * x * y
    }

    /// Places at a sample; the velocities of `state` stay.
    ///
    /// # Panics
    /// Where there is no such sample, or the state is another model's.
    pub fn state_at(&self, sample: usize, state: &mut State) {
        let base = &self.base[sample];
        (state.base_position_m, state.base_orientation) = (base.position_m, base.orientation);
        for (angle, column) in state.angle_rad.iter_mut().zip(&self.angle_rad) {
            *angle = column[sample];
        }
    }
}
