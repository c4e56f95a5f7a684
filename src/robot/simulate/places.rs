//! Where a robot is after a step.

use crate::robot::State;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// A rotation by an angle about an axis, both in one vector. Steps are small: below 0.02 rad five terms of sine and
/// cosine are exact to rounding.
fn turned_by(turn_rad: Vector3<f64>) -> UnitQuaternion<f64> {
    let square = 0.25 * turn_rad.norm_squared();
    if square > 1e-4 {
        return UnitQuaternion::from_scaled_axis(turn_rad);
    }
    let sine = 1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0));
    let cosine = 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0));
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cosine, turn_rad * (0.5 * sine)))
}

/// Places after `h` at the base's velocity and the joints' rates.
pub(super) fn shift(out: &mut State, from: &State, h: f64, rate: impl Fn(usize) -> f64) {
    out.base_position_m = from.base_position_m + from.base_velocity_m_s * h;
    out.base_orientation = from.base_orientation * turned_by(from.base_rate_rad_s * h);
    for (j, angle) in out.angle_rad.iter_mut().enumerate() {
        *angle = from.angle_rad[j] + h * rate(j);
    }
}

/// Place of the base after `h` at the mean of two velocities.
pub(super) fn shift_mean(out: &mut State, from: &State, to: &State, h: f64) {
    out.base_position_m = from.base_position_m + (from.base_velocity_m_s + to.base_velocity_m_s) * (0.5 * h);
    let turn = (from.base_rate_rad_s + to.base_rate_rad_s) * (0.5 * h);
    out.base_orientation = from.base_orientation * turned_by(turn);
}

/// Velocities after `h` at the accelerations `k`.
pub(super) fn add_velocity(out: &mut State, from: &State, h: f64, k: &[f64]) {
    out.base_velocity_m_s = from.base_velocity_m_s + Vector3::new(k[0], k[1], k[2]) * h;
    out.base_rate_rad_s = from.base_rate_rad_s + Vector3::new(k[3], k[4], k[5]) * h;
    for (j, rate) in out.rate_rad_s.iter_mut().enumerate() {
        *rate = from.rate_rad_s[j] + h * k[6 + j];
    }
}
