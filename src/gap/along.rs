//! The chain from one sample to the next, with its derivatives, for a joint that is known to move or to rest.

use super::diagnosis::ResidualTorque;
use super::smoother::State;
use crate::integrate::rk4;
use crate::joint::{Chain, Setpoint};
use crate::log::Hold;
use crate::pendulum::Input;

/// A chain with what acts on it along a log.
pub(super) struct Along<'a> {
    chain: &'a Chain<f64>,
    input: Input<'a>,
    t_s: &'a [f64],
    /// Period of a law that is not continuous \[s\].
    sample_period_s: Option<f64>,
    /// Fastest oscillation with the motor off, and on \[rad/s\].
    fastest_rad_s: [f64; 2],
}

/// What the controller remembers.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Memory {
    integral_rad_s: f64,
    held_nm: f64,
    ticks: u64,
}

/// What drives the joint between two samples.
#[derive(Clone, Copy)]
enum Law {
    Torque(f64),
    Setpoint { angle_rad: f64, slope_rad_s: f64, from_s: f64 },
}

impl Law {
    /// Setpoint less angle \[rad\]; zero for a torque.
    fn error_rad(self, t_s: f64, angle_rad: f64) -> f64 {
        match self {
            Law::Torque(_) => 0.0,
            Law::Setpoint { angle_rad: setpoint_rad, slope_rad_s, from_s } => {
                setpoint_rad + (t_s - from_s) * slope_rad_s - angle_rad
            }
        }
    }
}

/// A joint that moves from one sample to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage {
    /// Angle and speed at its end.
    pub end: [f64; 2],
    /// Their derivatives by the state at its beginning.
    pub upper: [[f64; 4]; 2],
    /// It turned back on its way.
    pub turned: bool,
}

/// Steps may be this many times longer here than in a rollout: errors do not add up from sample to sample.
const STRETCH: f64 = 2.5;
/// Integration steps between two events, at most.
const MOST_STEPS: f64 = 60.0;
/// Two instants that are no further apart are one \[s\].
const SAME_INSTANT_S: f64 = 1e-9;

impl<'a> Along<'a> {
    pub(super) fn new(chain: &'a Chain<f64>, input: Input<'a>, t_s: &'a [f64]) -> Self {
        let sample_period_s = match input {
            Input::Position { .. } => chain.motor.as_ref().and_then(|m| m.sample_period_s()),
            _ => None,
        };
        let fastest_rad_s = [chain.fastest_rad_s(false), chain.fastest_rad_s(true)];
        Self { chain, input, t_s, sample_period_s, fastest_rad_s }
    }

    /// What acts from sample `k` to the next; at the last sample, what acted up to it.
    fn law(&self, k: usize) -> Law {
        let k = k.min(self.t_s.len().saturating_sub(2));
        let is_on = |on: Option<&[bool]>| on.is_none_or(|on| on[k]);
        match self.input {
            Input::Torque { torque_nm, on } if is_on(on) => Law::Torque(torque_nm[k]),
            Input::Position { setpoint_rad, hold, on } if is_on(on) => {
                let slope_rad_s = match hold {
                    Hold::Step => 0.0,
                    Hold::Linear => (setpoint_rad[k + 1] - setpoint_rad[k]) / (self.t_s[k + 1] - self.t_s[k]),
                };
                Law::Setpoint { angle_rad: setpoint_rad[k], slope_rad_s, from_s: self.t_s[k] }
            }
            _ => Law::Torque(0.0),
        }
    }

    /// Torque by the continuous law \[N m\].
    fn torque_nm(&self, law: Law, t_s: f64, y: &[f64; 2], integral_rad_s: f64) -> f64 {
        match (law, &self.chain.motor) {
            (Law::Torque(torque_nm), _) => torque_nm,
            (Law::Setpoint { angle_rad, slope_rad_s, from_s }, Some(motor)) => {
                let angle_rad = angle_rad + (t_s - from_s) * slope_rad_s;
                motor.torque_nm(Setpoint { angle_rad, rate_rad_s: slope_rad_s }, y[0], y[1], integral_rad_s)
            }
            (Law::Setpoint { .. }, None) => 0.0,
        }
    }

