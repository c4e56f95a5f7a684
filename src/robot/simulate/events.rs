//! What ends a step early: joints that come to rest, flanks of free play that meet; and flanks that part.

use super::run::Carried;
use super::side::{Side, SideMode};
use super::stiff::{MOST_STOPS, Mode, Stiff};
use crate::pendulum::{Command, LINK_SHARE};
use crate::robot::{Input, State};
use nalgebra::Vector3;

/// Something that happens within a step; its margin falls through zero there.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Event {
    /// A joint's speed passes through zero.
    Rests(usize),
    /// A motor side's speed passes through zero.
    SideRests(usize),
    /// The play is used up on this flank.
    Meets(usize, f64),
}

/// Events in one step after which it is taken whole.
const MOST_EVENTS: usize = 200;

impl Stiff<'_> {
    /// One step, in pieces where something happens within it.
    pub(super) fn step(&mut self, now: &mut Carried, commands: &[Command<f64>], h: f64) {
        self.stops.fill(0);
        let mut left = h;
        for round in 0.. {
            self.look(now, commands, round == 0);
            self.attempt(now, commands, left);
            let mut take = left;
            match self.first_event(&now.body).filter(|_| round < MOST_EVENTS) {
                Some((event, share)) => {
                    take = self.until(now, commands, event, share * left, left);
                    if take > 1e-9 * h {
                        self.accept(now, take);
                        self.counts.steps += 1;
                    } else {
                        // It does not get going in its direction.
                        take = 0.0;
                    }
                    self.happen(now, event);
                }
                None => {
                    self.accept(now, take);
                    self.counts.steps += 1;
                }
            }
            left -= take;
            if !(left > 1e-9 * h) {
                break;
            }
        }
    }

    fn margin(&self, event: Event, body: &State, sides: &[Side]) -> f64 {
        match event {
            Event::Rests(joint) => match self.modes[joint] {
                Mode::Slip(direction) => body.rate_rad_s[joint] * direction,
                _ => f64::INFINITY,
            },
            Event::SideRests(side) => match sides[side].mode {
                SideMode::Slip(direction) => sides[side].rate_rad_s * direction,
                _ => f64::INFINITY,
            },
            Event::Meets(side, flank) => {
                let side = &sides[side];
                match side.mode {
                    SideMode::Engaged(_) => f64::INFINITY,
                    _ => side.half_rad - flank * (body.angle_rad[side.joint] - side.angle_rad),
                }
            }
        }
    }

    /// What happens first, and after which share of the step.
    fn first_event(&self, body: &State) -> Option<(Event, f64)> {
        let mut first: Option<(Event, f64)> = None;
        let mut look = |event: Event| {
            let after = self.margin(event, &self.next, &self.next_sides);
            if !(after < 0.0) {
                return;
            }
            let before = self.margin(event, body, &self.sides);
            let share = if before > 0.0 { before / (before - after) } else { 0.0 };
            // A flank that has just parted is met again only where the step goes back beyond it.
            if first.is_none_or(|(_, other)| share < other) {
                first = Some((event, share));
            }
        };
        (0..self.modes.len()).for_each(|joint| look(Event::Rests(joint)));
        for side in 0..self.sides.len() {
            look(Event::SideRests(side));
            look(Event::Meets(side, 1.0));
            look(Event::Meets(side, -1.0));
        }
        first
    }

    /// Finds how long it takes until an event (regula falsi), and attempts a step of that length \[s\].
    fn until(&mut self, now: &Carried, commands: &[Command<f64>], event: Event, guess: f64, whole: f64) -> f64 {
        let before = self.margin(event, &now.body, &self.sides);
        if before <= 0.0 {
            return 0.0;
        }
        let (mut low, mut high) = ((0.0, before), (whole, self.margin(event, &self.next, &self.next_sides)));
        let close = self.tuning.zero * (before - high.1);
        let mut take = guess;
        for _ in 0..self.tuning.searches {
            self.attempt(now, commands, take);
            let margin = self.margin(event, &self.next, &self.next_sides);
            // An attempt may change what a joint does, and the event with it.
            if margin.abs() <= close || !margin.is_finite() {
                return take;
            }
            if margin > 0.0 {
                low = (take, margin);
            } else {
                high = (take, margin);
            }
            take = low.0 + (high.0 - low.0) * low.1 / (low.1 - high.1);
        }
        self.attempt(now, commands, take);
        take
    }

    fn happen(&mut self, now: &mut Carried, event: Event) {
        match event {
            Event::Rests(joint) => {
                now.body.rate_rad_s[joint] = 0.0;
                self.modes[joint] = Mode::Stuck;
                self.stops[joint] = self.stops[joint].saturating_add(1);
            }
            Event::SideRests(side) => {
                self.sides[side].rate_rad_s = 0.0;
                self.sides[side].mode = SideMode::Rest;
            }
            Event::Meets(side, flank) => self.meet(now, side, flank),
        }
    }

    /// Link and motor side go on together with their common momentum; the impulse goes through the whole robot.
    fn meet(&mut self, now: &mut Carried, index: usize, flank: f64) {
        let side = self.sides[index];
        let j = side.joint;
        // Column j of the inverse mass matrix: what a unit torque changes, velocities and gravity being the same.
        for k in 0..self.modes.len() {
            let holds = matches!(self.modes[k], Mode::Stuck | Mode::Rigid) && k != j;
            self.diagonal_kg_m2[k] = if holds { self.holding_kg_m2(k) } else { 0.0 };
            self.torque_nm[k] = 0.0;
        }
        for other in self.sides.iter().filter(|other| other.is_apart()) {
            self.diagonal_kg_m2[other.joint] -= other.inertia_kg_m2;
        }
        for (torque_nm, out) in [(0.0, &mut self.first), (1.0, &mut self.second)] {
            self.torque_nm[j] = torque_nm;
            let input = Input { torque_nm: &self.torque_nm, diagonal_kg_m2: &self.diagonal_kg_m2, forces: &[] };
            self.world.dynamics.forward(&now.body, &input, out);
        }
        self.counts.evaluations += 2;
        let column = |k: usize| self.second[k] - self.first[k];
        let impulse = (side.rate_rad_s - now.body.rate_rad_s[j]) / (column(6 + j) + 1.0 / side.inertia_kg_m2);
        let triple = |k: usize| Vector3::new(column(k), column(k + 1), column(k + 2)) * impulse;
        now.body.base_velocity_m_s += triple(0);
        now.body.base_rate_rad_s += triple(3);
        for (k, rate) in now.body.rate_rad_s.iter_mut().enumerate() {
            *rate += column(6 + k) * impulse;
        }
        let rate_rad_s = now.body.rate_rad_s[j];
        self.sides[index] = Side {
            angle_rad: now.body.angle_rad[j] - flank * side.half_rad,
            rate_rad_s,
            mode: SideMode::Engaged(flank),
            ..side
        };
        if !matches!(self.modes[j], Mode::Free | Mode::Rigid) {
            self.modes[j] = if rate_rad_s == 0.0 { Mode::Stuck } else { Mode::Slip(rate_rad_s.signum()) };
        }
    }

    /// Parts flanks that would have to pull; true where there was one.
    pub(super) fn part(&mut self, now: &Carried, h: f64) -> bool {
        let mut any = false;
        for index in 0..self.sides.len() {
            let side = self.sides[index];
            let SideMode::Engaged(flank) = side.mode else { continue };
            let j = side.joint;
            if self.stops[j] >= MOST_STOPS {
                continue;
            }
            let drive = &self.scenario.joints.drives()[j];
            let at = Self::at(now, j);
            let (motor_nm, gravity_nm) = (self.motor_nm[j], self.here.gravity_nm[j]);
            match self.modes[j] {
                Mode::Free | Mode::Slip(_) => {
                    let direction = if let Mode::Slip(direction) = self.modes[j] { direction } else { 1.0 };
                    let friction_nm = match self.modes[j] {
                        Mode::Slip(_) => direction * drive.friction_nm(at, direction, gravity_nm, motor_nm),
                        _ => drive.chain.friction.viscous_nm_s_rad * at.rate_rad_s,
                    };
                    let pulls_nm = motor_nm - (1.0 - LINK_SHARE) * friction_nm - side.inertia_kg_m2 * self.first[6 + j];
                    if flank * pulls_nm > 0.0 {
                        self.sides[index].mode = SideMode::Slip(direction);
                        any = true;
                    }
                }
                Mode::Stuck => {
                    let holding = self.holding_kg_m2(j);
                    let borne_nm = -holding / (self.tuning.gamma * h) * at.rate_rad_s - holding * self.first[6 + j];
                    // What the flank has to do so that the link stays where it is, but for its bearing's friction.
                    let pulls_nm = flank * (motor_nm + borne_nm);
                    let at_rest = super::terms::At { rate_rad_s: 0.0, ..at };
                    let bearing_nm = LINK_SHARE * drive.friction_nm(at_rest, -flank, gravity_nm, motor_nm);
                    if pulls_nm > bearing_nm {
                        self.sides[index].mode = SideMode::Rest;
                        self.modes[j] = Mode::Slip(-flank);
                        any = true;
                    }
                }
                Mode::Rigid => {}
            }
        }
        any
    }
}
