//! Controller and motor: from a setpoint to the torque on the joint.

use super::Real;
use crate::log::{Derivative, MotorSpec};

/// A setpoint at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Setpoint<T> {
    /// \[rad\]
    pub angle_rad: T,
    /// Its slope \[rad/s\]: zero while a step is held.
    pub rate_rad_s: T,
}

/// The controller with its motor: `tau = kp (q_ref - q) + ki integral - kd dq`, then the limits the engineer models.
#[derive(Clone, Copy, Debug)]
pub struct Motor {
    spec: MotorSpec,
}

impl Motor {
    /// The motor of a log.
    pub fn new(spec: MotorSpec) -> Self {
        Self { spec }
    }

    /// Period at which the law is evaluated \[s\]; `None`: continuously.
    pub fn sample_period_s(&self) -> Option<f64> {
        self.spec.sample_period_s
    }

    /// True where a joint that stands still feels a torque that changes by itself.
    pub(crate) fn winds_up(&self) -> bool {
        self.spec.ki_nm_rad_s != 0.0
    }

    /// Torque on the joint \[N m\]; `integral_rad_s` is the integral of the angle error.
    #[inline]
    pub fn torque_nm<T: Real>(&self, setpoint: Setpoint<T>, angle_rad: T, rate_rad_s: T, integral_rad_s: T) -> T {
        let s = &self.spec;
        let mut torque = (setpoint.angle_rad - angle_rad) * s.kp_nm_rad - rate_rad_s * s.kd_nm_s_rad;
        if s.ki_nm_rad_s != 0.0 {
            torque += integral_rad_s * s.ki_nm_rad_s;
        }
        if s.derivative == Derivative::Error {
            torque += setpoint.rate_rad_s * s.kd_nm_s_rad;
        }
        self.limited_nm(torque, rate_rad_s)
    }

    /// Torque limit, and the linear torque-speed line when driving (not when braking).
    #[inline]
    fn limited_nm<T: Real>(&self, torque_nm: T, rate_rad_s: T) -> T {
        let Some(stall_nm) = self.spec.torque_limit_nm else { return torque_nm };
        let sign = if torque_nm.re() < 0.0 { -1.0 } else { 1.0 };
        let mut limit = T::constant(stall_nm);
        if let Some(w_max) = self.spec.speed_limit_rad_s {
            let driving_speed = rate_rad_s * sign;
            if driving_speed.re() > 0.0 {
                limit = (driving_speed * (-1.0 / w_max) + 1.0) * stall_nm;
                if limit.re() < 0.0 {
                    limit = T::nought();
                }
            }
        }
        if torque_nm.re() * sign > limit.re() { limit * sign } else { torque_nm }
    }

    /// Stiffness and damping that the law adds to the joint \[N m/rad, N m s/rad\], for the choice of the step.
    pub(crate) fn stiffness_and_damping(&self) -> (f64, f64) {
        (self.spec.kp_nm_rad, self.spec.kd_nm_s_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Hold;
    use approx::assert_relative_eq;

    fn spec() -> MotorSpec {
        MotorSpec::pd(5.0, 0.05)
    }

    fn ask(spec: MotorSpec, error: f64, rate: f64) -> f64 {
        Motor::new(spec).torque_nm(Setpoint { angle_rad: error, rate_rad_s: 2.0 }, 0.0, rate, 0.3)
    }

    #[test]
    fn law_is_proportional_integral_and_derivative_on_the_measurement() {
        assert_relative_eq!(ask(spec(), 0.1, 2.0), 0.4, epsilon = 1e-15);
        assert_relative_eq!(ask(MotorSpec { ki_nm_rad_s: 2.0, ..spec() }, 0.1, 2.0), 1.0, epsilon = 1e-15);
    }

    #[test]
    fn derivative_on_the_error_feeds_the_setpoint_rate_forward() {
        let s = MotorSpec { derivative: Derivative::Error, hold: Hold::Linear, ..spec() };
        assert_relative_eq!(ask(s, 0.1, 2.0), 0.5, epsilon = 1e-15);
    }

    #[test]
    fn limits_bite_when_driving_and_not_when_braking() {
        let s = MotorSpec { torque_limit_nm: Some(0.5), speed_limit_rad_s: Some(5.0), ..spec() };
        assert_eq!(ask(s, 1.0, 0.0), 0.5);
        assert_relative_eq!(ask(s, 1.0, 2.5), 0.25, epsilon = 1e-15);
        assert_eq!(ask(s, 1.0, 9.0), 0.0);
        assert_eq!(ask(s, -1.0, 2.5), -0.5);
    }
}
