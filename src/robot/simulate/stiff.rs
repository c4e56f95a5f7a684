//! The project's own method: linearly implicit, of order 2, with joints that stick.
//!
//! A Rosenbrock-W method of two stages (ROS2, Verwer et al. 1999, g = 1 -+ 1/sqrt 2), which keeps its order whatever is
//! put in for the Jacobian. Here that is what is stiff: stiffness K and damping B of each joint's own stages, found by
//! nudging them, and those of contacts, seen through the Jacobian of their points. With `k = (k_q, k_v)`
//!
//! ```text
//! (M + D) k_v1 = tau(q, v) + g h tau_t - g h K v,            D = g h B + (g h)^2 K
//! (M + D) z    = tau(q + h k_q1, v + h k_v1) + 2 D k_v1 - g h K (v + h k_v1 - 2 k_q1) - g h tau_t,  k_v2 = z - 2 k_v1
//! k_q1 = v + g h k_v1,  k_q2 = v + h k_v1 - 2 k_q1 + g h k_v2,  y + h (3 k_1 + k_2) / 2
//! ```
//!
//! so a step takes two evaluations of forward dynamics. A joint at rest is held by a damper so stiff that it creeps less
//! than a millionth of what it would slip; where that damper would have to push harder than the breakaway friction, the
//! joint slips instead. A slipping joint whose speed passes through zero ends the step there and is at rest.

use super::places::{add_velocity, shift, shift_mean};
use super::run::{Carried, Method, diverged, suggestion};
use super::terms::{At, Slopes};
use super::world::{Around, World};
use super::{Diverged, External, Scenario};
use crate::integrate::Counts;
use crate::pendulum::Command;
use crate::robot::{Input, State};
use nalgebra::Vector3;

/// What depends on whether there are surroundings.
#[derive(Clone, Copy)]
struct Tuning {
    /// The method's g. Both values damp what is stiff completely. The smaller one has the smaller error, but its second
    /// stage stands at `1 - 1/g = -2.4` times a stiff velocity: a foot that comes to rest is seen sliding back there, and
    /// one that lands is seen in the air again. The larger one stands at 0.4 times, and walks 5 mm off with steps
    /// for which the smaller one is 20 mm off.
    gamma: f64,
    /// A joint comes to rest where its speed is this share of the step's change of speed.
    zero: f64,
    /// Attempts to find that place.
    searches: usize,
}

const ALONE: Tuning = Tuning { gamma: 1.0 - std::f64::consts::FRAC_1_SQRT_2, zero: 1e-7, searches: 4 };
const SURROUNDED: Tuning = Tuning { gamma: 1.0 + std::f64::consts::FRAC_1_SQRT_2, zero: 1e-3, searches: 2 };
/// Inertia of the damper that holds a joint, in units of the joint's own.
const HOLDING: f64 = 1e7;
/// Classifications of sticking joints in one step.
const PASSES: usize = 8;
/// A joint that came to rest so often within one step stays at rest until its end.
const MOST_STOPS: u8 = 3;

/// What a joint is doing.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    /// It has no dry friction.
    Free,
    /// Held by friction.
    Stuck,
    /// Moving, or about to, in a direction.
    Slip(f64),
    /// Held whatever acts.
    Rigid,
}

pub(super) struct Stiff<'a> {
    scenario: Scenario<'a>,
    tuning: Tuning,
    step_s: f64,
    world: World<'a>,
    /// At the start of a step, and at its second stage.
    here: Around,
    there: Around,
    modes: Vec<Mode>,
    stops: Vec<u8>,
    /// At the start of a step: motor's torque, that and springs', and their slopes.
    motor_nm: Vec<f64>,
    given_nm: Vec<f64>,
    given: Vec<Slopes>,
    slopes: Vec<Slopes>,
    torque_nm: Vec<f64>,
    diagonal_kg_m2: Vec<f64>,
    first: Vec<f64>,
    second: Vec<f64>,
    stage: State,
    next: State,
    error_rad: Vec<f64>,
    next_integral_rad_s: Vec<f64>,
    counts: Counts,
}

