//! What acts on the joint at each instant: setpoints and torques, as late and as rarely as the chain lets them through.

use super::profile::Profile;
use crate::joint::{Chain, Driven, Real, Setpoint, SetpointPath};
use crate::log::Hold;

/// What acts on the joint along a log; the slices are as long as the log's times, which count from its start.
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
    /// The same with setpoints that have stamps of their own: `on` alone is as long as the log's times.
    Messages {
        /// When each setpoint was given \[s\], strictly increasing; they may begin before the log and end after it.
        at_s: &'a [f64],
        /// As many \[rad\].
        setpoint_rad: &'a [f64],
        /// How it is read between its messages.
        hold: Hold,
        /// Whether the motor is on; `None`: always.
        on: Option<&'a [bool]>,
    },
}

/// What is asked of the motor between two events.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Command<T> {
    /// Nothing: the motor is off.
    Off,
    /// A torque \[N m\], before the motor's gain and limits.
    Torque(T),
    /// An answer of the control law that is held, a torque \[N m\] or a duty, and the slope that its setpoint had.
    Held { answer: T, setpoint_rad_s: T },
    /// A setpoint, `setpoint_rad + slope_rad_s (t - from_s)`, through the control law; on a profile it has the `curve`'s rate
    /// and acceleration instead \[rad/s, rad/s^2\].
    Pid { setpoint_rad: T, slope_rad_s: f64, from_s: T, curve: Option<[T; 2]> },
}

impl<T: Real> Command<T> {
    /// The torque that arrives at the joint \[N m\]; `y` is angle, rate, integral of the angle error. A late reading is
    /// taken to first order in its delay.
    #[inline]
    pub(crate) fn motor_nm(&self, chain: &Chain<T>, t_s: T, y: &[T; 3]) -> T {
        match chain.sensor_delay_s {
            None => self.turning_motor_nm(chain, t_s, y, y[1]),
            Some(delay_s) => self.turning_motor_nm(chain, t_s, &[y[0] - delay_s * y[1], y[1], y[2]], y[1]),
        }
    }

    /// The same where the motor does not turn at the rate that the controller sees; `seen` is true angle and rate there,
    /// and the integral of the angle error.
    #[inline(always)]
    pub(crate) fn turning_motor_nm(&self, chain: &Chain<T>, t_s: T, seen: &[T; 3], motor_rad_s: T) -> T {
        let delivered_nm = match *self {
            Command::Off => T::nought(),
            Command::Torque(command) | Command::Held { answer: command, .. } => {
                chain.delivered_nm(command, motor_rad_s)
            }
            Command::Pid { .. } => match self.setpoint(t_s) {
                Some(setpoint) => chain.turning_motor_nm(t_s, setpoint, *seen, motor_rad_s),
                None => T::nought(),
            },
        };
        match chain.has_laws() {
            true => chain.with_laws_of_drive(delivered_nm, t_s, [seen[0], motor_rad_s], || self.setpoint_rad_s(t_s)),
            false => delivered_nm,
        }
    }

    /// An answer of the control law to this command that is held from `t_s` on.
    pub(crate) fn held(&self, answer: T, t_s: T) -> Self {
        Command::Held { answer, setpoint_rad_s: self.setpoint_rad_s(t_s) }
    }

    /// Slope of the setpoint \[rad/s\]; zero where there is none.
    #[inline]
    fn setpoint_rad_s(&self, t_s: T) -> T {
        match *self {
            Command::Held { setpoint_rad_s, .. } => setpoint_rad_s,
            _ => self.setpoint(t_s).map_or(T::nought(), |setpoint| setpoint.rate_rad_s),
        }
    }

    /// The setpoint at an instant, where there is one.
    #[inline(always)]
    pub(crate) fn setpoint(&self, t_s: T) -> Option<Setpoint<T>> {
        let Command::Pid { setpoint_rad, slope_rad_s, from_s, curve } = *self else { return None };
        let elapsed_s = t_s - from_s;
        Some(match curve {
            None => {
                Setpoint { angle_rad: elapsed_s * slope_rad_s + setpoint_rad, rate_rad_s: T::constant(slope_rad_s) }
            }
            Some([rate, acceleration]) => Setpoint {
                angle_rad: elapsed_s * (rate + elapsed_s * acceleration * 0.5) + setpoint_rad,
                rate_rad_s: rate + elapsed_s * acceleration,
            },
        })
    }

    /// Whether what is asked for stays as it is by itself.
    #[inline]
    pub(crate) fn is_still(&self) -> bool {
        match *self {
            Command::Off | Command::Torque(_) | Command::Held { .. } => true,
            Command::Pid { slope_rad_s, curve, .. } => slope_rad_s == 0.0 && curve.is_none(),
        }
    }

    /// What moves the joint.
    #[inline]
    pub(crate) fn driven(&self) -> Driven {
        match *self {
            Command::Off => Driven::Off,
            Command::Torque(_) | Command::Held { .. } => Driven::Held,
            Command::Pid { .. } => Driven::ByLaw,
        }
    }

