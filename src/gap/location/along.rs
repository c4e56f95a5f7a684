//! The chain from one sample to the next, with its derivatives, for a joint that is known to move or to rest.

use super::smoother::State;
use crate::gap::diagnosis::ResidualTorque;
use crate::integrate::rk4;
use crate::joint::{Chain, Driven};
use crate::pendulum::{Command, Input, SAME_INSTANT_S, Schedule};

/// A chain with what acts on it along a log. Its play or spring is not followed: motor side and link move as one; and its
/// controller sees a late reading to first order in the delay.
pub(in crate::gap) struct Along<'a> {
    chain: &'a Chain<f64>,
    t_s: &'a [f64],
    /// What acts, each from an instant on \[s\].
    commands: Vec<(f64, Command<f64>)>,
    /// The first command of each interval between samples, and one past the last.
    first: Vec<usize>,
    /// Period of a law that is not continuous \[s\].
    sample_period_s: Option<f64>,
    /// Fastest oscillation with the motor off, and on \[rad/s\].
    fastest_rad_s: [f64; 2],
}

/// What the controller remembers.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::gap) struct Memory {
    integral_rad_s: f64,
    /// The answer of a sampled law.
    held: Option<Command<f64>>,
    ticks: u64,
}

/// A joint that moves from one sample to the next.
#[derive(Clone, Copy, Debug)]
pub(in crate::gap) struct Passage {
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

impl<'a> Along<'a> {
    pub(in crate::gap) fn new(chain: &'a Chain<f64>, input: Input<'_>, t_s: &'a [f64]) -> Self {
        let sample_period_s = match input {
            Input::Position { .. } | Input::Messages { .. } => chain.motor.as_ref().and_then(|m| m.sample_period_s()),
            _ => None,
        };
        let mut schedule = Schedule::new(input, t_s, chain.setpoint);
        let mut commands = Vec::with_capacity(t_s.len());
        let mut first = vec![0];
        for (k, pair) in t_s.windows(2).enumerate() {
            while schedule.next_change().is_some_and(|at| at <= pair[0]) {
                schedule.change();
            }
            commands.push((pair[0], schedule.command(k + 1)));
            while let Some(at) = schedule.next_change().filter(|at| *at < pair[1]) {
                schedule.change();
                commands.push((at, schedule.command(k + 1)));
            }
            first.push(commands.len());
        }
        let fastest_rad_s = [chain.fastest_rad_s(Driven::Off), chain.fastest_rad_s(Driven::ByLaw)];
        Self { chain, t_s, commands, first, sample_period_s, fastest_rad_s }
    }

    /// What acts between sample `k` and the next, at first.
    fn command(&self, k: usize) -> Command<f64> {
        let interval = k.min(self.first.len().saturating_sub(2));
        self.commands.get(self.first[interval]).map_or(Command::Off, |c| c.1)
    }

    /// Torque of the motor on a joint that rests at an angle, at sample `k`, its controller's memory empty \[N m\].
    pub(in crate::gap) fn resting_nm(&self, k: usize, angle_rad: f64) -> f64 {
        self.command(k).motor_nm(self.chain, self.t_s[k], &[angle_rad, 0.0, 0.0])
    }

    /// Torque of the motor along a path of angles and rates at every sample \[N m\].
    fn motor_nm(&self, angle_rad: &[f64], rate_rad_s: &[f64]) -> Vec<f64> {
        let mut memory = Memory::default();
        let mut motor_nm = Vec::with_capacity(angle_rad.len());
        for (k, (&q, &v)) in angle_rad.iter().zip(rate_rad_s).enumerate() {
            let (mut command, t_s) = (self.command(k), self.t_s[k]);
            if let Some((_, held)) = self.tick(command, t_s, &[q, v], &mut memory) {
                command = held;
            }
            motor_nm.push(command.motor_nm(self.chain, t_s, &[q, v, memory.integral_rad_s]));
            if let Some(next_s) = self.t_s.get(k + 1) {
                let middle_s = 0.5 * (t_s + next_s);
                let error_rad = self.command(k).error_rad(self.chain, middle_s, q + v * (middle_s - t_s));
                memory.integral_rad_s += error_rad * (next_s - t_s);
            }
        }
        motor_nm
    }

    /// The same at the compared samples of a smoothed path \[N m\].
    pub(in crate::gap) fn motor_compared_nm(&self, path: &ResidualTorque, uncompared: usize) -> Vec<f64> {
        let with_start = |compared: &[f64]| [&compared[..uncompared.min(compared.len())], compared].concat();
        let motor_nm = self.motor_nm(&with_start(&path.angle_rad), &with_start(&path.rate_rad_s));
        motor_nm[uncompared.min(motor_nm.len())..].to_vec()
    }

    /// By how much the motor's torque on a joint at an angle changes at sample `k`, at once \[N m\].
    pub(in crate::gap) fn jolt_nm(&self, k: usize, angle_rad: f64) -> f64 {
        let Some(before) = self.first[k].checked_sub(1).and_then(|i| self.commands.get(i)) else { return 0.0 };
        self.resting_nm(k, angle_rad) - before.1.motor_nm(self.chain, self.t_s[k], &[angle_rad, 0.0, 0.0])
    }