impl<'a> Stiff<'a> {
    pub(super) fn new(scenario: &Scenario<'a>, step_s: f64) -> Self {
        let n = scenario.model.joints().len();
        let zeros = vec![0.0; n];
        let mode = |(drive, rate): (&super::JointDrive, &f64)| match (drive.is_rigid, drive.has_dry_friction()) {
            (true, _) => Mode::Rigid,
            (false, false) => Mode::Free,
            (false, true) if *rate != 0.0 => Mode::Slip(rate.signum()),
            (false, true) => Mode::Stuck,
        };
        let drives = scenario.joints.drives();
        Self {
            scenario: *scenario,
            tuning: if scenario.surroundings.is_some() { SURROUNDED } else { ALONE },
            step_s,
            world: World::new(scenario),
            here: Around::new(scenario),
            there: Around::new(scenario),
            modes: drives.iter().zip(&scenario.start.rate_rad_s).map(mode).collect(),
            stops: vec![0; n],
            motor_nm: zeros.clone(),
            given_nm: zeros.clone(),
            given: vec![Slopes::default(); n],
            slopes: vec![Slopes::default(); n],
            torque_nm: zeros.clone(),
            diagonal_kg_m2: zeros.clone(),
            first: vec![0.0; 6 + n],
            second: vec![0.0; 6 + n],
            stage: scenario.start.clone(),
            next: scenario.start.clone(),
            error_rad: zeros.clone(),
            next_integral_rad_s: zeros,
            counts: Counts::default(),
        }
    }

    pub(super) fn counts(&self) -> Counts {
        self.counts
    }

    /// Moves to `until_s`; answers with what ran away.
    pub(super) fn advance(&mut self, now: &mut Carried, commands: &[Command<f64>], until_s: f64) -> Option<Diverged> {
        let whole_s = until_s - now.t_s;
        let parts = (whole_s / self.step_s * (1.0 - 1e-9)).ceil().max(1.0);
        let h = whole_s / parts;
        for _ in 0..parts as u64 {
            self.step(now, commands, h);
            if let Some(joint) = now.body.rate_rad_s.iter().position(|w| !w.is_finite()) {
                let why = suggestion(Method::Stiff { step_s: self.step_s });
                return Some(diverged(&self.scenario, now.t_s, Some(joint), why));
            }
        }
        now.t_s = until_s;
        None
    }

    /// One step, in pieces where joints come to rest within it.
    fn step(&mut self, now: &mut Carried, commands: &[Command<f64>], h: f64) {
        self.stops.fill(0);
        let mut left = h;
        while left > 0.0 {
            self.look(now, commands);
            self.attempt(now, commands, left);
            let mut take = left;
            if let Some((joint, share)) = self.first_stop(&now.body) {
                take = self.until_rest(now, commands, joint, share * left, left);
                if take <= 1e-9 * h {
                    // It was at rest already, and does not get going in its direction.
                    self.rest(now, joint);
                    continue;
                }
                self.accept(now, take);
                self.rest(now, joint);
            } else {
                self.accept(now, take);
            }
            self.counts.steps += 1;
            left = if take < left { left - take } else { 0.0 };
            if left <= 1e-9 * h {
                break;
            }
        }
    }

    fn rest(&mut self, now: &mut Carried, joint: usize) {
        now.body.rate_rad_s[joint] = 0.0;
        self.modes[joint] = Mode::Stuck;
        self.stops[joint] = self.stops[joint].saturating_add(1);
    }

    /// Which slipping joint's speed passes through zero first, and after which share of the step.
    fn first_stop(&self, body: &State) -> Option<(usize, f64)> {
        let mut first: Option<(usize, f64)> = None;
        for (j, mode) in self.modes.iter().enumerate() {
            let Mode::Slip(direction) = *mode else { continue };
            let (before, after) = (body.rate_rad_s[j] * direction, self.next.rate_rad_s[j] * direction);
            if after < 0.0 {
                let share = if before > 0.0 { before / (before - after) } else { 0.0 };
                if first.is_none_or(|(_, other)| share < other) {
                    first = Some((j, share));
                }
            }
        }
        first
    }

    /// Finds how long it takes until a joint is at rest (regula falsi), and attempts a step of that length \[s\].
    fn until_rest(&mut self, now: &Carried, commands: &[Command<f64>], joint: usize, guess: f64, whole: f64) -> f64 {
        let Mode::Slip(direction) = self.modes[joint] else { return whole };
        let before = now.body.rate_rad_s[joint] * direction;
        if before <= 0.0 {
            return 0.0;
        }
        let mut high = (whole, self.next.rate_rad_s[joint] * direction);
        let mut low = (0.0, before);
        let mut take = guess;
        let close = self.tuning.zero * (before - high.1);
        for _ in 0..self.tuning.searches {
            self.attempt(now, commands, take);
            let speed = self.next.rate_rad_s[joint] * direction;
            if speed.abs() <= close {
                break;
            }
            if speed > 0.0 {
                low = (take, speed)
            } else {
                high = (take, speed)
            }
            take = low.0 + (high.0 - low.0) * low.1 / (low.1 - high.1);
        }
        take
    }