    /// Torque of the motor on a joint that rests at an angle, at sample `k`, its controller's memory empty \[N m\].
    pub(super) fn resting_nm(&self, k: usize, angle_rad: f64) -> f64 {
        self.torque_nm(self.law(k), self.t_s[k], &[angle_rad, 0.0], 0.0)
    }

    /// Torque of the motor along a path of angles and rates at every sample \[N m\].
    fn motor_nm(&self, angle_rad: &[f64], rate_rad_s: &[f64]) -> Vec<f64> {
        let mut memory = Memory::default();
        let mut motor_nm = Vec::with_capacity(angle_rad.len());
        for (k, (&q, &v)) in angle_rad.iter().zip(rate_rad_s).enumerate() {
            let (law, t_s) = (self.law(k), self.t_s[k]);
            let torque_nm = match (law, self.sample_period_s) {
                (Law::Setpoint { .. }, Some(period_s)) => {
                    self.tick(law, t_s, &[q, v], period_s, &mut memory);
                    memory.held_nm
                }
                _ => self.torque_nm(law, t_s, &[q, v], memory.integral_rad_s),
            };
            motor_nm.push(torque_nm);
            if let Some(next_s) = self.t_s.get(k + 1) {
                let middle_s = 0.5 * (t_s + next_s);
                memory.integral_rad_s += law.error_rad(middle_s, q + v * (middle_s - t_s)) * (next_s - t_s);
            }
        }
        motor_nm
    }

    /// The same at the compared samples of a smoothed path \[N m\].
    pub(super) fn motor_compared_nm(&self, path: &ResidualTorque, uncompared: usize) -> Vec<f64> {
        let with_start = |compared: &[f64]| [&compared[..uncompared.min(compared.len())], compared].concat();
        let motor_nm = self.motor_nm(&with_start(&path.angle_rad), &with_start(&path.rate_rad_s));
        motor_nm[uncompared.min(motor_nm.len())..].to_vec()
    }

    /// By how much the move of the setpoint at sample `k` changes the motor's torque at once \[N m\].
    pub(super) fn jolt_nm(&self, k: usize) -> f64 {
        match (self.input, &self.chain.motor) {
            (Input::Position { setpoint_rad, hold: Hold::Step, .. }, Some(motor)) if k > 0 => {
                motor.stiffness_and_damping().0 * (setpoint_rad[k] - setpoint_rad[k - 1])
            }
            (Input::Torque { torque_nm, .. }, _) if k > 0 => torque_nm[k] - torque_nm[k - 1],
            _ => 0.0,
        }
    }

    /// A sampled law is evaluated where its instant has come; answers when that is next \[s\].
    fn tick(&self, law: Law, t_s: f64, y: &[f64; 2], period_s: f64, memory: &mut Memory) -> f64 {
        let at = |ticks: u64| self.t_s[0] + ticks as f64 * period_s;
        if at(memory.ticks) <= t_s + SAME_INSTANT_S {
            memory.held_nm = self.torque_nm(law, t_s, y, memory.integral_rad_s);
            memory.ticks = ((t_s + SAME_INSTANT_S - self.t_s[0]) / period_s).floor() as u64 + 1;
        }
        at(memory.ticks)
    }

    /// A joint that rests from sample `k` to the next: only the controller's memory moves.
    pub(super) fn rest(&self, k: usize, angle_rad: f64, memory: &mut Memory) {
        let law = self.law(k);
        let (from_s, to_s) = (self.t_s[k], self.t_s[k + 1]);
        if let (Some(period_s), Law::Setpoint { .. }) = (self.sample_period_s, law) {
            self.tick(law, from_s, &[angle_rad, 0.0], period_s, memory);
        }
        memory.integral_rad_s += law.error_rad(0.5 * (from_s + to_s), angle_rad) * (to_s - from_s);
    }

