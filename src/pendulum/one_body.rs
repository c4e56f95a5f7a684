//! The joint as one body, which sticks and slips.

use super::events::{dip, halved, zero_of};
use super::history::History;
use super::leap::{Leap, Linear, leap};
use super::rollout::{Diverged, Mechanism, Start, State};
use super::schedule::Command;
use crate::integrate::rk4;
use crate::joint::{Chain, Contact, Driven, Real};
use std::ops::{Add, Mul};

/// Halvings that find the instant at which a resting joint breaks away.
const HALVINGS: i32 = 60;

/// A joint that a whole step slows down by less than this has come to rest as it began to move \[rad/s\].
const BARELY_RAD_S: f64 = 1e-13;

/// A leap is looked at where it is so many times as long as the longest step by Runge and Kutta.
const WORTH_A_LEAP: f64 = 1.2;
/// It stands where it bends by no more than this \[rad\], of which it is off by a small part.
const BENT_RAD: f64 = 2e-5;
/// A joint that swings is followed through so much of its phase at once \[rad\], and through so much of a turn \[rad\].
const LEAP_OF_PHASE_RAD: f64 = 0.8;
const LEAP_OF_TURN_RAD: f64 = 0.5;
/// After a leap that bent too much the next one is so much as long; after every step that went well it may be so much longer.
const SHORTER: f64 = 0.5;
const LONGER: f64 = 1.5;

/// What the joint is doing.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    /// Held by the experimenter.
    Clamped,
    /// At rest; friction decides whether it stays.
    Stuck,
    /// Moving, or about to, in a direction.
    Slip(f64),
}

/// What acts on a joint that rests, its motor and friction aside.
#[derive(Clone, Copy)]
struct Load<T> {
    t_s: T,
    angle_rad: T,
    acting_nm: T,
    gravity_nm: T,
}

pub(super) struct OneBody<'a, T: Real> {
    chain: &'a Chain<T>,
    t_s: T,
    /// Angle, rate, integral of the angle error.
    y: [T; 3],
    /// Whether that integral acts.
    winds_up: bool,
    mode: Mode,
    /// Where a late encoder still sees the joint.
    history: Option<History<T>>,
    steps_left: usize,
    /// Fastest oscillation with the motor off, and on \[rad/s\]; they bound the step.
    swinging_rad_s: f64,
    driven_rad_s: f64,
    /// Divides the longest step.
    refinement: f64,
    /// What last acted on it where it rests.
    load: Option<Load<T>>,
    /// The longest leap that is tried next \[s\]: none where every step has to be short.
    leap_s: f64,
}

impl<'a, T: Real> OneBody<'a, T> {
    pub(super) fn new(chain: &'a Chain<T>, t_s: &[f64], start: Start<T>, refinement: f64, steps: usize) -> Self {
        let mode = match (start.release_s, start.rate_rad_s.re()) {
            (Some(_), _) => Mode::Clamped,
            (None, rate) if rate != 0.0 => Mode::Slip(rate.signum()),
            (None, _) => Mode::Stuck,
        };
        let from_s = T::constant(t_s.first().copied().unwrap_or(0.0));
        let late = |delay_s: T| History::begin(delay_s, from_s, [start.angle_rad, start.rate_rad_s]);
        let (history, angle_rad) = chain.sensor_delay_s.map(late).unzip();
        let winds_up = chain.motor.as_ref().is_some_and(|motor| motor.winds_up());
        let is_plain = history.is_none() && !winds_up && chain.stop.is_none() && !chain.has_laws();
        Self {
            chain,
            t_s: from_s,
            y: [angle_rad.unwrap_or(start.angle_rad), start.rate_rad_s, T::nought()],
            winds_up,
            mode,
            history,
            steps_left: steps,
            swinging_rad_s: chain.fastest_rad_s(Driven::Off),
            driven_rad_s: chain.fastest_rad_s(Driven::ByLaw),
            refinement,
            load: None,
            leap_s: if is_plain && refinement < 1.0 { f64::INFINITY } else { 0.0 },
        }
    }
}

