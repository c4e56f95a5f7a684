//! One step of a joint of one body, or of a motor and a link with something between them.

use super::friction::{Contact, stopped};
use super::link::Pose;
use super::{Coupling, Machine};
use crate::blind::plan::Load;
use std::collections::VecDeque;

/// One body's motion.
#[derive(Clone, Copy, Debug)]
struct Motion {
    q_rad: f64,
    v_rad_s: f64,
    /// Acceleration of the last step, to guess the speed in the middle of the next \[rad/s^2\].
    a_rad_s2: f64,
}

impl Motion {
    fn middle(&self, step_s: f64) -> (f64, f64) {
        (self.q_rad + 0.5 * step_s * self.v_rad_s, self.v_rad_s + 0.5 * step_s * self.a_rad_s2)
    }

    fn take(&mut self, v_rad_s: f64, step_s: f64) {
        self.q_rad += 0.5 * step_s * (self.v_rad_s + v_rad_s);
        // a body that stands has no acceleration to carry on
        self.a_rad_s2 = if v_rad_s == 0.0 { 0.0 } else { (v_rad_s - self.v_rad_s) / step_s };
        self.v_rad_s = v_rad_s;
    }
}

/// Everything that changes along a log.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub t_s: f64,
    link: Motion,
    motor: Motion,
    bristle: f64,
    cable: f64,
    slow_speed_rad_s: f64,
    /// Setpoint that the controller sees, and its speed where that is limited \[rad, rad/s\].
    setpoint: (f64, f64),
    /// Integral of the controller's error \[rad s\].
    integral_rad_s: f64,
}

impl State {
    /// A joint that starts at an angle and a speed; `flank` is how far the motor side is ahead of the link.
    pub(super) fn new(q_rad: f64, v_rad_s: f64, flank_rad: f64, setpoint_rad: f64) -> Self {
        Self {
            t_s: 0.0,
            link: Motion { q_rad, v_rad_s, a_rad_s2: 0.0 },
            motor: Motion { q_rad: q_rad + flank_rad, v_rad_s, a_rad_s2: 0.0 },
            bristle: 0.0,
            cable: 0.0,
            slow_speed_rad_s: 0.0,
            setpoint: (setpoint_rad, 0.0),
            integral_rad_s: 0.0,
        }
    }
}

/// A log under way.
pub(super) struct Run<'a> {
    machine: &'a Machine,
    inertia_kg_m2: f64,
    peak_nm: f64,
    log: usize,
    arrivals: Option<&'a [(f64, f64)]>,
    next: usize,
    end_s: f64,
    /// Instants, angles and speeds of the link that are not yet too old to be read; empty unless readings are late.
    past: VecDeque<(f64, f64, f64)>,
}

/// Torques of one instant.
struct Torques {
    motor_nm: f64,
    link_nm: f64,
    gravity_nm: f64,
}

impl<'a> Run<'a> {
    pub(super) fn new(
        machine: &'a Machine,
        load: &Load,
        log: usize,
        arrivals: Option<&'a [(f64, f64)]>,
        end_s: f64,
    ) -> Self {
        Self {
            machine,
            inertia_kg_m2: machine.inertia_kg_m2 + load.inertia_kg_m2,
            peak_nm: machine.peak_gravity_nm + load.peak_gravity_nm,
            log,
            arrivals,
            next: 0,
            end_s,
            past: VecDeque::new(),
        }
    }

    /// How far the motor side is ahead at the start: the link leans on the flank that gravity loads \[rad\].
    pub(super) fn flank(&self, q_rad: f64) -> f64 {
        let Some(coupling) = &self.machine.coupling else { return 0.0 };
        let pull = self.pull_nm(q_rad);
        let sag = if coupling.stiffness.is_finite() { -pull / coupling.stiffness } else { 0.0 };
        0.5 * coupling.play_rad * if pull > 0.0 { -1.0 } else { 1.0 } + sag
    }

    fn pull_nm(&self, q_rad: f64) -> f64 {
        let at = Pose { t_s: 0.0, q_rad, v_rad_s: 0.0, log: self.log };
        self.machine.link.gravity_nm(&at, self.peak_nm)
    }

    pub(super) fn first_setpoint(&self) -> f64 {
        self.arrivals.and_then(|list| list.first()).map_or(0.0, |(_, value)| *value)
    }