    fn accept(&mut self, now: &mut Carried, h: f64) {
        std::mem::swap(&mut now.body, &mut self.next);
        std::mem::swap(&mut now.integral_rad_s, &mut self.next_integral_rad_s);
        now.t_s += h;
    }

    /// A step of `h` into `next`; joints at rest that are pushed too hard begin to slip.
    fn attempt(&mut self, now: &Carried, commands: &[Command<f64>], h: f64) {
        for _ in 0..PASSES {
            self.first_stage(now, h);
            if !self.break_away(now, h) {
                break;
            }
        }
        self.second_stage(now, commands, h);
    }

    fn at(now: &Carried, j: usize) -> At {
        At {
            t_s: now.t_s,
            angle_rad: now.body.angle_rad[j],
            rate_rad_s: now.body.rate_rad_s[j],
            integral_rad_s: now.integral_rad_s[j],
        }
    }

    fn holding_kg_m2(&self, j: usize) -> f64 {
        HOLDING * self.scenario.joints.drives()[j].chain.link.inertia_kg_m2
    }

    /// What does not depend on the step's length and on which joints stick.
    fn look(&mut self, now: &Carried, commands: &[Command<f64>]) {
        self.world.surround(now.t_s, &now.body, &mut self.here);
        for (j, drive) in self.scenario.joints.drives().iter().enumerate() {
            let at = Self::at(now, j);
            self.error_rad[j] = drive.error_rad(commands[j], at.t_s, at.angle_rad);
            if self.modes[j] == Mode::Rigid {
                continue;
            }
            let motor_nm = drive.motor_nm(commands[j], at);
            self.motor_nm[j] = motor_nm;
            self.given_nm[j] = motor_nm + drive.elastic_nm(at.angle_rad, at.rate_rad_s);
            let elastic = drive.elastic_slopes(at.angle_rad, at.rate_rad_s);
            self.given[j] = drive.motor_slopes(commands[j], at, motor_nm).plus(elastic);
        }
    }

    fn first_stage(&mut self, now: &Carried, h: f64) {
        let gh = self.tuning.gamma * h;
        for (j, drive) in self.scenario.joints.drives().iter().enumerate() {
            let at = Self::at(now, j);
            let holding = self.holding_kg_m2(j);
            if self.modes[j] == Mode::Rigid {
                (self.slopes[j], self.torque_nm[j], self.diagonal_kg_m2[j]) = (Slopes::default(), 0.0, holding);
                continue;
            }
            let (mut torque_nm, mut slopes) = (self.given_nm[j], self.given[j]);
            match self.modes[j] {
                Mode::Free => {
                    let viscous = drive.chain.friction.viscous_nm_s_rad;
                    torque_nm -= viscous * at.rate_rad_s;
                    slopes.damping += viscous;
                }
                Mode::Slip(direction) => {
                    let gravity_nm = self.here.gravity_nm[j];
                    torque_nm -= direction * drive.friction_nm(at, direction, gravity_nm, self.motor_nm[j]);
                    slopes.damping += drive.chain.friction.slope_nm_s_rad((at.rate_rad_s * direction).max(0.0));
                }
                Mode::Stuck | Mode::Rigid => {
                    torque_nm -= holding / gh * at.rate_rad_s;
                    slopes.damping += holding / gh;
                }
            }
            self.slopes[j] = slopes;
            self.torque_nm[j] = torque_nm + gh * slopes.per_time - gh * slopes.stiffness * at.rate_rad_s;
            self.diagonal_kg_m2[j] = gh * slopes.damping + gh * gh * slopes.stiffness;
        }
        let External { forces, contacts } = &self.here.external;
        let input = Input { torque_nm: &self.torque_nm, diagonal_kg_m2: &self.diagonal_kg_m2, forces };
        self.world.dynamics.forward_implicit(&now.body, &input, gh, contacts, &mut self.first);
        self.counts.evaluations += 1;
        for (j, mode) in self.modes.iter().enumerate() {
            if *mode == Mode::Rigid {
                self.first[6 + j] = 0.0;
            }
        }
    }