    /// Setpoint less reading \[rad\], at a true angle; zero where there is no setpoint.
    #[inline]
    pub(crate) fn error_rad(&self, chain: &Chain<T>, t_s: T, angle_rad: T) -> T {
        match self.setpoint(t_s) {
            None => T::nought(),
            Some(setpoint) => setpoint.angle_rad - chain.reading_rad(t_s, angle_rad),
        }
    }

    /// True where the torque on a resting joint does not change by itself.
    pub(crate) fn is_steady(&self, chain: &Chain<T>) -> bool {
        match *self {
            Command::Off | Command::Torque(_) | Command::Held { .. } => true,
            Command::Pid { .. } => {
                self.is_still() && chain.sensor_delay_s.is_none() && !chain.motor.as_ref().is_some_and(|m| m.winds_up())
            }
        }
    }
}

/// Steps through an input in time.
pub(crate) struct Schedule<'a, T> {
    input: Input<'a>,
    t_s: &'a [f64],
    /// Stamps of what is asked: those of the log, or its own.
    at_s: &'a [f64],
    path: SetpointPath<T>,
    /// Setpoint or torque in force, where the path is not perfect: value, slope, since when.
    in_force: (T, f64, T),
    /// Number of the next change.
    next: usize,
    /// Where the servo runs its own profile to the setpoint.
    profile: Option<Profile<T>>,
}

/// A hold shorter than this \[s\] is none.
const SHORTEST_HOLD_S: f64 = 1e-4;
/// What is no further apart is the same instant: a reading of the setpoint just before a sample takes that sample \[s\].
pub(crate) const SAME_INSTANT_S: f64 = 1e-9;
/// A hold so near to a whole number of sampling periods that its last reading in the log is off by less than this share
/// of a period is that number: a hair less would be a hold that reads the sample before, which is a delay.
const WHOLE: f64 = 0.2;

impl<'a, T: Real> Schedule<'a, T> {
    pub(crate) fn new(input: Input<'a>, t_s: &'a [f64], path: SetpointPath<T>) -> Self {
        let hold_s = path.hold_s.filter(|hold| hold.re() >= SHORTEST_HOLD_S).map(|hold| whole_periods(hold, t_s));
        let start_s = T::constant(t_s.first().copied().unwrap_or(0.0));
        // Messages that have arrived when the part begins.
        let (at_s, given) = match input {
            Input::Messages { at_s, .. } => {
                let late_s = path.delay_s.map_or(0.0, |delay| delay.re());
                (at_s, at_s.partition_point(|at| at + late_s <= start_s.re() + SAME_INSTANT_S))
            }
            _ => (t_s, 0),
        };
        let first = match input {
            Input::Off => 0.0,
            Input::Torque { torque_nm: values, .. } | Input::Position { setpoint_rad: values, .. } => {
                values.first().copied().unwrap_or(0.0)
            }
            Input::Messages { setpoint_rad, .. } => setpoint_rad.get(given.saturating_sub(1)).copied().unwrap_or(0.0),
        };
        // Readings of a hold count from the start of the log; the first that matters is in force when the part begins.
        let next = match (input, hold_s) {
            (Input::Position { .. } | Input::Messages { .. }, Some(hold)) => {
                ((start_s.re() + SAME_INSTANT_S) / hold.re()).max(0.0) as usize
            }
            _ => given,
        };
        let in_force = match (input, given.checked_sub(1)) {
            (Input::Messages { setpoint_rad, hold, .. }, Some(k)) => {
                let at = T::constant(at_s[k]);
                (T::constant(first), slope(at_s, setpoint_rad, hold, k), path.delay_s.map_or(at, |delay| at + delay))
            }
            _ => (T::constant(first), 0.0, start_s),
        };
        let profile = path
            .profile
            .filter(|_| matches!(input, Input::Position { .. } | Input::Messages { .. }))
            .map(|limits| Profile::at_rest(limits, T::constant(first), start_s));
        Self { input, t_s, at_s, path: SetpointPath { hold_s, ..path }, in_force, next, profile }
    }

    fn is_perfect(&self) -> bool {
        let is_apart = matches!(self.input, Input::Messages { .. });
        self.path.delay_s.is_none() && self.path.hold_s.is_none() && self.profile.is_none() && !is_apart
    }

    /// The next instant between samples at which the input changes, where the path makes any.
    pub(crate) fn next_change(&self) -> Option<T> {
        if self.is_perfect() || matches!(self.input, Input::Off) {
            return None;
        }
        let turn = self.profile.as_ref().and_then(Profile::ends_s);
        match (self.next_reading(), turn) {
            (Some(reading), Some(turn)) => Some(if turn.re() <= reading.re() { turn } else { reading }),
            (reading, turn) => reading.or(turn),
        }
    }