    /// Moves the setpoint that the controller sees to an instant.
    fn follow(&mut self, state: &mut State, t_s: f64, step_s: f64) -> Option<f64> {
        let list = self.arrivals?;
        while list.get(self.next + 1).is_some_and(|(t, _)| *t <= t_s) {
            self.next += 1;
        }
        let (_, wanted) = list.get(self.next)?;
        let drive = &self.machine.drive;
        if drive.slew_rad_s.is_finite() || drive.slew_rad_s2.is_finite() {
            state.setpoint = drive.moved(state.setpoint, *wanted, step_s);
        } else {
            state.setpoint.0 = *wanted;
        }
        Some(state.setpoint.0)
    }

    /// Reading and its rate at an instant, of the link as it is or was \[rad, rad/s\].
    pub(super) fn read(&mut self, state: &State, t_s: f64) -> (f64, f64) {
        self.read_of(t_s, (state.link.q_rad, state.link.v_rad_s))
    }

    fn is_late(&self) -> bool {
        self.machine.reading.late_s > 0.0 && self.arrivals.is_some()
    }

    fn read_of(&mut self, t_s: f64, now: (f64, f64)) -> (f64, f64) {
        let reading = &self.machine.reading;
        let (q, v) = if self.is_late() { self.earlier(t_s - reading.late_s, now) } else { now };
        (reading.angle(q, t_s / self.end_s), reading.slope(q) * v)
    }

    /// Where the link was at an instant, and its speed; instants are asked for in their order.
    fn earlier(&mut self, t_s: f64, now: (f64, f64)) -> (f64, f64) {
        while self.past.get(1).is_some_and(|(at_s, ..)| *at_s <= t_s) {
            self.past.pop_front();
        }
        match (self.past.front(), self.past.get(1)) {
            // it was held until the log began
            (Some((from_s, q, _)), _) if t_s < *from_s => (*q, 0.0),
            (Some((from_s, q, v)), Some((to_s, later_q, later_v))) => {
                let share = (t_s - from_s) / (to_s - from_s);
                (q + share * (later_q - q), v + share * (later_v - v))
            }
            (Some((_, q, v)), None) => (*q, *v),
            (None, _) => (now.0, 0.0),
        }
    }

    /// Commanded torque at a sample, which already sees the sample's setpoint \[N m\].
    pub(super) fn commanded_nm(&mut self, state: &mut State) -> f64 {
        // the setpoint of an instant is there at the instant
        let Some(setpoint) = self.follow(state, state.t_s + 1e-9, 0.0) else { return 0.0 };
        let read = self.read(state, state.t_s);
        self.machine.drive.commanded_nm(setpoint, read, state.integral_rad_s)
    }

    fn torques(&mut self, state: &mut State, t_s: f64, (q, v): (f64, f64), step_s: f64) -> Torques {
        let machine = self.machine;
        let at = Pose { t_s, q_rad: q, v_rad_s: v, log: self.log };
        let motor_nm = match self.follow(state, t_s, step_s) {
            None => 0.0,
            Some(setpoint) => {
                let read = self.read_of(t_s, (q, v));
                state.integral_rad_s += step_s * (setpoint - read.0);
                let commanded = machine.drive.commanded_nm(setpoint, read, state.integral_rad_s);
                machine.drive.delivered_nm(commanded, q, v, t_s / self.end_s)
            }
        };
        let gravity_nm = machine.link.gravity_nm(&at, self.peak_nm);
        let cable = machine.link.cable_nm(&mut state.cable, v * step_s);
        Torques { motor_nm, link_nm: gravity_nm + machine.link.other_nm(&at) + cable, gravity_nm }
    }

    fn contact(&self, state: &mut State, t_s: f64, (q, v): (f64, f64), torques: &Torques, step_s: f64) -> Contact {
        let memory = self.machine.friction.memory_s;
        let speed = v.abs();
        if memory > 0.0 {
            state.slow_speed_rad_s += step_s / memory * (speed - state.slow_speed_rad_s);
        } else {
            state.slow_speed_rad_s = speed;
        }
        Contact {
            t_s,
            q_rad: q,
            v_rad_s: v,
            dry_speed_rad_s: state.slow_speed_rad_s,
            gravity_nm: torques.gravity_nm,
            peak_gravity_nm: self.peak_nm,
            motor_nm: torques.motor_nm,
            log: self.log,
        }
    }

