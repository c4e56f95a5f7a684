//! The joint as one body, which sticks and slips.

use super::events::{dip, halved, zero_of};
use super::history::History;
use super::rollout::{Diverged, Mechanism, Start, State};
use super::schedule::Command;
use crate::integrate::rk4;
use crate::joint::{Chain, Driven, Real};
use std::ops::{Add, Mul};

/// Halvings that find the instant at which a resting joint breaks away.
const HALVINGS: i32 = 60;

/// A joint that a whole step slows down by less than this has come to rest as it began to move \[rad/s\].
const BARELY_RAD_S: f64 = 1e-13;

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
        Self {
            chain,
            t_s: from_s,
            y: [angle_rad.unwrap_or(start.angle_rad), start.rate_rad_s, T::nought()],
            winds_up: chain.motor.as_ref().is_some_and(|motor| motor.winds_up()),
            mode,
            history,
            steps_left: steps,
            swinging_rad_s: chain.fastest_rad_s(Driven::Off),
            driven_rad_s: chain.fastest_rad_s(Driven::ByLaw),
            refinement,
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

    /// The state after `dt` of slipping, of which the rate at the beginning is known.
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

    /// How far the torque on the resting joint is beyond breakaway \[N m\] in the direction in which it acts, and that.
    fn beyond_breakaway(&self, command: &Command<T>, t_s: T, y: &[T; 3]) -> (T, f64) {
        let torques_nm = self.resting_nm(command, t_s, y);
        let direction = if torques_nm[1].re() < 0.0 { -1.0 } else { 1.0 };
        (self.beyond_in(direction, torques_nm, t_s, y[0]), direction)
    }

    /// The same in a direction, of the motor's torque and the net one.
    fn beyond_in(&self, direction: f64, [motor_nm, net_nm]: [T; 2], t_s: T, angle_rad: T) -> T {
        net_nm * direction - self.chain.breakaway_nm(t_s, angle_rad, direction, motor_nm)
    }

    /// Torque of the motor, and of all that acts on the resting joint but friction \[N m\].
    fn resting_nm(&self, command: &Command<T>, t_s: T, y: &[T; 3]) -> [T; 2] {
        let motor_nm = self.motor_nm(command, t_s, &[y[0], y[1]], &y[2]);
        [motor_nm, self.chain.drive_nm(t_s, y[0], motor_nm)]
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
        let (beyond, direction) = self.beyond_breakaway(command, self.t_s, &self.y);
        if beyond.re() > 0.0 {
            self.mode = Mode::Slip(direction);
            return;
        }
        let steady = command.is_steady(self.chain) && !self.chain.changes_with_time();
        let longest_s = self.chain.longest_step_of_load_s();
        let until = if (until - self.t_s).re() > longest_s { self.t_s + longest_s } else { until };
        let whole = until - self.t_s;
        let later = |dt: T| {
            let y = self.rested(command, dt);
            let (beyond, direction) = self.beyond_breakaway(command, self.t_s + dt, &y);
            (beyond, direction, y)
        };
        let (beyond_end, direction, y_end) = if steady { (beyond, direction, self.y) } else { later(whole) };
        if beyond_end.re() <= 0.0 {
            if !steady {
                self.y = y_end;
            } else if let Command::Pid { .. } = command {
                self.y = self.rested(command, whole);
            }
            self.t_s = until;
            return;
        }
        let at_ends = [beyond.re(), beyond_end.re()];
        let [_, high] = halved(|dt| later(T::constant(dt)).0.re(), at_ends, whole.re(), HALVINGS);
        // One Newton step in T gives the instant its derivatives; its slope is a difference over all that was looked at, of the
        // torque in one direction: it may have turned from the other.
        let here = later(T::constant(high)).0;
        let at_start = self.beyond_in(direction, self.resting_nm(command, self.t_s, &self.y), self.t_s, self.y[0]);
        let slope = (beyond_end.re() - at_start.re()) / whole.re();
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
        self.steps_left -= 1;
        let rate = |t_s: T, y: &[T; 3]| self.rate(command, direction, t_s, y);
        let step = if parts > 1.0 { whole * (1.0 / parts) } else { whole };
        let first = rate(self.t_s, &self.y);
        let stop_at = |dt: f64| self.slipped(command, direction, &first, dt);
        let stop =
            |dt: T| if dt.is_constant() { stop_at(dt.re()) } else { self.slipped(command, direction, &first, dt) };
        let y1 = stop(step);
        let speed = |y: &[T; 3]| y[1].re() * direction;
        let (before, after) = (speed(&self.y), speed(&y1));
        let bracket = if after <= 0.0 {
            Some(step.re())
        } else {
            let slope_after = || rate(self.t_s + step, &y1)[1].re() * direction;
            dip([before, after], first[1].re() * direction, slope_after, step.re())
                .filter(|&dt| speed(&stop_at(dt)) <= 0.0)
        };
        let Some(bracket) = bracket else {
            self.y = y1;
            self.t_s = if parts > 1.0 { self.t_s + step } else { until };
            return Ok(());
        };
        let Some(dt) = zero_of(|dt| speed(&stop_at(dt)), before, bracket) else {
            // It never got going within this step: it rests.
            self.y = self.rested(command, step);
            self.t_s = if parts > 1.0 { self.t_s + step } else { until };
            self.mode = Mode::Stuck;
            return Ok(());
        };
        // The same Newton step as at a breakaway; what barely moves comes to rest at no instant that derivatives would know.
        let near = stop_at(dt);
        let deceleration = rate(self.t_s + dt, &near)[1];
        let stops = deceleration.re() * direction * step.re() < -BARELY_RAD_S;
        let dt = T::constant(dt);
        let dt = if stops { dt - (near[1] - near[1].re()) / deceleration } else { dt };
        self.y = stop(dt);
        self.y[1] = T::nought();
        self.t_s += dt;
        self.mode = Mode::Stuck;
        Ok(())
    }
}