impl<T: Real> Mechanism<T> for OneBody<'_, T> {
    fn chain(&self) -> &Chain<T> {
        self.chain
    }

    fn now_s(&self) -> T {
        self.t_s
    }

    fn clock_mut(&mut self) -> &mut T {
        &mut self.t_s
    }

    fn let_go(&mut self) {
        self.mode = Mode::Stuck;
    }

    fn state(&self) -> State<T> {
        State { angle_rad: self.y[0], rate_rad_s: self.y[1] }
    }

    fn seen(&self) -> State<T> {
        let [angle_rad, rate_rad_s] = self.seen_at(self.t_s, self.y[0], self.y[1]);
        State { angle_rad, rate_rad_s }
    }

    fn integral_mut(&mut self) -> &mut T {
        &mut self.y[2]
    }

    fn advance(&mut self, until: T, command: &Command<T>) -> Result<(), Diverged> {
        while self.t_s.re() < until.re() {
            match self.mode {
                Mode::Clamped => self.t_s = until,
                Mode::Stuck => self.stick(until, command),
                Mode::Slip(direction) => self.slip(until, command, direction)?,
            }
            if let Some(history) = &mut self.history {
                history.push(self.t_s, [self.y[0], self.y[1]]);
            }
        }
        Ok(())
    }

    fn nudge(&mut self, until: T, command: &Command<T>) {
        if let Mode::Slip(direction) = self.mode {
            let rate = self.rate(command, direction, self.t_s, &self.y);
            let step = until - self.t_s;
            self.y = std::array::from_fn(|i| self.y[i] + rate[i] * step);
        }
        self.t_s = until;
    }
}

