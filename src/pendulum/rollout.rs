//! A joint let go, driven or held: its motion from a start to the end of a log, with true sticking.
//!
//! Between events the joint obeys (3.12) with friction of one sign, which is smooth, and is integrated by Runge-Kutta 4.
//! Events are located inside the step: a speed that passes through zero (the joint sticks or turns back), a sticking
//! joint that breaks away, the release of a held joint. Event times carry derivatives.

use crate::integrate::rk4;
use crate::joint::{Chain, Real, Setpoint};
use crate::log::Hold;

/// What acts on the joint along a log; the slices are as long as the log's times.
#[derive(Clone, Copy, Debug)]
pub enum Input<'a> {
    /// Motor off.
    Off,
    /// A torque on the joint.
    Torque {
        /// Held from its sample to the next \[N m\].
        torque_nm: &'a [f64],
        /// Whether the motor is on; `None`: always.
        on: Option<&'a [bool]>,
    },
    /// A setpoint through the chain's motor.
    Position {
        /// \[rad\]
        setpoint_rad: &'a [f64],
        /// How it is read between its samples.
        hold: Hold,
        /// Whether the motor is on; `None`: always.
        on: Option<&'a [bool]>,
    },
}

/// How a motion begins.
#[derive(Clone, Copy, Debug)]
pub struct Start<T> {
    /// Joint angle \[rad\].
    pub angle_rad: T,
    /// Joint speed \[rad/s\].
    pub rate_rad_s: T,
    /// The joint is held still until this instant \[s\]; `None`: it is free from the first sample on.
    pub release_s: Option<T>,
}

/// The joint at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T> {
    /// Joint angle \[rad\].
    pub angle_rad: T,
    /// Joint speed \[rad/s\].
    pub rate_rad_s: T,
}

/// The motion left all bounds, or would take more steps than any log needs.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the motion diverged at t = {at_s} s")]
pub struct Diverged {
    /// When \[s\].
    pub at_s: f64,
}

/// Beyond this angle \[rad\] a motion counts as diverged.
const RUNAWAY_RAD: f64 = 1e4;
/// Integration steps per sample, on average, after which a motion counts as diverged.
const STEPS_PER_SAMPLE: usize = 400;

/// Integrates a joint through the sample times of a log and shows each sample's state to `visit`.
///
/// # Errors
/// [`Diverged`] where the angle runs away, is not finite, or the step budget is spent.
pub fn rollout<T: Real>(
    chain: &Chain<T>,
    input: Input<'_>,
    t_s: &[f64],
    start: Start<T>,
    visit: impl FnMut(usize, &State<T>),
) -> Result<(), Diverged> {
    rollout_refined(chain, input, t_s, start, 1.0, visit)
}

