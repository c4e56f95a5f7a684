//! One joint put together from its stages.

use super::{Contact, Friction, Link, Motor, Real};

/// The mechanical side of the chain for one log: link, friction, and the motor that drives it.
pub struct Chain<T: Real> {
    /// Inertia and gravity.
    pub link: Link<T>,
    /// What resists.
    pub friction: Friction<T>,
    /// `None` where no log is driven by position.
    pub motor: Option<Motor>,
}

impl<T: Real> Chain<T> {
    /// Net torque without friction \[N m\] at an angle, for a motor torque.
    #[inline]
    pub fn drive_nm(&self, angle_rad: T, motor_nm: T) -> T {
        motor_nm + self.link.gravity_nm(angle_rad)
    }

    /// Angular acceleration \[rad/s^2\] of a joint that slips in `direction` (3.12).
    #[inline]
    pub fn slip_rate_rad_s2(&self, t_s: T, angle_rad: T, rate_rad_s: T, direction: f64, motor_nm: T) -> T {
        let gravity_nm = self.link.gravity_nm(angle_rad);
        let speed_rad_s = rate_rad_s * direction;
        let at = Contact { t_s, angle_rad, speed_rad_s, direction, gravity_nm, motor_nm };
        (motor_nm + gravity_nm - self.friction.resistance_nm(&at) * direction) / self.link.inertia_kg_m2
    }

    /// Torque that it takes to move a joint at rest in `direction` \[N m\].
    pub fn breakaway_nm(&self, t_s: T, angle_rad: T, direction: f64, motor_nm: T) -> T {
        let gravity_nm = self.link.gravity_nm(angle_rad);
        self.friction.breakaway_nm(&Contact {
            t_s,
            angle_rad,
            speed_rad_s: T::nought(),
            direction,
            gravity_nm,
            motor_nm,
        })
    }

    /// Frequency \[rad/s\] of the fastest oscillation: gravity's, with the controller's stiffness where the motor is on.
    pub(crate) fn fastest_rad_s(&self, motor_on: bool) -> f64 {
        let (kp, _) = self.stiffness_and_damping(motor_on);
        ((self.link.peak_gravity_nm() + kp) / self.link.inertia_kg_m2.re()).sqrt()
    }

    /// The step \[s\] that keeps the fourth-order Runge-Kutta error far below a sensor step.
    ///
    /// A tenth of a radian of the fastest oscillation ([`Chain::fastest_rad_s`], which is the same all along a motion),
    /// or a quarter of the fastest decay: the phase error is then 1e-7 rad per step.
    pub(crate) fn longest_step_s(&self, fastest_rad_s: f64, rate_rad_s: f64, motor_on: bool) -> f64 {
        let (_, kd) = self.stiffness_and_damping(motor_on);
        let speed_rad_s = rate_rad_s.abs();
        let decay_1_s = (self.friction.slope_nm_s_rad(speed_rad_s) + kd) / self.link.inertia_kg_m2.re();
        1.0 / (10.0 * fastest_rad_s).max(4.0 * decay_1_s).max(2.0 * speed_rad_s).max(1.0)
    }

    fn stiffness_and_damping(&self, motor_on: bool) -> (f64, f64) {
        match &self.motor {
            Some(motor) if motor_on => motor.stiffness_and_damping(),
            _ => (0.0, 0.0),
        }
    }
}
