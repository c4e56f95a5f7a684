//! The project's own method: linearly implicit, of order 2, with joints that stick.
//!
//! A Rosenbrock-W method of two stages (ROS2, Verwer et al. 1999, g = 1 -+ 1/sqrt 2), which keeps its order whatever is
//! put in for the Jacobian. Here that is what is stiff: stiffness K and damping B of each joint's own stages, by nudges
//! where those bend, and those of contacts, seen through the Jacobian of their points. With `k = (k_q, k_v)`
//!
//! ```text
//! (M + D) k_v1 = tau(q, v) + g h tau_t - g h K v,            D = g h B + (g h)^2 K
//! (M + D) z    = tau(q + h k_q1, v + h k_v1) + 2 D k_v1 - g h K (v + h k_v1 - 2 k_q1) - g h tau_t,  k_v2 = z - 2 k_v1
//! k_q1 = v + g h k_v1,  k_q2 = v + h k_v1 - 2 k_q1 + g h k_v2,  y + h (3 k_1 + k_2) / 2
//! ```
//!
//! so a step takes two evaluations of forward dynamics. A joint at rest is held by a damper so stiff that it creeps less
//! than a millionth of what it would slip; where that damper would have to push harder than the breakaway friction, the
//! joint slips instead. Motors that run into limits and dead bands are in `bend`, what ends a step early is in `events`, free
//! play in `side`.

use super::bend::Bent;
use super::following::Followers;
use super::places::{add_velocity, shift, shift_mean};
use super::run::{Carried, Method, diverged, suggestion};
use super::side::Side;
use super::terms::{At, Slopes};
use super::world::{Around, World};
use super::{Diverged, External, Scenario};
use crate::integrate::Counts;
use crate::pendulum::{Command, LINK_SHARE};
use crate::robot::{Input, State};
use nalgebra::Vector3;

/// What depends on whether there are surroundings.
#[derive(Clone, Copy)]
pub(super) struct Tuning {
    /// The method's g. Both values damp what is stiff completely. The smaller one has the smaller error, but its second
    /// stage stands at `1 - 1/g = -2.4` times a stiff velocity: a foot that comes to rest is seen sliding back there, and
    /// one that lands is seen in the air again. The larger one stands at 0.4 times, and walks 5 mm off with steps
    /// for which the smaller one is 20 mm off.
    pub gamma: f64,
    /// An event is where its margin is this share of the step's change of it.
    pub zero: f64,
    /// Attempts to find that place.
    pub searches: usize,
}

const ALONE: Tuning = Tuning { gamma: 1.0 - std::f64::consts::FRAC_1_SQRT_2, zero: 1e-7, searches: 4 };
const SURROUNDED: Tuning = Tuning { gamma: 1.0 + std::f64::consts::FRAC_1_SQRT_2, zero: 1e-3, searches: 2 };
/// Inertia of the damper that holds a joint, in units of the joint's own.
const HOLDING: f64 = 1e7;
/// Classifications of sticking joints in one step.
const PASSES: usize = 8;
/// A joint that came to rest so often within one step stays at rest until its end.
pub(super) const MOST_STOPS: u8 = 3;