/// [`rollout`] with steps `refinement` times shorter than the rule asks for, to see what the steps cost in accuracy.
///
/// # Errors
/// As [`rollout`].
pub fn rollout_refined<T: Real>(
    chain: &Chain<T>,
    input: Input<'_>,
    t_s: &[f64],
    start: Start<T>,
    refinement: f64,
    mut visit: impl FnMut(usize, &State<T>),
) -> Result<(), Diverged> {
    let Some(&t0) = t_s.first() else { return Ok(()) };
    let mode = match (start.release_s, start.rate_rad_s.re()) {
        (Some(_), _) => Mode::Clamped,
        (None, rate) if rate != 0.0 => Mode::Slip(rate.signum()),
        (None, _) => Mode::Stuck,
    };
    let mut run = Run {
        chain,
        t_s: T::constant(t0),
        y: [start.angle_rad, start.rate_rad_s, T::nought()],
        mode,
        steps_left: (refinement.max(1.0) as usize) * (STEPS_PER_SAMPLE * t_s.len() + 10_000),
        swinging_rad_s: chain.fastest_rad_s(false),
        driven_rad_s: chain.fastest_rad_s(true),
        refinement,
    };
    let mut release_s = start.release_s;
    let sample_period_s = match input {
        Input::Position { .. } => chain.motor.as_ref().and_then(|m| m.sample_period_s()),
        _ => None,
    };
    let mut ticks = 0u64;
    let mut held_nm = T::nought();
    visit(0, &run.state());
    for k in 1..t_s.len() {
        let (from, to) = (t_s[k - 1], t_s[k]);
        loop {
            let mut until = T::constant(to);
            let mut releases = false;
            if let Some(r) = release_s
                && r.re() <= to
            {
                (until, releases) = (r, true);
            }
            let mut command = command(input, k, from, to);
            if let (Some(period_s), Command::Pid { setpoint_rad, slope_rad_s, from_s }) = (sample_period_s, command) {
                let next_tick = t0 + ticks as f64 * period_s;
                if next_tick <= run.t_s.re() + 1e-12 {
                    let setpoint = Setpoint {
                        angle_rad: T::constant(setpoint_rad) + (run.t_s - from_s) * slope_rad_s,
                        rate_rad_s: T::constant(slope_rad_s),
                    };
                    held_nm = run.sampled_torque_nm(setpoint, period_s);
                    ticks += 1;
                    continue;
                }
                if next_tick < until.re() {
                    (until, releases) = (T::constant(next_tick), false);
                }
                command = Command::Torque(held_nm);
            }
            run.advance(until, command)?;
            if releases {
                // A release that falls on a sample must still bear its derivative: the clock takes it over.
                if until.re() >= run.t_s.re() {
                    run.t_s = until;
                }
                (release_s, run.mode) = (None, Mode::Stuck);
            }
            if run.t_s.re() >= to {
                break;
            }
        }
        if !(run.y[0].re().abs() < RUNAWAY_RAD && run.y[1].re().is_finite()) {
            return Err(Diverged { at_s: to });
        }
        visit(k, &run.state());
    }
    Ok(())
}

/// The torque law between two events.
#[derive(Clone, Copy)]
enum Command<T> {
    Torque(T),
    Pid { setpoint_rad: f64, slope_rad_s: f64, from_s: f64 },
}

/// What acts from sample `k - 1` to sample `k`.
fn command<T: Real>(input: Input<'_>, k: usize, from_s: f64, to_s: f64) -> Command<T> {
    let is_on = |on: Option<&[bool]>| on.is_none_or(|on| on[k - 1]);
    match input {
        Input::Torque { torque_nm, on } if is_on(on) => Command::Torque(T::constant(torque_nm[k - 1])),
        Input::Position { setpoint_rad, hold, on } if is_on(on) => {
            let slope_rad_s = match hold {
                Hold::Step => 0.0,
                Hold::Linear => (setpoint_rad[k] - setpoint_rad[k - 1]) / (to_s - from_s),
            };
            Command::Pid { setpoint_rad: setpoint_rad[k - 1], slope_rad_s, from_s }
        }
        _ => Command::Torque(T::nought()),
    }
}

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

struct Run<'a, T: Real> {
    chain: &'a Chain<T>,
    t_s: T,
    /// Angle, rate, integral of the angle error.
    y: [T; 3],
    mode: Mode,
    steps_left: usize,
    /// Fastest oscillation with the motor off, and on \[rad/s\]; they bound the step.
    swinging_rad_s: f64,
    driven_rad_s: f64,
    /// Divides the longest step.
    refinement: f64,
}

