//! Motors of which less arrives than their law asks for: beyond a limit, or within a dead band.
//!
//! A stiff law behind a bend is the hard case of an implicit step: at the step's start it may ask for many times what it
//! does a moment later, only because the joint has not moved yet, and at the second stage it is far beyond the bend again.
//! So a step takes what arrives of an answer `u` at a rate `w` as a straight line,
//! `tau_1 + (dtau/du) (u - u_1) + (dtau/dw) (w - w_1)`: the tangent where the implicit stage comes out. The line of the step
//! before is tried first. Where the stage is not on it, the step is taken again with the tangent there, and, as the second
//! such pass tells how answer and rate follow the torque, then with the tangent where all three agree.

use super::JointDrive;
use super::run::Carried;
use super::stiff::Stiff;
use super::terms::{At, Slopes};
use crate::pendulum::Command;

/// A stage is on its line where that is off by no more than this share of the torque, or so much \[N m\].
const CLOSE: f64 = 1e-5;
const CLOSE_NM: f64 = 1e-9;
/// Nudges for the tangent, of an answer \[N m, or a duty\] and a rate \[rad/s\].
const NUDGE: f64 = 1e-7;
/// Halvings of the torques between which all agree.
const HALVINGS: usize = 40;

/// What arrives \[N m\] near an answer of the law and a rate \[rad/s\].
#[derive(Clone, Copy, Debug)]
struct Line {
    at: [f64; 2],
    torque_nm: f64,
    slopes: [f64; 2],
}

impl Line {
    fn tangent(drive: &JointDrive, [asked, rate_rad_s]: [f64; 2]) -> Self {
        let of = |asked, rate_rad_s| drive.chain.delivered_nm(asked, rate_rad_s);
        let torque_nm = of(asked, rate_rad_s);
        let slopes = [of(asked + NUDGE, rate_rad_s), of(asked, rate_rad_s + NUDGE)].map(|nm| (nm - torque_nm) / NUDGE);
        Self { at: [asked, rate_rad_s], torque_nm, slopes }
    }

    fn nm(&self, [asked, rate_rad_s]: [f64; 2]) -> f64 {
        self.torque_nm + self.slopes[0] * (asked - self.at[0]) + self.slopes[1] * (rate_rad_s - self.at[1])
    }
}

/// A motor whose torque bends, in one step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bent {
    /// Answer and rate at the step's start.
    here: [f64; 2],
    /// How the law's answer changes with angle, rate and time.
    of_answer: Slopes,
    line: Line,
    /// Answer and rate at the implicit stage of the attempt's pass before, and the torque that these came of.
    before: Option<([f64; 2], f64)>,
}

impl Bent {
    /// `None` where nothing bends what a continuous law asks for; `before` is the step before.
    pub fn of(drive: &JointDrive, command: Command<f64>, at: At, before: Option<Self>) -> Option<Self> {
        drive.may_bend(command).then(|| {
            let asked = drive.asked(command, at);
            let here = [asked, at.rate_rad_s];
            let line = before.map_or_else(|| Line::tangent(drive, here), |before| before.line);
            Self { here, of_answer: drive.slopes_of_answer(command, at, asked), line, before: None }
        })
    }

    /// Forgets the passes of a step of another length, of which answer and rate follow the torque otherwise.
    pub fn attempt(&mut self) {
        self.before = None;
    }

    /// Torque on the line at the step's start \[N m\].
    pub fn first_nm(&self) -> f64 {
        self.line.nm(self.here)
    }

    /// Torque on the line later in the step \[N m\].
    pub fn later_nm(&self, drive: &JointDrive, command: Command<f64>, at: At) -> f64 {
        self.line.nm([drive.asked(command, at), at.rate_rad_s])
    }

    /// Its slopes.
    pub fn slopes(&self) -> Slopes {
        let ([by_answer, by_rate], of) = (self.line.slopes, self.of_answer);
        Slopes {
            stiffness: by_answer * of.stiffness,
            damping: by_answer * of.damping - by_rate,
            per_time: by_answer * of.per_time,
        }
        .kept()
    }

    /// Takes another line where the implicit stage, with its answer and rate, is not on this one; true where it is not.
    fn turn(&mut self, drive: &JointDrive, stage: [f64; 2]) -> bool {
        let (arrives_nm, on_line_nm) = (drive.chain.delivered_nm(stage[0], stage[1]), self.line.nm(stage));
        if (arrives_nm - on_line_nm).abs() <= CLOSE * arrives_nm.abs() + CLOSE_NM {
            return false;
        }
        let pass = (stage, on_line_nm);
        let agrees = self.before.map_or(stage, |before| where_all_agree(drive, before, pass));
        (self.before, self.line) = (Some(pass), Line::tangent(drive, agrees));
        true
    }
}

/// Where a torque makes the answer and the rate of which it arrives, told from two passes: more torque makes less of both.
fn where_all_agree(drive: &JointDrive, a: ([f64; 2], f64), b: ([f64; 2], f64)) -> [f64; 2] {
    let per_nm = [0, 1].map(|k| (b.0[k] - a.0[k]) / (b.1 - a.1));
    if !per_nm.iter().all(|slope| slope.is_finite()) {
        return b.0;
    }
    let stage = |nm: f64| [0, 1].map(|k| b.0[k] + per_nm[k] * (nm - b.1));
    let arrives = |[asked, rate_rad_s]: [f64; 2]| drive.chain.delivered_nm(asked, rate_rad_s);
    let ends = [a.1, b.1, arrives(a.0), arrives(b.0)];
    let (mut low, mut high) = (ends.into_iter().fold(f64::MAX, f64::min), ends.into_iter().fold(f64::MIN, f64::max));
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if arrives(stage(middle)) > middle { low = middle } else { high = middle }
    }
    stage(0.5 * (low + high))
}

impl Stiff<'_> {
    /// Takes other lines for motors whose implicit stage is not on theirs; true where there was one.
    pub(super) fn bend(&mut self, now: &Carried, commands: &[Command<f64>], h: f64) -> bool {
        let gh = self.tuning.gamma * h;
        let mut any = false;
        for (j, drive) in self.scenario.joints.drives().iter().enumerate() {
            let Some(bent) = &mut self.bent[j] else { continue };
            let here = Self::at(now, j);
            let rate_rad_s = here.rate_rad_s + gh * self.first[6 + j];
            let angle_rad = here.angle_rad + gh * rate_rad_s;
            let stage = At { t_s: here.t_s + gh, angle_rad, rate_rad_s, ..here };
            any |= bent.turn(drive, [drive.asked(commands[j], stage), rate_rad_s]);
        }
        any
    }
}