impl<T: Real> OneBody<'_, T> {
    /// Angle and rate as the encoder shows them, before its gain.
    #[inline(always)]
    fn seen_at(&self, t_s: T, angle_rad: T, rate_rad_s: T) -> [T; 2] {
        match &self.history {
            None => [angle_rad, rate_rad_s],
            Some(history) => history.at(t_s, [angle_rad, rate_rad_s]),
        }
    }

    /// Torque of the motor \[N m\] in a state.
    #[inline(always)]
    fn motor_nm(&self, command: &Command<T>, t_s: T, [angle_rad, rate_rad_s]: &[T; 2], integral_rad_s: &T) -> T {
        let [seen_rad, seen_rad_s] = self.seen_at(t_s, *angle_rad, *rate_rad_s);
        command.turning_motor_nm(self.chain, t_s, &[seen_rad, seen_rad_s, *integral_rad_s], *rate_rad_s)
    }

    /// Acceleration while slipping \[rad/s^2\]. Dual numbers are large: nothing is handed in or out that is not needed.
    #[inline(never)]
    fn slip_rad_s2(&self, command: &Command<T>, direction: f64, t_s: T, y: &[T; 2], integral_rad_s: &T) -> T {
        let motor_nm = self.motor_nm(command, t_s, y, integral_rad_s);
        self.chain.slip_rate_rad_s2(t_s, y[0], y[1], direction, motor_nm)
    }

    /// Rate of angle, speed and error integral while slipping.
    #[inline]
    fn rate(&self, command: &Command<T>, direction: f64, t_s: T, y: &[T; 3]) -> [T; 3] {
        let [angle, rate, integral] = y;
        let acceleration = self.slip_rad_s2(command, direction, t_s, &[*angle, *rate], integral);
        [*rate, acceleration, self.error_rad(command, t_s, y)]
    }

    /// What the integral of the angle error grows by, where it acts.
    #[inline]
    fn error_rad(&self, command: &Command<T>, t_s: T, y: &[T; 3]) -> T {
        if self.winds_up { command.error_rad(self.chain, t_s, self.seen_at(t_s, y[0], y[1])[0]) } else { T::nought() }
    }

    /// The state after `dt` of slipping by Runge and Kutta, of which the rate at the beginning is known.
    fn slipped<S>(&self, command: &Command<T>, direction: f64, first: &[T; 3], dt: S) -> [T; 3]
    where
        T: Add<S, Output = T> + Mul<S, Output = T>,
        S: Copy + Mul<f64, Output = S>,
    {
        if self.winds_up {
            return rk4(|t_s, y| self.rate(command, direction, t_s, y), self.t_s, &self.y, first, dt);
        }
        let [angle, rate, integral] = self.y;
        let rates = |t_s: T, y: &[T; 2]| [y[1], self.slip_rad_s2(command, direction, t_s, y, &integral)];
        let [angle, rate] = rk4(rates, self.t_s, &[angle, rate], &[first[0], first[1]], dt);
        [angle, rate, integral]
    }

    /// A leap.
    fn leapt(&self, command: &Command<T>, direction: f64, first: &[T; 3], linear: &Linear, dt: f64) -> Leap<T> {
        let [angle, rate, integral] = self.y;
        let acceleration =
            |after_s: f64, y: [T; 2]| self.slip_rad_s2(command, direction, self.t_s + after_s, &y, &integral);
        leap(linear, [angle, rate], first[1], dt, acceleration)
    }

    /// A leap in the place of steps by Runge and Kutta of at most a length, where there is one that hardly bends: its linear
    /// part, its length, and the state at its end. Within it the joint may stop once: a speed that falls and rises again could
    /// have been below zero in between.
    fn found_leap(
        &mut self,
        command: &Command<T>,
        direction: f64,
        first: &[T; 3],
        [whole_s, longest_s]: [f64; 2],
    ) -> Option<(Linear, f64, [T; 3])> {
        let mut leap_s = self.leap_s.min(whole_s);
        if leap_s < WORTH_A_LEAP * longest_s {
            self.leap_s *= LONGER;
            return None;
        }
        let [stiffness_1_s2, decay_1_s] = self.chain.stiffness_and_decay(self.t_s.re(), command.driven());
        let linear = Linear { stiffness_1_s2, decay_1_s };
        let swings_rad_s = (linear.stiffness_1_s2 - 0.25 * linear.decay_1_s.powi(2)).max(0.0).sqrt();
        let farthest_s = (LEAP_OF_PHASE_RAD / swings_rad_s).min(LEAP_OF_TURN_RAD / self.y[1].re().abs());
        leap_s = leap_s.min(farthest_s).min(self.chain.longest_step_of_load_s());
        while leap_s >= WORTH_A_LEAP * longest_s {
            let Leap { end: [angle, rate], bent_rad, last_rad_s2 } =
                self.leapt(command, direction, first, &linear, leap_s);
            let dips = first[1].re() * direction < 0.0 && last_rad_s2 * direction > 0.0 && rate.re() * direction > 0.0;
            if bent_rad <= BENT_RAD && !dips {
                self.leap_s = self.leap_s.max(leap_s) * LONGER;
                return Some((linear, leap_s, [angle, rate, self.y[2]]));
            }
            leap_s *= SHORTER;
            self.leap_s = leap_s;
        }
        None
    }

    /// What acts on the joint where it rests at an instant, its motor and friction aside.
    fn load_at(&self, t_s: T) -> Load<T> {
        let angle_rad = self.y[0];
        match self.load {
            Some(known) if known.t_s == t_s && known.angle_rad == angle_rad => known,
            _ => {
                let [acting_nm, gravity_nm] = self.chain.acting_at_rest_nm(t_s, angle_rad);
                Load { t_s, angle_rad, acting_nm, gravity_nm }
            }
        }
    }

    /// How far the torque on the resting joint is beyond breakaway \[N m\] in the direction in which it acts, and that.
    fn beyond_breakaway(&self, command: &Command<T>, load: &Load<T>, integral_rad_s: &T) -> (T, f64) {
        let torques_nm = self.resting_nm(command, load, integral_rad_s);
        let direction = if torques_nm[1].re() < 0.0 { -1.0 } else { 1.0 };
        (self.beyond_in(direction, torques_nm, load), direction)
    }

    /// The same in a direction, of the motor's torque and the net one.
    fn beyond_in(&self, direction: f64, [motor_nm, net_nm]: [T; 2], load: &Load<T>) -> T {
        let Load { t_s, angle_rad, gravity_nm, .. } = *load;
        let at = Contact { t_s, angle_rad, speed_rad_s: T::nought(), direction, gravity_nm, motor_nm };
        net_nm * direction - self.chain.friction.breakaway_nm(&at)
    }

    /// Torque of the motor, and of all that acts on the resting joint but friction \[N m\].
    fn resting_nm(&self, command: &Command<T>, load: &Load<T>, integral_rad_s: &T) -> [T; 2] {
        let motor_nm = self.motor_nm(command, load.t_s, &[load.angle_rad, T::nought()], integral_rad_s);
        [motor_nm, motor_nm + load.acting_nm]
    }

    /// The state of a resting joint after `dt`: only the error integral moves.
    fn rested(&self, command: &Command<T>, dt: T) -> [T; 3] {
        let middle_s = self.t_s + dt * 0.5;
        let error = self.error_rad(command, middle_s, &self.y);
        [self.y[0], T::nought(), self.y[2] + error * dt]
    }

    /// A resting joint stays, or breaks away at an instant before `until`.
    fn stick(&mut self, until: T, command: &Command<T>) {
        self.y[1] = T::nought();
        let at_start = self.load_at(self.t_s);
        let (beyond, direction) = self.beyond_breakaway(command, &at_start, &self.y[2]);
        if beyond.re() > 0.0 {
            self.mode = Mode::Slip(direction);
            return;
        }
        let steady = command.is_steady(self.chain) && !self.chain.changes_with_time();
        let longest_s = self.chain.longest_step_of_load_s();
        let until = if (until - self.t_s).re() > longest_s { self.t_s + longest_s } else { until };
        let whole = until - self.t_s;
        let later = |at_s: T, dt: T| {
            let (load, y) = (self.load_at(at_s), self.rested(command, dt));
            let (beyond, direction) = self.beyond_breakaway(command, &load, &y[2]);
            (beyond, direction, y, load)
        };
        let (beyond_end, direction, y_end, load) =
            if steady { (beyond, direction, self.y, at_start) } else { later(until, whole) };
        if beyond_end.re() <= 0.0 {
            self.load = Some(load);
            if !steady {
                self.y = y_end;
            } else if let Command::Pid { .. } = command {
                self.y = self.rested(command, whole);
            }
            self.t_s = until;
            return;
        }
        let at_ends = [beyond.re(), beyond_end.re()];
        let later = |dt: f64| later(self.t_s + dt, T::constant(dt)).0;
        let [_, high] = halved(|dt| later(dt).re(), at_ends, whole.re(), HALVINGS);
        // One Newton step in T gives the instant its derivatives; its slope is a difference over all that was looked at, of the
        // torque in one direction: it may have turned from the other.
        let here = later(high);
        let beyond_there = self.beyond_in(direction, self.resting_nm(command, &at_start, &self.y[2]), &at_start);
        let slope = (beyond_end.re() - beyond_there.re()) / whole.re();
        let dt = if slope > 0.0 { T::constant(high) - (here - here.re()) / slope } else { T::constant(high) };
        self.y = self.rested(command, dt);
        self.t_s += dt;
        self.mode = Mode::Slip(direction);
    }

    /// One step of a slipping joint, cut short where its speed passes through zero.
    fn slip(&mut self, until: T, command: &Command<T>, direction: f64) -> Result<(), Diverged> {
        let driven = command.driven();
        let whole = until - self.t_s;
        let fastest_rad_s = if driven == Driven::ByLaw { self.driven_rad_s } else { self.swinging_rad_s };
        let [angle, rate, _] = self.y;
        let longest_s =
            self.chain.longest_step_s(self.t_s.re(), fastest_rad_s, angle.re(), rate.re(), driven) / self.refinement;
        let longest_s = longest_s.min(self.chain.longest_step_of_load_s());
        let parts = (whole.re() / longest_s).ceil().max(1.0);
        if !(parts <= self.steps_left as f64) {
            return Err(Diverged { at_s: self.t_s.re() });
        }
        let rate = |this: &Self, t_s: T, y: &[T; 3]| this.rate(command, direction, t_s, y);
        let first = rate(self, self.t_s, &self.y);
        let leap = self.found_leap(command, direction, &first, [whole.re(), longest_s]);
        let (step, is_whole) = match &leap {
            Some((_, step_s, _)) if *step_s < whole.re() => (T::constant(*step_s), false),
            None if parts > 1.0 => (whole * (1.0 / parts), false),
            _ => (whole, true),
        };
        // What a leap is in the place of may be no more than any log needs either.
        self.steps_left -= ((step.re() / longest_s) as usize).clamp(1, self.steps_left);
        let linear = leap.as_ref().map(|(linear, ..)| *linear);
        let this = &*self;
        let stop_at = |dt: f64| match &linear {
            Some(linear) => {
                let [angle, rate] = this.leapt(command, direction, &first, linear, dt).end;
                [angle, rate, this.y[2]]
            }
            None => this.slipped(command, direction, &first, dt),
        };
        // After a step to an instant that may have derivatives; `near` is the state at its plain one.
        let stop = |dt: T, near: &dyn Fn() -> [T; 3]| match linear {
            _ if dt.is_constant() => near(),
            Some(_) => {
                let (late_s, near) = (dt - dt.re(), near());
                let there = rate(this, this.t_s + dt.re(), &near);
                std::array::from_fn(|i| near[i] + there[i] * late_s)
            }
            None => this.slipped(command, direction, &first, dt),
        };
        let y1 = stop(step, &|| leap.map_or_else(|| stop_at(step.re()), |(_, _, end)| end));
        let speed = |y: &[T; 3]| y[1].re() * direction;
        let (before, after) = (speed(&self.y), speed(&y1));
        let bracket = if after <= 0.0 {
            Some(step.re())
        } else {
            let slope_after = || rate(this, this.t_s + step, &y1)[1].re() * direction;
            dip([before, after], first[1].re() * direction, slope_after, step.re())
                .filter(|&dt| speed(&stop_at(dt)) <= 0.0)
        };
        let Some(bracket) = bracket else {
            self.y = y1;
            self.t_s = if is_whole { until } else { self.t_s + step };
            return Ok(());
        };
        let Some(dt) = zero_of(|dt| speed(&stop_at(dt)), before, bracket) else {
            // It never got going within this step: it rests.
            self.y = self.rested(command, step);
            self.t_s = if is_whole { until } else { self.t_s + step };
            self.mode = Mode::Stuck;
            return Ok(());
        };
        // The same Newton step as at a breakaway; what barely moves comes to rest at no instant that derivatives would know.
        let near = stop_at(dt);
        let deceleration = rate(self, self.t_s + dt, &near)[1];
        let stops = deceleration.re() * direction * step.re() < -BARELY_RAD_S;
        let dt = T::constant(dt);
        let dt = if stops { dt - (near[1] - near[1].re()) / deceleration } else { dt };
        self.y = stop(dt, &|| near);
        self.y[1] = T::nought();
        self.t_s += dt;
        self.mode = Mode::Stuck;
        Ok(())
    }
}
