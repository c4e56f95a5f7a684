//! What a joint's own stages do at one instant, and how that changes with angle, rate and time.

use super::JointDrive;
use crate::joint::{Contact, Motor};
use crate::pendulum::Command;

/// Where a joint is.
#[derive(Clone, Copy)]
pub(super) struct At {
    pub t_s: f64,
    pub angle_rad: f64,
    pub rate_rad_s: f64,
    /// Integral of the controller's error \[rad s\].
    pub integral_rad_s: f64,
}

const MORE_THAN_ANY_MOTOR_NM: f64 = 1e12;
/// Nudges for slopes of what bends; the stages are straight lines between their kinks.
const ANGLE_NUDGE_RAD: f64 = 1e-6;
const RATE_NUDGE_RAD_S: f64 = 1e-6;
const TIME_NUDGE_S: f64 = 1e-6;

/// Slopes of the torque without friction.
#[derive(Clone, Copy, Default)]
pub(super) struct Slopes {
    /// `-d tau / d q`, not below 0 \[N m/rad\].
    pub stiffness: f64,
    /// `-d tau / d w`, not below 0 \[N m s/rad\].
    pub damping: f64,
    /// `d tau / d t` \[N m/s\].
    pub per_time: f64,
}

impl JointDrive {
    /// Torque that the motor delivers \[N m\].
    #[inline]
    pub(super) fn motor_nm(&self, command: Command<f64>, at: At) -> f64 {
        command.motor_nm(&self.chain, at.t_s, &[at.angle_rad - self.zero_rad, at.rate_rad_s, at.integral_rad_s])
    }

    /// The answer of the law, before gain and limits; zero where the motor is off.
    pub(super) fn asked(&self, command: Command<f64>, at: At) -> f64 {
        let Some(setpoint) = command.setpoint(at.t_s) else { return 0.0 };
        let rate_rad_s = at.rate_rad_s * self.chain.sensor_gain;
        self.chain
            .motor
            .as_ref()
            .map_or(0.0, |motor| motor.command(setpoint, self.reading_rad(at.angle_rad), rate_rad_s, at.integral_rad_s))
    }

    /// Setpoint less reading \[rad\].
    #[inline]
    pub(super) fn error_rad(&self, command: Command<f64>, t_s: f64, angle_rad: f64) -> f64 {
        command.error_rad(&self.chain, t_s, angle_rad - self.zero_rad)
    }

    /// Whether a law that acts continuously may ask for more than the motor has.
    pub(super) fn may_saturate(&self, command: Command<f64>) -> bool {
        matches!(command, Command::Pid { .. }) && self.chain.motor.as_ref().is_some_and(Motor::is_limited)
    }

    /// Torque that the motor would deliver had it no limits \[N m\].
    pub(super) fn unlimited_nm(&self, command: Command<f64>, at: At) -> f64 {
        self.chain.motor.as_ref().map_or(0.0, |motor| motor.unlimited_nm(self.asked(command, at), at.rate_rad_s))
    }

    /// All that the motor has in a direction \[N m\], with its sign.
    pub(super) fn most_nm(&self, direction: f64, rate_rad_s: f64) -> f64 {
        self.chain.delivered_nm(direction * MORE_THAN_ANY_MOTOR_NM, rate_rad_s)
    }

    /// How that falls with speed.
    pub(super) fn most_slopes(&self, direction: f64, rate_rad_s: f64) -> Slopes {
        let by = self.most_nm(direction, rate_rad_s + RATE_NUDGE_RAD_S) - self.most_nm(direction, rate_rad_s);
        Slopes { damping: -by / RATE_NUDGE_RAD_S, ..Slopes::default() }.kept()
    }

    /// Slopes of a torque of the motor that is `motor_nm` there, by nudges.
    pub(super) fn motor_slopes(command: Command<f64>, at: At, motor_nm: f64, torque_nm: impl Fn(At) -> f64) -> Slopes {
        let by = |at: At| torque_nm(at) - motor_nm;
        Slopes {
            stiffness: -by(At { angle_rad: at.angle_rad + ANGLE_NUDGE_RAD, ..at }) / ANGLE_NUDGE_RAD,
            damping: -by(At { rate_rad_s: at.rate_rad_s + RATE_NUDGE_RAD_S, ..at }) / RATE_NUDGE_RAD_S,
            per_time: if command.is_still() { 0.0 } else { by(At { t_s: at.t_s + TIME_NUDGE_S, ..at }) / TIME_NUDGE_S },
        }
        .kept()
    }

    /// Slopes of the motor's torque where that is a straight line in angle, rate and time, limits aside that are told
    /// to be; `None` where something bends it.
    pub(super) fn straight_slopes(&self, command: Command<f64>, is_limit_aside: bool) -> Option<Slopes> {
        let chain = &self.chain;
        let Some(motor) = &chain.motor else { return Some(Slopes::default()) };
        let is_read_as_it_is = chain.sensor_gain == 1.0 && chain.eccentric.is_none() && chain.sensor_delay_s.is_none();
        let is_bent = chain.has_laws() || motor.dead_band.is_some() || motor.is_limited() && !is_limit_aside;
        if is_bent || !is_read_as_it_is {
            return None;
        }
        let setpoint_rad_s = match command {
            Command::Pid { curve: Some(_), .. } => return None,
            Command::Pid { slope_rad_s, .. } => slope_rad_s,
            Command::Off | Command::Torque(_) | Command::Held { .. } => 0.0,
        };
        let (stiffness, damping) = motor.stiffness_and_damping(command.driven());
        Some(Slopes { stiffness, damping, per_time: stiffness * setpoint_rad_s }.kept())
    }

    /// Slopes of springs and stops.
    pub(super) fn elastic_slopes(&self, angle_rad: f64, rate_rad_s: f64) -> Slopes {
        if self.spring.is_none() && self.stops.is_empty() && self.chain.spring.is_none() && self.chain.stop.is_none() {
            return Slopes::default();
        }
        let here = self.elastic_nm(angle_rad, rate_rad_s);
        Slopes {
            stiffness: (here - self.elastic_nm(angle_rad + ANGLE_NUDGE_RAD, rate_rad_s)) / ANGLE_NUDGE_RAD,
            damping: (here - self.elastic_nm(angle_rad, rate_rad_s + RATE_NUDGE_RAD_S)) / RATE_NUDGE_RAD_S,
            per_time: 0.0,
        }
        .kept()
    }

    /// Friction that resists motion in a direction \[N m\].
    #[inline]
    pub(super) fn friction_nm(&self, at: At, direction: f64, gravity_nm: f64, motor_nm: f64) -> f64 {
        let speed_rad_s = (at.rate_rad_s * direction).max(0.0);
        self.resistance_nm(&Contact {
            t_s: at.t_s,
            angle_rad: at.angle_rad,
            speed_rad_s,
            direction,
            gravity_nm,
            motor_nm,
        })
    }
}

impl Slopes {
    /// Only what resists is taken along implicitly.
    fn kept(self) -> Self {
        Self { stiffness: self.stiffness.max(0.0), damping: self.damping.max(0.0), ..self }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            stiffness: self.stiffness + other.stiffness,
            damping: self.damping + other.damping,
            per_time: self.per_time + other.per_time,
        }
    }
}