    /// When the next setpoint or torque is taken over.
    fn next_reading(&self) -> Option<T> {
        let instant = match (self.input, self.path.hold_s) {
            (Input::Position { .. } | Input::Messages { .. }, Some(hold)) => hold * self.next as f64,
            _ => T::constant(*self.at_s.get(self.next)?),
        };
        Some(self.path.delay_s.map_or(instant, |delay| instant + delay))
    }

    /// Takes the next change over.
    pub(crate) fn change(&mut self) {
        let turn = self.profile.as_ref().and_then(Profile::ends_s);
        let reading = self.next_reading();
        if let (Some(profile), Some(turn)) = (&mut self.profile, turn)
            && reading.is_none_or(|reading| turn.re() <= reading.re())
        {
            profile.turn();
            return;
        }
        let Some(at) = reading else { return };
        self.in_force = match (self.input, self.path.hold_s) {
            (
                Input::Position { setpoint_rad, hold: reading, .. }
                | Input::Messages { setpoint_rad, hold: reading, .. },
                Some(hold),
            ) => {
                let read_s = hold * self.next as f64;
                let k = self.at_s.partition_point(|t| *t <= read_s.re() + SAME_INSTANT_S).max(1) - 1;
                let value = T::constant(setpoint_rad[k]);
                let slope = self.slope(setpoint_rad, reading, k);
                (value + (read_s - self.at_s[k]) * slope, 0.0, at)
            }
            (
                Input::Position { setpoint_rad, hold: reading, .. }
                | Input::Messages { setpoint_rad, hold: reading, .. },
                None,
            ) => {
                let slope = self.slope(setpoint_rad, reading, self.next);
                (T::constant(setpoint_rad[self.next]), slope, at)
            }
            (Input::Torque { torque_nm, .. }, _) => (T::constant(torque_nm[self.next]), 0.0, at),
            (Input::Off, _) => self.in_force,
        };
        if let Some(profile) = &mut self.profile {
            profile.aim(self.in_force.0, at);
        }
        self.next += 1;
    }

    /// Slope of the setpoint from sample `k` on \[rad/s\].
    fn slope(&self, setpoint_rad: &[f64], reading: Hold, k: usize) -> f64 {
        slope(self.at_s, setpoint_rad, reading, k)
    }

    /// What acts from sample `k - 1` to sample `k`, as far as it is known now.
    pub(crate) fn command(&self, k: usize) -> Command<T> {
        let is_on = |on: Option<&[bool]>| on.is_none_or(|on| on[k - 1]);
        match self.input {
            Input::Torque { torque_nm, on } if is_on(on) => Command::Torque(match self.is_perfect() {
                true => T::constant(torque_nm[k - 1]),
                false => self.in_force.0,
            }),
            Input::Position { on, .. } | Input::Messages { on, .. } if is_on(on) && self.profile.is_some() => {
                let Some(profile) = &self.profile else { return Command::Off };
                let [setpoint_rad, rate, acceleration] = profile.now;
                let curve = profile.ends_s().map(|_| [rate, acceleration]);
                Command::Pid { setpoint_rad, slope_rad_s: 0.0, from_s: profile.from_s, curve }
            }
            Input::Position { setpoint_rad, hold, on } if is_on(on) => {
                let (setpoint_rad, slope_rad_s, from_s) = match self.is_perfect() {
                    true => {
                        let slope = self.slope(setpoint_rad, hold, k - 1);
                        (T::constant(setpoint_rad[k - 1]), slope, T::constant(self.t_s[k - 1]))
                    }
                    false => self.in_force,
                };
                Command::Pid { setpoint_rad, slope_rad_s, from_s, curve: None }
            }
            Input::Messages { on, .. } if is_on(on) => {
                let (setpoint_rad, slope_rad_s, from_s) = self.in_force;
                Command::Pid { setpoint_rad, slope_rad_s, from_s, curve: None }
            }
            _ => Command::Off,
        }
    }
}

fn slope(at_s: &[f64], setpoint_rad: &[f64], reading: Hold, k: usize) -> f64 {
    match reading {
        Hold::Linear if k + 1 < at_s.len() => (setpoint_rad[k + 1] - setpoint_rad[k]) / (at_s[k + 1] - at_s[k]),
        _ => 0.0,
    }
}

/// A hold, made a whole number of sampling periods where it hardly differs from one.
fn whole_periods<T: Real>(hold_s: T, t_s: &[f64]) -> T {
    let [Some(first), Some(last)] = [t_s.first(), t_s.last()] else { return hold_s };
    let period_s = (last - first) / (t_s.len() - 1).max(1) as f64;
    let periods = (hold_s.re() / period_s).round();
    let holds = (last / hold_s.re()).max(1.0);
    let near = (hold_s.re() / period_s - periods).abs() * holds < WHOLE;
    if near { T::constant(periods * period_s) } else { hold_s }
}