impl<T: Real> Run<'_, T> {
    fn state(&self) -> State<T> {
        State { angle_rad: self.y[0], rate_rad_s: self.y[1] }
    }

    /// The controller's law evaluated at one instant; its integral grows by one period.
    fn sampled_torque_nm(&mut self, setpoint: Setpoint<T>, period_s: f64) -> T {
        let Some(motor) = &self.chain.motor else { return T::nought() };
        let torque_nm = motor.torque_nm(setpoint, self.y[0], self.y[1], self.y[2]);
        self.y[2] += (setpoint.angle_rad - self.y[0]) * period_s;
        torque_nm
    }

    fn motor_nm(&self, command: Command<T>, t_s: T, y: &[T; 3]) -> T {
        match (command, &self.chain.motor) {
            (Command::Torque(torque_nm), _) => torque_nm,
            (Command::Pid { setpoint_rad, slope_rad_s, from_s }, Some(motor)) => {
                let angle_rad = (t_s - from_s) * slope_rad_s + setpoint_rad;
                motor.torque_nm(Setpoint { angle_rad, rate_rad_s: T::constant(slope_rad_s) }, y[0], y[1], y[2])
            }
            (Command::Pid { .. }, None) => T::nought(),
        }
    }

    /// Rate of angle, speed and error integral while slipping.
    fn rate(&self, command: Command<T>, direction: f64, t_s: T, y: &[T; 3]) -> [T; 3] {
        let motor_nm = self.motor_nm(command, t_s, y);
        let error = match command {
            Command::Torque(_) => T::nought(),
            Command::Pid { setpoint_rad, slope_rad_s, from_s } => (t_s - from_s) * slope_rad_s + setpoint_rad - y[0],
        };
        [y[1], self.chain.slip_rate_rad_s2(t_s, y[0], y[1], direction, motor_nm), error]
    }

    /// Moves the joint to `until`, through as many events as happen before it.
    fn advance(&mut self, until: T, command: Command<T>) -> Result<(), Diverged> {
        while self.t_s.re() < until.re() {
            match self.mode {
                Mode::Clamped => self.t_s = until,
                Mode::Stuck => self.stick(until, command),
                Mode::Slip(direction) => self.slip(until, command, direction)?,
            }
        }
        Ok(())
    }

    /// How far the torque on the resting joint is beyond breakaway \[N m\], and its direction.
    fn beyond_breakaway(&self, command: Command<T>, t_s: T, y: &[T; 3]) -> (T, f64) {
        let motor_nm = self.motor_nm(command, t_s, y);
        let net_nm = self.chain.drive_nm(y[0], motor_nm);
        let direction = if net_nm.re() < 0.0 { -1.0 } else { 1.0 };
        (net_nm * direction - self.chain.breakaway_nm(t_s, y[0], direction, motor_nm), direction)
    }

    /// The state of a resting joint after `dt`: only the error integral moves.
    fn rested(&self, command: Command<T>, dt: T) -> [T; 3] {
        let integral = match command {
            Command::Torque(_) => self.y[2],
            Command::Pid { setpoint_rad, slope_rad_s, from_s } => {
                let error = (self.t_s - from_s + dt * 0.5) * slope_rad_s + setpoint_rad - self.y[0];
                self.y[2] + error * dt
            }
        };
        [self.y[0], T::nought(), integral]
    }

    /// A resting joint stays, or breaks away at an instant before `until`.
    fn stick(&mut self, until: T, command: Command<T>) {
        self.y[1] = T::nought();
        let (beyond, direction) = self.beyond_breakaway(command, self.t_s, &self.y);
        if beyond.re() > 0.0 {
            self.mode = Mode::Slip(direction);
            return;
        }
        let steady = match command {
            Command::Torque(_) => true,
            Command::Pid { slope_rad_s, .. } => {
                slope_rad_s == 0.0 && !self.chain.motor.as_ref().is_some_and(|m| m.winds_up())
            }
        };
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
        let (mut low, mut high) = (0.0, whole.re());
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if later(T::constant(middle)).0.re() > 0.0 { high = middle } else { low = middle }
        }
        // One Newton step in T gives the instant its derivatives; its slope is a difference over the bracketing half.
        let here = later(T::constant(high)).0;
        let slope = (beyond_end.re() - beyond.re()) / whole.re();
        let dt = if slope > 0.0 { T::constant(high) - (here - here.re()) / slope } else { T::constant(high) };
        self.y = self.rested(command, dt);
        self.t_s += dt;
        self.mode = Mode::Slip(direction);
    }

    /// One step of a slipping joint, cut short where its speed passes through zero.
    fn slip(&mut self, until: T, command: Command<T>, direction: f64) -> Result<(), Diverged> {
        let motor_on = matches!(command, Command::Pid { .. });
        let whole = until - self.t_s;
        let fastest_rad_s = if motor_on { self.driven_rad_s } else { self.swinging_rad_s };
        let longest_s = self.chain.longest_step_s(fastest_rad_s, self.y[1].re(), motor_on) / self.refinement;
        let parts = (whole.re() / longest_s).ceil().max(1.0);
        if !(parts <= self.steps_left as f64) {
            return Err(Diverged { at_s: self.t_s.re() });
        }
        self.steps_left -= 1;
        let rate = |t_s: T, y: &[T; 3]| self.rate(command, direction, t_s, y);
        let step = if parts > 1.0 { whole * (1.0 / parts) } else { whole };
        let first = rate(self.t_s, &self.y);
        let y1 = rk4(rate, self.t_s, &self.y, &first, step);
        let speed = |y: &[T; 3]| y[1].re() * direction;
        let (before, after) = (speed(&self.y), speed(&y1));
        let bracket = if after <= 0.0 {
            Some(step.re())
        } else {
            let slope_after = || rate(self.t_s + step, &y1)[1].re() * direction;
            dip([before, after], first[1].re() * direction, slope_after, step.re())
                .filter(|&dt| speed(&rk4(rate, self.t_s, &self.y, &first, T::constant(dt))) <= 0.0)
        };
        let Some(bracket) = bracket else {
            self.y = y1;
            self.t_s = if parts > 1.0 { self.t_s + step } else { until };
            return Ok(());
        };
        let stop = |dt: T| rk4(rate, self.t_s, &self.y, &first, dt);
        let Some(dt) = zero_of(|dt| speed(&stop(T::constant(dt))), before, bracket) else {
            // It never got going within this step: it rests.
            self.y[1] = T::nought();
            self.t_s = if parts > 1.0 { self.t_s + step } else { until };
            self.mode = Mode::Stuck;
            return Ok(());
        };
        let near = stop(T::constant(dt));
        let deceleration = rate(self.t_s + dt, &near)[1];
        let dt = if deceleration.re() * direction < 0.0 {
            T::constant(dt) - near[1] / deceleration
        } else {
            T::constant(dt)
        };
        self.y = stop(dt);
        self.y[1] = T::nought();
        self.t_s += dt;
        self.mode = Mode::Stuck;
        Ok(())
    }
}