    /// A law that is sampled is evaluated where its instant has come; answers when that is next \[s\], and what it
    /// commands until then. `None` where there is no such law.
    fn tick(&self, command: Command<f64>, t_s: f64, y: &[f64; 2], memory: &mut Memory) -> Option<(f64, Command<f64>)> {
        let period_s = self.sample_period_s?;
        let setpoint = command.setpoint(t_s)?;
        let at = |ticks: u64| self.t_s[0] + ticks as f64 * period_s;
        if at(memory.ticks) <= t_s + SAME_INSTANT_S {
            let late_rad = self.chain.sensor_delay_s.map_or(0.0, |delay_s| delay_s * y[1]);
            let [angle_rad, rate_rad_s] = self.chain.reading(t_s, y[0] - late_rad, y[1]);
            let motor = self.chain.motor.as_ref()?;
            let answer = motor.command(setpoint, angle_rad, rate_rad_s, memory.integral_rad_s);
            memory.held = Some(command.held(answer, t_s));
            memory.ticks = memory.ticks.max(((t_s + SAME_INSTANT_S - self.t_s[0]) / period_s) as u64) + 1;
        }
        memory.held.map(|held| (at(memory.ticks), held))
    }

    /// A joint that rests from sample `k` to the next: only the controller's memory moves.
    pub(in crate::gap) fn rest(&self, k: usize, angle_rad: f64, memory: &mut Memory) {
        let command = self.command(k);
        let (from_s, to_s) = (self.t_s[k], self.t_s[k + 1]);
        self.tick(command, from_s, &[angle_rad, 0.0], memory);
        memory.integral_rad_s += command.error_rad(self.chain, 0.5 * (from_s + to_s), angle_rad) * (to_s - from_s);
    }

    /// A joint that moves from `from_s`, at sample `k` or later, to sample `k + 1`.
    ///
    /// Friction acts against `direction`; where the joint `may_turn`, it acts against the other one from the instant on
    /// at which the speed passes through zero.
    pub(in crate::gap) fn pass(
        &self,
        k: usize,
        from_s: f64,
        state: &State,
        direction: f64,
        may_turn: bool,
        memory: &mut Memory,
    ) -> Passage {
        let mut moving = Moving {
            along: self,
            law: Command::Off,
            command: Command::Off,
            t_s: from_s,
            from_s,
            y: [state[0], state[1]],
            lack: [state[2], state[3]],
            upper: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]],
            direction,
            may_turn,
            integral_rad_s: memory.integral_rad_s,
            error_rad: 0.0,
        };
        let commands = &self.commands[self.first[k]..self.first[k + 1]];
        for (i, &(_, law)) in commands.iter().enumerate() {
            let to_s = commands.get(i + 1).map_or(self.t_s[k + 1], |next| next.0);
            while moving.t_s < to_s {
                memory.integral_rad_s = moving.integral_rad_s;
                let (next_s, command) = self.tick(law, moving.t_s, &moving.y, memory).unwrap_or((to_s, law));
                (moving.law, moving.command) = (law, command);
                // A tick that falls on a sample sees what the sample brings.
                moving.advance(if next_s < to_s - SAME_INSTANT_S { next_s } else { to_s });
            }
        }
        memory.integral_rad_s = moving.integral_rad_s;
        Passage { end: moving.y, upper: moving.upper, turned: moving.direction != direction }
    }
}

/// A joint under way between two samples.
struct Moving<'a, 'b> {
    along: &'a Along<'b>,
    /// The motor's law, and what acts: the same, or the torque that a sampled law holds.
    law: Command<f64>,
    command: Command<f64>,
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
}

impl Moving<'_, '_> {
    fn lack_rad_s2(&self, t_s: f64) -> f64 {
        self.lack[0] + (t_s - self.from_s) * self.lack[1]
    }

    /// Acceleration under a command, without the unknown torque.
    fn known_rad_s2(&self, command: Command<f64>, t_s: f64, y: &[f64; 2]) -> f64 {
        let integral_rad_s = self.integral_rad_s + self.error_rad * (t_s - self.t_s);
        let chain = self.along.chain;
        let motor_nm = command.motor_nm(chain, t_s, &[y[0], y[1], integral_rad_s]);
        chain.slip_rate_rad_s2(t_s, y[0], y[1], self.direction, motor_nm)
    }

    fn rate(&self, t_s: f64, y: &[f64; 2]) -> [f64; 2] {
        [y[1], self.known_rad_s2(self.command, t_s, y) + self.lack_rad_s2(t_s)]
    }

    fn advance(&mut self, until_s: f64) {
        let driven = self.law.driven();
        let fastest_rad_s = self.along.fastest_rad_s[usize::from(driven == Driven::ByLaw)];
        let longest_s =
            STRETCH * self.along.chain.longest_step_s(self.t_s, fastest_rad_s, self.y[0], self.y[1], driven);
        let longest_s = longest_s.min(self.along.chain.longest_step_of_load_s());
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
        self.error_rad = self.law.error_rad(self.along.chain, self.t_s, self.y[0]);
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
        self.integral_rad_s += self.law.error_rad(self.along.chain, self.t_s + 0.5 * dt_s, middle_rad) * dt_s;
        self.t_s += dt_s;
        self.y = end;
        self.error_rad = self.law.error_rad(self.along.chain, self.t_s, end[0]);
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
        let known = |y: &[f64; 2]| self.known_rad_s2(self.law, t, y);
        let sampled = matches!((self.law, self.command), (Command::Pid { .. }, Command::Held { .. }));
        let here = if sampled { known(&y) } else { first[1] - self.lack_rad_s2(t) };
        let by_angle = (known(&[y[0] + dq, y[1]]) - here) / dq;
        let by_speed = (known(&[y[0], y[1] + dv]) - here) / dv;
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
