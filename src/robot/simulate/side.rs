//! The motor side of a joint with free play, as `pendulum` has it: stiff inelastic flanks between motor side and link.
//!
//! While a flank is pressed both are one body, and the joint is an ordinary one. Apart, the link keeps what inertia is not
//! the motor side's and its bearing's share of the friction; the motor side is a body of its own.

use super::terms::At;
use super::world::World;
use super::{JointDrive, Scenario};
use crate::pendulum::LINK_SHARE;

/// What the motor side does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SideMode {
    /// Pressed to the link, which is ahead (+1) or behind (-1).
    Engaged(f64),
    /// Apart and at rest.
    Rest,
    /// Apart and moving in a direction.
    Slip(f64),
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub joint: usize,
    /// Half the play \[rad\].
    pub half_rad: f64,
    pub inertia_kg_m2: f64,
    pub angle_rad: f64,
    pub rate_rad_s: f64,
    pub mode: SideMode,
    /// Acceleration at the step's begin \[rad/s^2\].
    pub acceleration_rad_s2: f64,
}

impl Side {
    /// Motor sides of all joints with play, each on the flank that gravity and springs load.
    pub(super) fn of(scenario: &Scenario<'_>, world: &mut World<'_>) -> Vec<Self> {
        let start = scenario.start;
        let mut gravity_nm = vec![0.0; scenario.joints.drives().len()];
        world.dynamics.gravity_nm(start, &mut gravity_nm);
        let side = |(joint, drive): (usize, &JointDrive)| {
            let play = drive.chain.play.as_ref()?;
            let (angle_rad, rate_rad_s) = (start.angle_rad[joint], start.rate_rad_s[joint]);
            let flank = if gravity_nm[joint] + drive.elastic_nm(angle_rad, 0.0) < 0.0 { -1.0 } else { 1.0 };
            let half_rad = 0.5 * play.width_rad;
            Some(Self {
                joint,
                half_rad,
                inertia_kg_m2: play.motor_side_kg_m2,
                angle_rad: angle_rad - flank * half_rad,
                rate_rad_s,
                mode: SideMode::Engaged(flank),
                acceleration_rad_s2: 0.0,
            })
        };
        scenario.joints.drives().iter().enumerate().filter_map(side).collect()
    }

    pub(super) fn is_apart(&self) -> bool {
        !matches!(self.mode, SideMode::Engaged(_))
    }

    /// Where it is when the link is at an angle and both are one; `None` while they are apart.
    pub(super) fn along(&self, angle_rad: f64, rate_rad_s: f64) -> Option<Self> {
        let SideMode::Engaged(flank) = self.mode else { return None };
        Some(Self { angle_rad: angle_rad - flank * self.half_rad, rate_rad_s, ..*self })
    }

    /// Decides what the side does at the begin of a step, being apart, and takes its acceleration.
    pub(super) fn start(&mut self, drive: &JointDrive, at: At, gravity_nm: f64, motor_nm: f64) {
        if self.mode == SideMode::Rest {
            let direction = if motor_nm < 0.0 { -1.0 } else { 1.0 };
            let held_nm = self.friction_nm(drive, At { rate_rad_s: 0.0, ..at }, direction, gravity_nm, motor_nm);
            if motor_nm.abs() > held_nm {
                self.mode = SideMode::Slip(direction);
            }
        }
        self.acceleration_rad_s2 = self.acceleration(drive, at, self.rate_rad_s, gravity_nm, motor_nm);
    }

    fn friction_nm(&self, drive: &JointDrive, at: At, direction: f64, gravity_nm: f64, motor_nm: f64) -> f64 {
        (1.0 - LINK_SHARE) * drive.friction_nm(at, direction, gravity_nm, motor_nm)
    }

    fn acceleration(&self, drive: &JointDrive, at: At, rate_rad_s: f64, gravity_nm: f64, motor_nm: f64) -> f64 {
        let SideMode::Slip(direction) = self.mode else { return 0.0 };
        let friction_nm = self.friction_nm(drive, At { rate_rad_s, ..at }, direction, gravity_nm, motor_nm);
        (motor_nm - direction * friction_nm) / self.inertia_kg_m2
    }

    /// The side after a step, by Heun's rule; `late` is the link at the second stage.
    pub(super) fn after(&self, drive: &JointDrive, late: At, gravity_nm: f64, motor_nm: f64, h: f64) -> Self {
        let late_rate = self.rate_rad_s + h * self.acceleration_rad_s2;
        let late_acceleration = self.acceleration(drive, late, late_rate, gravity_nm, motor_nm);
        Self {
            angle_rad: self.angle_rad + 0.5 * h * (self.rate_rad_s + late_rate),
            rate_rad_s: self.rate_rad_s + 0.5 * h * (self.acceleration_rad_s2 + late_acceleration),
            ..*self
        }
    }
}