    /// One step.
    pub(super) fn step(&mut self, state: &mut State, step_s: f64) {
        if self.is_late() && self.past.is_empty() {
            self.past.push_back((state.t_s, state.link.q_rad, state.link.v_rad_s));
        }
        match self.machine.coupling {
            None => self.step_one(state, step_s),
            Some(coupling) => self.step_two(state, coupling, step_s),
        }
        state.t_s += step_s;
        if self.is_late() {
            self.past.push_back((state.t_s, state.link.q_rad, state.link.v_rad_s));
        }
    }

    fn step_one(&mut self, state: &mut State, h: f64) {
        let friction = &self.machine.friction;
        let (t, middle) = (state.t_s + 0.5 * h, state.link.middle(h));
        let torques = self.torques(state, t, middle, h);
        let at = self.contact(state, t, middle, &torques, h);
        let dry = friction.dry_nm(&at);
        let mut torque = torques.motor_nm + torques.link_nm + friction.wet_nm(&at);
        let per_nm = h / self.inertia_kg_m2;
        let v = if friction.bristle_rad > 0.0 {
            torque += friction.bristle_nm(&mut state.bristle, middle.1, h, dry);
            state.link.v_rad_s + per_nm * torque
        } else {
            stopped(state.link.v_rad_s + per_nm * torque, per_nm * dry.0, per_nm * dry.1)
        };
        state.link.take(v, h);
    }

    fn step_two(&mut self, state: &mut State, coupling: Coupling, h: f64) {
        let friction = &self.machine.friction;
        let t = state.t_s + 0.5 * h;
        let (link, motor) = (state.link.middle(h), state.motor.middle(h));
        let torques = self.torques(state, t, link, h);
        let (i_motor, i_link) = {
            let rotor = coupling.rotor * self.machine.inertia_kg_m2;
            (rotor, self.inertia_kg_m2 - rotor)
        };
        // friction of either side by its own speed; the motor's last, because the bristle is its
        let own = coupling.friction;
        let at_link = Contact { dry_speed_rad_s: link.1.abs(), ..self.contact(state, t, link, &torques, h) };
        let at_motor = self.contact(state, t, motor, &torques, h);
        let (dry_link, dry_motor) = (friction.dry_nm(&at_link), friction.dry_nm(&at_motor));
        let mut on_link = torques.link_nm + (1.0 - own) * friction.wet_nm(&at_link);
        let mut on_motor = torques.motor_nm + own * friction.wet_nm(&at_motor);
        let mut level_motor = (own * dry_motor.0, own * dry_motor.1);
        let level_link = ((1.0 - own) * dry_link.0, (1.0 - own) * dry_link.1);
        if friction.bristle_rad > 0.0 {
            on_motor += friction.bristle_nm(&mut state.bristle, motor.1, h, level_motor);
            level_motor = (0.0, 0.0);
        }
        let ahead = motor.0 - link.0;
        let half = 0.5 * coupling.play_rad;
        if coupling.stiffness.is_finite() {
            let push = coupling.push_nm(ahead, motor.1 - link.1);
            on_link += push;
            on_motor -= push;
        }
        let free_motor = state.motor.v_rad_s + h * on_motor / i_motor;
        let free_link = state.link.v_rad_s + h * on_link / i_link;
        let mut v_motor = stopped(free_motor, h * level_motor.0 / i_motor, h * level_motor.1 / i_motor);
        let mut v_link = stopped(free_link, h * level_link.0 / i_link, h * level_link.1 / i_link);
        let closing = v_motor - v_link;
        if !coupling.stiffness.is_finite() && ((ahead >= half && closing > 0.0) || (ahead <= -half && closing < 0.0)) {
            // an inelastic flank: both go on as one
            let both = i_motor + i_link;
            let free = (i_motor * free_motor + i_link * free_link) / both;
            let (up, down) = (level_motor.0 + level_link.0, level_motor.1 + level_link.1);
            v_motor = stopped(free, h * up / both, h * down / both);
            v_link = v_motor;
        }
        state.motor.take(v_motor, h);
        state.link.take(v_link, h);
    }
}

impl Coupling {
    /// Torque on the link for the motor side's lead and its rate \[N m\].
    fn push_nm(&self, ahead_rad: f64, rate_rad_s: f64) -> f64 {
        let half = 0.5 * self.play_rad;
        let depth = ahead_rad - ahead_rad.clamp(-half, half);
        if self.spring {
            return self.stiffness * depth + self.damping * rate_rad_s;
        }
        if depth == 0.0 {
            return 0.0;
        }
        // flanks push, they do not pull
        let push = self.stiffness * depth + self.damping * rate_rad_s;
        if push * depth > 0.0 { push } else { 0.0 }
    }
}
