//! One joint put together from its stages.

use super::{Contact, EndStop, Friction, Link, Motor, Play, Real, Setpoint, SetpointPath, Spring};

/// The joint of one log: what the setpoint passes through, motor, link, friction, and what the encoder makes of it.
///
/// [`Chain::new`] makes a perfect one; effects put their terms on its stages.
pub struct Chain<T: Real> {
    /// When and how often setpoints reach the controller.
    pub setpoint: SetpointPath<T>,
    /// `None` where nothing drives the joint.
    pub motor: Option<Motor<T>>,
    /// Free play between motor side and link.
    pub play: Option<Play<T>>,
    /// Inertia and gravity.
    pub link: Link<T>,
    /// What resists.
    pub friction: Friction<T>,
    /// A spring in parallel to the joint.
    pub spring: Option<Spring<T>>,
    /// A stop at one end of the range.
    pub stop: Option<EndStop<T>>,
    /// Reading per true angle; 1 for a perfect encoder. The controller sees the reading.
    pub sensor_gain: T,
}

impl<T: Real> Chain<T> {
    /// A joint that is perfect but for its friction.
    pub fn new(link: Link<T>, friction: Friction<T>, motor: Option<Motor<T>>) -> Self {
        Self {
            setpoint: SetpointPath::default(),
            motor,
            play: None,
            link,
            friction,
            spring: None,
            stop: None,
            sensor_gain: T::constant(1.0),
        }
    }

    /// Torque of spring and stop \[N m\].
    #[inline]
    fn elastic_nm(&self, angle_rad: T, rate_rad_s: T) -> T {
        let mut torque_nm = T::nought();
        if let Some(spring) = &self.spring {
            torque_nm += spring.torque_nm(angle_rad);
        }
        if let Some(stop) = &self.stop {
            torque_nm += stop.torque_nm(angle_rad, rate_rad_s);
        }
        torque_nm
    }

    /// Torque of gravity, spring and stop \[N m\].
    #[inline]
    pub fn passive_nm(&self, angle_rad: T, rate_rad_s: T) -> T {
        self.link.gravity_nm(angle_rad) + self.elastic_nm(angle_rad, rate_rad_s)
    }

    /// Net torque on a resting joint without friction \[N m\] at an angle, for a motor torque.
    #[inline]
    pub fn drive_nm(&self, angle_rad: T, motor_nm: T) -> T {
        motor_nm + self.passive_nm(angle_rad, T::nought())
    }

    /// Torque that resists motion in `direction` \[N m\].
    #[inline]
    pub fn resistance_nm(&self, t_s: T, angle_rad: T, speed_rad_s: T, direction: f64, motor_nm: T) -> T {
        let gravity_nm = self.link.gravity_nm(angle_rad);
        self.friction.resistance_nm(&Contact { t_s, angle_rad, speed_rad_s, direction, gravity_nm, motor_nm })
    }

    /// Angular acceleration \[rad/s^2\] of a joint that slips in `direction` (3.12).
    #[inline]
    pub fn slip_rate_rad_s2(&self, t_s: T, angle_rad: T, rate_rad_s: T, direction: f64, motor_nm: T) -> T {
        let gravity_nm = self.link.gravity_nm(angle_rad);
        let speed_rad_s = rate_rad_s * direction;
        let at = Contact { t_s, angle_rad, speed_rad_s, direction, gravity_nm, motor_nm };
        let passive_nm = gravity_nm + self.elastic_nm(angle_rad, rate_rad_s);
        (motor_nm + passive_nm - self.friction.resistance_nm(&at) * direction) / self.link.inertia_kg_m2
    }

    /// The torque that the motor's law asks of it and that arrives \[N m\], at a true angle and rate.
    #[inline]
    pub fn motor_nm(&self, setpoint: Setpoint<T>, angle_rad: T, rate_rad_s: T, integral_rad_s: T) -> T {
        let Some(motor) = &self.motor else { return T::nought() };
        let (reading_rad, reading_rad_s) = (angle_rad * self.sensor_gain, rate_rad_s * self.sensor_gain);
        motor.delivered_nm(motor.command_nm(setpoint, reading_rad, reading_rad_s, integral_rad_s), rate_rad_s)
    }

    /// The torque that arrives of one that a log commands \[N m\].
    #[inline]
    pub fn delivered_nm(&self, command_nm: T, rate_rad_s: T) -> T {
        self.motor.as_ref().map_or(command_nm, |motor| motor.delivered_nm(command_nm, rate_rad_s))
    }

    /// Torque that it takes to move a joint at rest in `direction` \[N m\].
    pub fn breakaway_nm(&self, t_s: T, angle_rad: T, direction: f64, motor_nm: T) -> T {
        self.resistance_nm(t_s, angle_rad, T::nought(), direction, motor_nm)
    }

    /// Frequency \[rad/s\] of the fastest oscillation: gravity's, with the controller's stiffness where the motor is on.
    pub(crate) fn fastest_rad_s(&self, motor_on: bool) -> f64 {
        let (kp, _) = self.stiffness_and_damping(motor_on);
        let spring = self.spring.as_ref().map_or(0.0, |spring| spring.stiffness_nm_rad.re().abs());
        ((self.link.peak_gravity_nm() + kp + spring) / self.link.inertia_kg_m2.re()).sqrt()
    }

    /// The step \[s\] that keeps the fourth-order Runge-Kutta error far below a sensor step.
    ///
    /// A tenth of a radian of the fastest oscillation ([`Chain::fastest_rad_s`], which is the same all along a motion),
    /// or a quarter of the fastest decay: the phase error is then 1e-7 rad per step. Near a stop its stiffness counts.
    pub(crate) fn longest_step_s(&self, fastest_rad_s: f64, angle_rad: f64, rate_rad_s: f64, motor_on: bool) -> f64 {
        let (_, kd) = self.stiffness_and_damping(motor_on);
        let speed_rad_s = rate_rad_s.abs();
        let inertia = self.link.inertia_kg_m2.re();
        let decay_1_s = (self.friction.slope_nm_s_rad(speed_rad_s) + kd) / inertia;
        let step_s = 1.0 / (10.0 * fastest_rad_s).max(4.0 * decay_1_s).max(2.0 * speed_rad_s).max(1.0);
        match &self.stop {
            Some(stop) => {
                let contact_s = stop.longest_step_s(inertia);
                // Away from the stop a step may not run into it by more than a contact's step would.
                let distance_s = stop.distance_rad(angle_rad) / speed_rad_s.max(1e-9);
                if distance_s <= 0.0 { step_s.min(contact_s) } else { step_s.min(distance_s.max(contact_s)) }
            }
            None => step_s,
        }
    }

    fn stiffness_and_damping(&self, motor_on: bool) -> (f64, f64) {
        match &self.motor {
            Some(motor) if motor_on => motor.stiffness_and_damping(),
            _ => (0.0, 0.0),
        }
    }
}