    /// A joint that moves from `from_s`, at sample `k` or later, to sample `k + 1`.
    ///
    /// Friction acts against `direction`; where the joint `may_turn`, it acts against the other one from the instant on
    /// at which the speed passes through zero.
    pub(super) fn pass(
        &self,
        k: usize,
        from_s: f64,
        state: &State,
        direction: f64,
        may_turn: bool,
        memory: &mut Memory,
    ) -> Passage {
        let law = self.law(k);
        let sampled_s = self.sample_period_s.filter(|_| matches!(law, Law::Setpoint { .. }));
        let mut moving = Moving {
            along: self,
            law,
            t_s: from_s,
            from_s,
            y: [state[0], state[1]],
            lack: [state[2], state[3]],
            upper: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]],
            direction,
            may_turn,
            integral_rad_s: memory.integral_rad_s,
            error_rad: 0.0,
            held_nm: None,
        };
        let to_s = self.t_s[k + 1];
        while moving.t_s < to_s {
            let mut until_s = to_s;
            if let Some(period_s) = sampled_s {
                memory.integral_rad_s = moving.integral_rad_s;
                until_s = to_s.min(self.tick(law, moving.t_s, &moving.y, period_s, memory));
                moving.held_nm = Some(memory.held_nm);
            }
            moving.advance(until_s);
        }
        memory.integral_rad_s = moving.integral_rad_s;
        Passage { end: moving.y, upper: moving.upper, turned: moving.direction != direction }
    }
}

/// A joint under way between two samples.
struct Moving<'a, 'b> {
    along: &'a Along<'b>,
    law: Law,
    t_s: f64,
    /// Where the passage began \[s\].
    from_s: f64,
    /// Angle and speed.
    y: [f64; 2],
    /// The acceleration that the unknown torque gave where the passage began, and its slope.
    lack: [f64; 2],
    /// Derivatives of angle and speed by the state where the passage began.
    upper: [[f64; 4]; 2],
    direction: f64,
    may_turn: bool,
    /// Integral of the error up to now, and the error now.
    integral_rad_s: f64,
    error_rad: f64,
    /// Torque that a sampled law holds \[N m\].
    held_nm: Option<f64>,
}

impl Moving<'_, '_> {
    fn lack_rad_s2(&self, t_s: f64) -> f64 {
        self.lack[0] + (t_s - self.from_s) * self.lack[1]
    }

    /// Acceleration without the unknown torque, by the continuous law.
    fn known_rad_s2(&self, t_s: f64, y: &[f64; 2]) -> f64 {
        let integral_rad_s = self.integral_rad_s + self.error_rad * (t_s - self.t_s);
        self.slip_rad_s2(t_s, y, self.along.torque_nm(self.law, t_s, y, integral_rad_s))
    }

    fn slip_rad_s2(&self, t_s: f64, y: &[f64; 2], motor_nm: f64) -> f64 {
        self.along.chain.slip_rate_rad_s2(t_s, y[0], y[1], self.direction, motor_nm)
    }

    fn rate(&self, t_s: f64, y: &[f64; 2]) -> [f64; 2] {
        let known = match self.held_nm {
            Some(motor_nm) => self.slip_rad_s2(t_s, y, motor_nm),
            None => self.known_rad_s2(t_s, y),
        };
        [y[1], known + self.lack_rad_s2(t_s)]
    }

    fn advance(&mut self, until_s: f64) {
        let motor_on = matches!(self.law, Law::Setpoint { .. });
        let fastest_rad_s = self.along.fastest_rad_s[usize::from(motor_on)];
        let longest_s = STRETCH * self.along.chain.longest_step_s(fastest_rad_s, self.y[0], self.y[1], motor_on);
        let from_s = self.t_s;
        let steps = ((until_s - from_s) / longest_s).ceil().clamp(1.0, MOST_STEPS);
        let step_s = (until_s - from_s) / steps;
        for i in 1..=steps as usize {
            self.step(step_s);
            self.t_s = from_s + step_s * i as f64;
        }
        self.t_s = until_s;
    }

