//! Motors that are asked for more than they have.
//!
//! A stiff law under a limit is the hard case of an implicit step: at the step's start it may ask for many times the
//! limit, only because the joint has not moved yet. So a step first takes the law as if there were no limit. Where it
//! would then still ask for more than the motor has at the implicit stage, the motor delivers all it has throughout the
//! step, and the step is taken again.

use super::JointDrive;
use super::run::Carried;
use super::stiff::Stiff;
use super::terms::{At, Slopes};
use crate::pendulum::Command;

/// A motor with limits in one step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limited {
    /// What the law asks for at the step's start \[N m\].
    asked_nm: f64,
    /// The direction in which it delivers all it has.
    saturated: Option<f64>,
}

impl Limited {
    /// `None` where nothing limits the motor.
    pub fn of(drive: &JointDrive, command: Command<f64>, at: At) -> Option<Self> {
        drive.may_saturate(command).then(|| Self { asked_nm: drive.unlimited_nm(command, at), saturated: None })
    }

    /// What the law asks for at the step's start \[N m\].
    pub fn asked_nm(&self) -> f64 {
        self.asked_nm
    }

    /// Torque at the step's start \[N m\] and its slopes, those of the law without limits being known.
    pub fn torque_and_slopes(&self, drive: &JointDrive, at: At, of_law: Slopes) -> (f64, Slopes) {
        match self.saturated {
            Some(direction) => (drive.most_nm(direction, at.rate_rad_s), drive.most_slopes(direction, at.rate_rad_s)),
            None => (self.asked_nm, of_law),
        }
    }

    /// Torque at the second stage \[N m\].
    pub fn later_nm(&self, drive: &JointDrive, command: Command<f64>, at: At) -> f64 {
        match self.saturated {
            Some(direction) => drive.most_nm(direction, at.rate_rad_s),
            None => drive.unlimited_nm(command, at),
        }
    }
}

impl Stiff<'_> {
    /// Saturates motors whose law would still ask for more than they have at the first stage; true where there was one.
    pub(super) fn saturate(&mut self, now: &Carried, h: f64) -> bool {
        let gh = self.tuning.gamma * h;
        let mut any = false;
        for (j, drive) in self.scenario.joints.drives().iter().enumerate() {
            let Some(limited) = self.limited[j].as_mut().filter(|limited| limited.saturated.is_none()) else {
                continue;
            };
            let (law, rate_rad_s) = (self.driven[j], now.body.rate_rad_s[j]);
            let gained_rad_s = gh * self.first[6 + j];
            let then_nm = limited.asked_nm + gh * law.per_time
                - gh * law.stiffness * (rate_rad_s + gained_rad_s)
                - law.damping * gained_rad_s;
            let direction = if then_nm < 0.0 { -1.0 } else { 1.0 };
            let most_nm = drive.most_nm(direction, rate_rad_s + gained_rad_s);
            if then_nm * direction > most_nm * direction {
                limited.saturated = Some(direction);
                any = true;
            }
        }
        any
    }
}