/// What a joint is doing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mode {
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
    pub scenario: Scenario<'a>,
    pub tuning: Tuning,
    step_s: f64,
    pub world: World<'a>,
    /// At the start of a step, and at its second stage.
    pub here: Around,
    there: Around,
    pub modes: Vec<Mode>,
    /// How often each joint came to rest in this step.
    pub stops: Vec<u8>,
    /// Motor sides of joints with free play, and after the step that is attempted.
    pub sides: Vec<Side>,
    pub next_sides: Vec<Side>,
    /// Index into `sides` by joint.
    side_of: Vec<Option<usize>>,
    /// At the start of a step: torques of motor and of springs, and their slopes.
    pub motor_nm: Vec<f64>,
    elastic_nm: Vec<f64>,
    pub driven: Vec<Slopes>,
    /// Motors of which less arrives than is asked for.
    pub bent: Vec<Option<Bent>>,
    elastic: Vec<Slopes>,
    slopes: Vec<Slopes>,
    pub torque_nm: Vec<f64>,
    pub diagonal_kg_m2: Vec<f64>,
    /// Inertia that is not the link's while it is apart from its motor side, in `diagonal_kg_m2` too \[kg m^2\].
    shift_kg_m2: Vec<f64>,
    pub first: Vec<f64>,
    pub second: Vec<f64>,
    stage: State,
    pub next: State,
    error_rad: Vec<f64>,
    next_integral_rad_s: Vec<f64>,
    followers: Followers,
    pub counts: Counts,
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
        let mut world = World::new(scenario);
        let sides = Side::of(scenario, &mut world);
        let place = |j: usize| sides.iter().position(|side| side.joint == j);
        Self {
            scenario: *scenario,
            tuning: if scenario.surroundings.is_some() { SURROUNDED } else { ALONE },
            step_s,
            world,
            here: Around::new(scenario),
            there: Around::new(scenario),
            side_of: (0..n).map(place).collect(),
            next_sides: sides.clone(),
            sides,
            modes: drives.iter().zip(&scenario.start.rate_rad_s).map(mode).collect(),
            stops: vec![0; n],
            motor_nm: zeros.clone(),
            elastic_nm: zeros.clone(),
            driven: vec![Slopes::default(); n],
            bent: vec![None; n],
            elastic: vec![Slopes::default(); n],
            slopes: vec![Slopes::default(); n],
            torque_nm: zeros.clone(),
            diagonal_kg_m2: zeros.clone(),
            shift_kg_m2: zeros.clone(),
            first: vec![0.0; 6 + n],
            second: vec![0.0; 6 + n],
            stage: scenario.start.clone(),
            next: scenario.start.clone(),
            error_rad: zeros.clone(),
            next_integral_rad_s: zeros,
            followers: Followers::new(scenario.model.following(), n),
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

    pub(super) fn accept(&mut self, now: &mut Carried, h: f64) {
        std::mem::swap(&mut now.body, &mut self.next);
        std::mem::swap(&mut now.integral_rad_s, &mut self.next_integral_rad_s);
        self.sides.copy_from_slice(&self.next_sides);
        now.t_s += h;
    }

    /// A step of `h` into `next`; joints at rest that are pushed too hard begin to slip.
    pub(super) fn attempt(&mut self, now: &Carried, commands: &[Command<f64>], h: f64) {
        self.bent.iter_mut().flatten().for_each(Bent::attempt);
        for _ in 0..PASSES {
            self.first_stage(now, h);
            let bends = self.bend(now, commands, h);
            let broke_away = !bends && self.break_away(now, h);
            if !self.part(now, h) && !broke_away && !bends {
                break;
            }
        }
        self.second_stage(now, commands, h);
    }

    pub(super) fn at(now: &Carried, j: usize) -> At {
        At {
            t_s: now.t_s,
            angle_rad: now.body.angle_rad[j],
            rate_rad_s: now.body.rate_rad_s[j],
            integral_rad_s: now.integral_rad_s[j],
        }
    }

    pub(super) fn holding_kg_m2(&self, j: usize) -> f64 {
        HOLDING * self.scenario.joints.drives()[j].chain.link.inertia_kg_m2
    }

    /// What does not depend on the step's length and on which joints stick. What rests on the surroundings is decided at
    /// the begin of a whole step only: a piece of one may be too short to bring a point to rest that has just been held.
    pub(super) fn look(&mut self, now: &Carried, commands: &[Command<f64>], is_whole: bool) {
        self.world.gather(now.t_s, &now.body, &mut self.here, is_whole);
        for (j, drive) in self.scenario.joints.drives().iter().enumerate() {
            let at = Self::at(now, j);
            self.error_rad[j] = drive.error_rad(commands[j], at.t_s, at.angle_rad);
            if self.modes[j] == Mode::Rigid {
                continue;
            }
            let motor_nm = drive.motor_nm(commands[j], at);
            self.motor_nm[j] = motor_nm;
            self.bent[j] = Bent::of(drive, commands[j], at, self.bent[j]).filter(|_| self.side_of[j].is_none());
            if self.bent[j].is_none() {
                self.driven[j] = drive.motor_slopes(commands[j], at, motor_nm);
            }
            self.elastic_nm[j] = drive.elastic_nm(at.angle_rad, at.rate_rad_s);
            self.elastic[j] = drive.elastic_slopes(at.angle_rad, at.rate_rad_s);
        }
    }

    fn first_stage(&mut self, now: &Carried, h: f64) {
        let gh = self.tuning.gamma * h;
        for (j, drive) in self.scenario.joints.drives().iter().enumerate() {
            let at = Self::at(now, j);
            let holding = self.holding_kg_m2(j);
            let side = self.side_of[j];
            let apart = side.map(|side| self.sides[side]).filter(Side::is_apart);
            let share = if apart.is_some() { LINK_SHARE } else { 1.0 };
            self.shift_kg_m2[j] = apart.map_or(0.0, |side| -side.inertia_kg_m2);
            if self.modes[j] == Mode::Rigid {
                (self.slopes[j], self.torque_nm[j], self.diagonal_kg_m2[j]) = (Slopes::default(), 0.0, holding);
                self.shift_kg_m2[j] = 0.0;
                continue;
            }
            let (motor_nm, gravity_nm) = (self.motor_nm[j], self.here.gravity_nm[j]);
            let (mut torque_nm, mut slopes) = (self.elastic_nm[j], self.elastic[j]);
            if apart.is_none() {
                let (motor_nm, driven) = match self.bent[j] {
                    Some(bent) => (bent.first_nm(), bent.slopes()),
                    None => (motor_nm, self.driven[j]),
                };
                slopes = slopes.plus(driven);
                torque_nm += motor_nm;
            } else if let Some(side) = side {
                self.sides[side].start(drive, at, gravity_nm, motor_nm);
            }
            match self.modes[j] {
                Mode::Free => {
                    let viscous = drive.chain.friction.viscous_nm_s_rad;
                    torque_nm -= viscous * at.rate_rad_s;
                    slopes.damping += viscous;
                }
                Mode::Slip(direction) => {
                    let whole_nm = drive.friction_nm(at, direction, gravity_nm, motor_nm);
                    torque_nm -= direction * share * whole_nm;
                    let speed_rad_s = (at.rate_rad_s * direction).max(0.0);
                    slopes.damping += share * drive.chain.friction.slope_nm_s_rad(speed_rad_s, at.t_s);
                }
                Mode::Stuck | Mode::Rigid => {
                    torque_nm -= holding / gh * at.rate_rad_s;
                    slopes.damping += holding / gh;
                }
            }
            self.slopes[j] = slopes;
            self.torque_nm[j] = torque_nm + gh * slopes.per_time - gh * slopes.stiffness * at.rate_rad_s;
            self.diagonal_kg_m2[j] = gh * slopes.damping + gh * gh * slopes.stiffness + self.shift_kg_m2[j];
        }
        let External { forces, contacts } = &self.here.external;
        let (dynamics, diagonal_kg_m2) = (&mut self.world.dynamics, &self.diagonal_kg_m2);
        let mut solve = |torque_nm: &[f64], k: &mut [f64]| {
            let input = Input { torque_nm, diagonal_kg_m2, forces };
            dynamics.forward_implicit(&now.body, &input, gh, contacts, k);
        };
        solve(&self.torque_nm, &mut self.first);
        self.followers.hold(&self.torque_nm, &mut self.first, solve);
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
            let apart = self.side_of[j].is_some_and(|side| self.sides[side].is_apart());
            let share = if apart { LINK_SHARE } else { 1.0 };
            let most_nm = share * drive.friction_nm(at_rest, direction, self.here.gravity_nm[j], self.motor_nm[j]);
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
            let mut torque_nm = drive.elastic_nm(at.angle_rad, at.rate_rad_s);
            let side = self.side_of[j].filter(|side| self.sides[*side].is_apart());
            let share = if side.is_some() { LINK_SHARE } else { 1.0 };
            match side {
                None => {
                    torque_nm += self.bent[j].map_or(motor_nm, |bent| bent.later_nm(drive, commands[j], at));
                }
                Some(side) => {
                    let gravity_nm = self.there.gravity_nm[j];
                    self.next_sides[side] = self.sides[side].after(drive, at, gravity_nm, motor_nm, h);
                }
            }
            match self.modes[j] {
                Mode::Free => torque_nm -= drive.chain.friction.viscous_nm_s_rad * at.rate_rad_s,
                Mode::Slip(direction) => {
                    let whole_nm = drive.friction_nm(at, direction, self.there.gravity_nm[j], motor_nm);
                    torque_nm -= direction * share * whole_nm;
                }
                Mode::Stuck | Mode::Rigid => torque_nm -= self.holding_kg_m2(j) / gh * at.rate_rad_s,
            }
            let slopes = self.slopes[j];
            let first = self.first[6 + j];
            let first_q = now.body.rate_rad_s[j] + gh * first;
            self.torque_nm[j] = torque_nm + 2.0 * (self.diagonal_kg_m2[j] - self.shift_kg_m2[j]) * first
                - gh * slopes.stiffness * (at.rate_rad_s - 2.0 * first_q)
                - gh * slopes.per_time;
        }
        let External { forces, contacts } = &self.there.external;
        let (dynamics, diagonal_kg_m2) = (&mut self.world.dynamics, &self.diagonal_kg_m2);
        let mut solve = |torque_nm: &[f64], k: &mut [f64]| {
            let input = Input { torque_nm, diagonal_kg_m2, forces };
            dynamics.forward_implicit(stage, &input, gh, contacts, k);
        };
        solve(&self.torque_nm, &mut self.second);
        self.followers.hold(&self.torque_nm, &mut self.second, solve);
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
        for (side, next) in self.sides.iter().zip(&mut self.next_sides) {
            if let Some(along) = side.along(self.next.angle_rad[side.joint], self.next.rate_rad_s[side.joint]) {
                *next = along;
            }
        }
        let base = |k: usize| h * (1.5 * first[k] + 0.5 * second[k]);
        self.next.base_velocity_m_s = now.body.base_velocity_m_s + Vector3::new(base(0), base(1), base(2));
        self.next.base_rate_rad_s = now.body.base_rate_rad_s + Vector3::new(base(3), base(4), base(5));
    }
}