    /// One step, in two parts where the joint turns back within it.
    fn step(&mut self, step_s: f64) {
        self.error_rad = self.law.error_rad(self.t_s, self.y[0]);
        let first = self.rate(self.t_s, &self.y);
        let end = self.after(&first, step_s);
        if !(self.may_turn && end[1] * self.direction < 0.0 && self.y[1] * self.direction > 0.0) {
            self.arrive(&first, end, step_s);
            return;
        }
        let mut before_s = step_s * self.y[1] / (self.y[1] - end[1]);
        let near = self.after(&first, before_s);
        before_s = (before_s - near[1] / self.rate(self.t_s + before_s, &near)[1]).clamp(0.0, step_s);
        let turn = self.after(&first, before_s);
        self.arrive(&first, [turn[0], 0.0], before_s);
        let slowing = self.rate(self.t_s, &self.y)[1];
        self.direction = -self.direction;
        self.may_turn = false;
        let leaving = self.rate(self.t_s, &self.y);
        // A speed that was too high by d turns later, and is then too high by d times the ratio of the accelerations.
        let ratio = (leaving[1] / slowing).clamp(0.0, 1.0);
        for cell in &mut self.upper[1] {
            *cell *= ratio;
        }
        let end = self.after(&leaving, step_s - before_s);
        self.arrive(&leaving, end, step_s - before_s);
    }

    /// Takes over the state after `dt_s`, with derivatives and the integral of the error.
    fn arrive(&mut self, first: &[f64; 2], end: [f64; 2], dt_s: f64) {
        self.carry(first, dt_s);
        let middle_rad = 0.5 * (self.y[0] + end[0]);
        self.integral_rad_s += self.law.error_rad(self.t_s + 0.5 * dt_s, middle_rad) * dt_s;
        self.t_s += dt_s;
        self.y = end;
        self.error_rad = self.law.error_rad(self.t_s, end[0]);
    }

    /// Angle and speed after `dt_s`.
    fn after(&self, first: &[f64; 2], dt_s: f64) -> [f64; 2] {
        rk4(|t_s: f64, y: &[f64; 2]| self.rate(t_s, y), self.t_s, &self.y, first, dt_s)
    }

    /// Multiplies the derivatives by those over `dt_s`, with the slopes of the acceleration where the step begins.
    fn carry(&mut self, first: &[f64; 2], dt_s: f64) {
        let (t, y, h) = (self.t_s, self.y, dt_s);
        let (dq, dv) = (ANGLE_STEP, SPEED_STEP * self.direction);
        // The derivatives of a sampled law are taken from the continuous one, which it follows.
        let here = if self.held_nm.is_some() { self.known_rad_s2(t, &y) } else { first[1] - self.lack_rad_s2(t) };
        let by_angle = (self.known_rad_s2(t, &[y[0] + dq, y[1]]) - here) / dq;
        let by_speed = (self.known_rad_s2(t, &[y[0], y[1] + dv]) - here) / dv;
        // Powers of A = [0 1; by_angle by_speed] on b = [0 1]'.
        let times = |u: [f64; 2]| [u[1], by_angle * u[0] + by_speed * u[1]];
        let u0 = [0.0, 1.0];
        let u1 = times(u0);
        let u2 = times(u1);
        let u3 = times(u2);
        let u4 = times(u3);
        let series = |c: [f64; 5]| -> [f64; 2] {
            std::array::from_fn(|i| {
                c[0] * u0[i] + h * (c[1] * u1[i] + h * (c[2] * u2[i] + h * (c[3] * u3[i] + h * c[4] * u4[i])))
            })
        };
        let speed = series([1.0, 1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0]);
        let level = series([1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0]).map(|x| x * h);
        let slope = series([1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0]).map(|x| x * h * h);
        let angle = [1.0 + by_angle * level[0], by_angle * level[1]];
        let elapsed_s = t - self.from_s;
        let old = self.upper;
        for (i, row) in self.upper.iter_mut().enumerate() {
            for (j, cell) in row.iter_mut().enumerate() {
                *cell = angle[i] * old[0][j] + speed[i] * old[1][j];
            }
            row[2] += level[i];
            row[3] += level[i] * elapsed_s + slope[i];
        }
    }
}

/// Differences over which the slopes of the acceleration are taken \[rad, rad/s\].
const ANGLE_STEP: f64 = 1e-6;
const SPEED_STEP: f64 = 1e-5;

#[cfg(test)]
#[path = "along_tests.rs"]
mod tests;