/// The instant inside a step at which a speed that falls and rises again may have dipped below zero.
///
/// `speed` holds the speeds at both ends. The slope at the end costs a rate, so it is asked for only where the deepest
/// dip that the first slope allows would reach zero.
fn dip(speed: [f64; 2], slope_before: f64, slope_after: impl Fn() -> f64, step_s: f64) -> Option<f64> {
    let [before, after] = speed;
    let lowest = |dt: f64| before.min(after) + 0.5 * slope_before * dt;
    if before <= 0.0 || !(slope_before < 0.0 && lowest(step_s) < 0.0) {
        return None;
    }
    let slope_after = slope_after();
    if !(slope_after > 0.0) {
        return None;
    }
    // Minimum of the parabola with these end slopes; a step is short against the curvature's change.
    let dt = step_s * slope_before / (slope_before - slope_after);
    (lowest(dt) < 0.0).then_some(dt)
}

/// The instant in `(0, bracket]` at which `speed`, positive just after 0, falls through zero (Illinois method).
fn zero_of(speed: impl Fn(f64) -> f64, at_start: f64, bracket: f64) -> Option<f64> {
    let (mut low, mut f_low) = (0.0, at_start);
    let (mut high, mut f_high) = (bracket, speed(bracket));
    if f_low <= 0.0 {
        // The motion begins at rest: find an instant at which it is under way.
        low = bracket;
        for _ in 0..12 {
            low *= 0.5;
            f_low = speed(low);
            if f_low > 0.0 {
                break;
            }
            (high, f_high) = (low, f_low);
        }
        if f_low <= 0.0 {
            return None;
        }
    }
    let mut last_side = 0;
    for _ in 0..60 {
        if f_high == 0.0 || high - low <= 1e-15 * bracket.max(1e-9) {
            break;
        }
        let dt = ((low * f_high - high * f_low) / (f_high - f_low)).clamp(low, high);
        let f = speed(dt);
        if f.abs() < 1e-13 {
            return Some(dt);
        }
        if f > 0.0 {
            (low, f_low) = (dt, f);
            if last_side == 1 {
                f_high *= 0.5;
            }
            last_side = 1;
        } else {
            (high, f_high) = (dt, f);
            if last_side == -1 {
                f_low *= 0.5;
            }
            last_side = -1;
        }
    }
    Some(high)
}

#[cfg(test)]
#[path = "rollout_tests.rs"]
mod tests;
