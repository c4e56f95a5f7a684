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

/// Nudges for slopes of what bends; the stages are straight lines between their kinks.
const ANGLE_NUDGE_RAD: f64 = 1e-6;
const RATE_NUDGE_RAD_S: f64 = 1e-6;
const TIME_NUDGE_S: f64 = 1e-6;

/// Slopes of the torque without friction.
#[derive(Clone, Copy, Debug, Default)]
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
        let Some((setpoint, motor)) = command.setpoint(at.t_s).zip(self.chain.motor.as_ref()) else { return 0.0 };
        let [reading_rad, reading_rad_s] = self.chain.reading(at.t_s, at.angle_rad - self.zero_rad, at.rate_rad_s);
        motor.command(setpoint, reading_rad, reading_rad_s, at.integral_rad_s)
    }

    /// Setpoint less reading \[rad\].
    #[inline]
    pub(super) fn error_rad(&self, command: Command<f64>, t_s: f64, angle_rad: f64) -> f64 {
        command.error_rad(&self.chain, t_s, angle_rad - self.zero_rad)
    }

    /// Whether less may arrive than a law asks for that acts continuously.
    pub(super) fn may_bend(&self, command: Command<f64>) -> bool {
        matches!(command, Command::Pid { .. }) && self.chain.motor.as_ref().is_some_and(Motor::bends)
    }

    /// Slopes of a torque of the motor that is `motor_nm` there.
    pub(super) fn motor_slopes(&self, command: Command<f64>, at: At, motor_nm: f64) -> Slopes {
        let Some(motor) = &self.chain.motor else { return Slopes::default() };
        let straight = (!motor.bends()).then(|| motor.stiffness_and_damping(command.driven()));
        self.slopes(command, at, straight, motor_nm, |at| self.motor_nm(command, at)).kept()
    }

    /// Slopes of an answer of the law that is `asked` there, be they of what resists or not.
    pub(super) fn slopes_of_answer(&self, command: Command<f64>, at: At, asked: f64) -> Slopes {
        let law = self.chain.motor.as_ref().filter(|_| matches!(command, Command::Pid { .. }));
        let straight = Some(law.map_or((0.0, 0.0), Motor::answer_slopes));
        self.slopes(command, at, straight, asked, |at| self.asked(command, at))
    }

    /// Slopes of what is `value` there: those that are told, where what is read and asked for is straight, or else by nudges.
    fn slopes(
        &self,
        command: Command<f64>,
        at: At,
        straight: Option<(f64, f64)>,
        value: f64,
        of: impl Fn(At) -> f64,
    ) -> Slopes {
        let chain = &self.chain;
        let is_read_as_it_is = chain.reads_true() && !chain.has_laws();
        let setpoint_rad_s = match command {
            Command::Pid { curve: Some(_), .. } => None,
            Command::Pid { slope_rad_s, .. } => Some(slope_rad_s),
            Command::Off | Command::Torque(_) | Command::Held { .. } => Some(0.0),
        };
        if let (Some((stiffness, damping)), Some(setpoint_rad_s)) =
            (straight.filter(|_| is_read_as_it_is), setpoint_rad_s)
        {
            return Slopes { stiffness, damping, per_time: stiffness * setpoint_rad_s };
        }
        Self::nudged(command, at, value, of)
    }

    /// The same by nudges.
    pub(super) fn nudged(command: Command<f64>, at: At, value: f64, of: impl Fn(At) -> f64) -> Slopes {
        let by = |at: At| of(at) - value;
        Slopes {
            stiffness: -by(At { angle_rad: at.angle_rad + ANGLE_NUDGE_RAD, ..at }) / ANGLE_NUDGE_RAD,
            damping: -by(At { rate_rad_s: at.rate_rad_s + RATE_NUDGE_RAD_S, ..at }) / RATE_NUDGE_RAD_S,
            per_time: if command.is_still() { 0.0 } else { by(At { t_s: at.t_s + TIME_NUDGE_S, ..at }) / TIME_NUDGE_S },
        }
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
    pub(super) fn kept(self) -> Self {
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