    /// Lets joints go that are pushed harder than they stick; true where there was one.
    fn break_away(&mut self, now: &Carried, h: f64) -> bool {
        let mut any = false;
        for (j, drive) in self.scenario.joints.drives().iter().enumerate() {
            if self.modes[j] != Mode::Stuck || self.stops[j] >= MOST_STOPS {
                continue;
            }
            let at = Self::at(now, j);
            let holding = self.holding_kg_m2(j);
            // What friction has to bear: all that the holding damper does.
            let borne_nm = -holding / (self.tuning.gamma * h) * at.rate_rad_s - holding * self.first[6 + j];
            let direction = if borne_nm > 0.0 { -1.0 } else { 1.0 };
            let at_rest = At { rate_rad_s: 0.0, ..at };
            let most_nm = drive.friction_nm(at_rest, direction, self.here.gravity_nm[j], self.motor_nm[j]);
            if borne_nm.abs() > most_nm * (1.0 + 1e-9) {
                self.modes[j] = Mode::Slip(direction);
                any = true;
            }
        }
        any
    }

    fn second_stage(&mut self, now: &Carried, commands: &[Command<f64>], h: f64) {
        let gh = self.tuning.gamma * h;
        shift(&mut self.stage, &now.body, h, |j| now.body.rate_rad_s[j] + gh * self.first[6 + j]);
        add_velocity(&mut self.stage, &now.body, h, &self.first);
        let t_s = now.t_s + h;
        self.world.surround(t_s, &self.stage, &mut self.there);
        self.world.second_stage(h, gh, &self.first, &mut self.there);
        let stage = &self.stage;
        for (j, drive) in self.scenario.joints.drives().iter().enumerate() {
            let at = At {
                t_s,
                angle_rad: stage.angle_rad[j],
                rate_rad_s: stage.rate_rad_s[j],
                integral_rad_s: now.integral_rad_s[j] + h * self.error_rad[j],
            };
            let late_error = drive.error_rad(commands[j], t_s, at.angle_rad);
            self.next_integral_rad_s[j] = now.integral_rad_s[j] + 0.5 * h * (self.error_rad[j] + late_error);
            if self.modes[j] == Mode::Rigid {
                self.torque_nm[j] = 0.0;
                continue;
            }
            let motor_nm = drive.motor_nm(commands[j], at);
            let mut torque_nm = motor_nm + drive.elastic_nm(at.angle_rad, at.rate_rad_s);
            match self.modes[j] {
                Mode::Free => torque_nm -= drive.chain.friction.viscous_nm_s_rad * at.rate_rad_s,
                Mode::Slip(direction) => {
                    torque_nm -= direction * drive.friction_nm(at, direction, self.there.gravity_nm[j], motor_nm);
                }
                Mode::Stuck | Mode::Rigid => torque_nm -= self.holding_kg_m2(j) / gh * at.rate_rad_s,
            }
            let slopes = self.slopes[j];
            let first = self.first[6 + j];
            let first_q = now.body.rate_rad_s[j] + gh * first;
            self.torque_nm[j] = torque_nm + 2.0 * self.diagonal_kg_m2[j] * first
                - gh * slopes.stiffness * (at.rate_rad_s - 2.0 * first_q)
                - gh * slopes.per_time;
        }
        let External { forces, contacts } = &self.there.external;
        let input = Input { torque_nm: &self.torque_nm, diagonal_kg_m2: &self.diagonal_kg_m2, forces };
        self.world.dynamics.forward_implicit(stage, &input, gh, contacts, &mut self.second);
        self.counts.evaluations += 1;
        for (second, first) in self.second.iter_mut().zip(&self.first) {
            *second -= 2.0 * first;
        }
        for (j, mode) in self.modes.iter().enumerate() {
            if *mode == Mode::Rigid {
                self.second[6 + j] = 0.0;
            }
        }
        let (first, second) = (&self.first, &self.second);
        // The mean of both stages' velocities for the base; the joints' own rates for the joints.
        shift_mean(&mut self.next, &now.body, stage, h);
        for j in 0..self.next.angle_rad.len() {
            let first_q = now.body.rate_rad_s[j] + gh * first[6 + j];
            let second_q = stage.rate_rad_s[j] - 2.0 * first_q + gh * second[6 + j];
            self.next.angle_rad[j] = now.body.angle_rad[j] + h * (1.5 * first_q + 0.5 * second_q);
            self.next.rate_rad_s[j] = now.body.rate_rad_s[j] + h * (1.5 * first[6 + j] + 0.5 * second[6 + j]);
        }
        let base = |k: usize| h * (1.5 * first[k] + 0.5 * second[k]);
        self.next.base_velocity_m_s = now.body.base_velocity_m_s + Vector3::new(base(0), base(1), base(2));
        self.next.base_rate_rad_s = now.body.base_rate_rad_s + Vector3::new(base(3), base(4), base(5));
    }
}
