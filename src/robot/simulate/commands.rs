//! What acts on each joint's motor at each instant.

use super::Scenario;
use crate::pendulum::{Command, Input, SAME_INSTANT_S, Schedule};

/// Commands of all joints, stepped through the table of setpoints.
pub(super) struct Commands<'a> {
    t_s: &'a [f64],
    schedules: Vec<Option<Schedule<'a, f64>>>,
    /// The sample that comes next.
    next: usize,
    /// In force now.
    pub now: Vec<Command<f64>>,
    /// Where the law is evaluated only every so often: its period \[s\], and the answer that it holds.
    held: Vec<Option<(f64, f64)>>,
    ticks: u64,
}

impl<'a> Commands<'a> {
    pub(super) fn new(scenario: &'a Scenario<'a>) -> Self {
        let setpoints = scenario.setpoints;
        let schedule = |(k, drive): (usize, &super::JointDrive)| {
            let column = setpoints.columns[k].as_ref()?;
            drive.chain.motor.as_ref()?;
            let input =
                Input::Position { setpoint_rad: &column.angle_rad, hold: setpoints.hold, on: column.on.as_deref() };
            Some(Schedule::new(input, &setpoints.t_s, drive.chain.setpoint))
        };
        let drives = scenario.joints.drives();
        let schedules: Vec<_> = drives.iter().enumerate().map(schedule).collect();
        let period = |drive: &super::JointDrive| Some((drive.chain.motor.as_ref()?.sample_period_s()?, 0.0));
        let mut commands = Self {
            t_s: &setpoints.t_s,
            now: vec![Command::Off; schedules.len()],
            schedules,
            next: 1,
            held: drives.iter().map(period).collect(),
            ticks: 0,
        };
        commands.update(setpoints.t_s[0]);
        commands
    }

    /// The next instant at which something changes \[s\].
    pub(super) fn next_s(&self) -> f64 {
        let sample = self.t_s.get(self.next).copied().unwrap_or(f64::INFINITY);
        let changes = self.schedules.iter().flatten().filter_map(Schedule::next_change);
        let tick = self.period_s().map(|period_s| self.t_s[0] + self.ticks as f64 * period_s);
        changes.chain(tick).fold(sample, f64::min)
    }

    fn period_s(&self) -> Option<f64> {
        self.held.iter().flatten().map(|(period_s, _)| *period_s).next()
    }

    /// Takes over what has changed until now.
    pub(super) fn update(&mut self, now_s: f64) {
        let reached = now_s + SAME_INSTANT_S;
        while self.t_s.get(self.next).is_some_and(|t| *t <= reached) && self.next + 1 < self.t_s.len() {
            self.next += 1;
        }
        for (command, schedule) in self.now.iter_mut().zip(&mut self.schedules) {
            let Some(schedule) = schedule else { continue };
            while schedule.next_change().is_some_and(|at| at <= reached) {
                schedule.change();
            }
            *command = schedule.command(self.next);
        }
    }

    /// Where the law is evaluated in frames and one begins now: evaluates it with `law`, and holds its answer.
    pub(super) fn tick(&mut self, now_s: f64, mut law: impl FnMut(usize, Command<f64>, f64) -> f64) {
        let Some(period_s) = self.period_s() else { return };
        let is_due = self.t_s[0] + self.ticks as f64 * period_s <= now_s + SAME_INSTANT_S;
        self.ticks += u64::from(is_due);
        for (k, held) in self.held.iter_mut().enumerate() {
            let Some((period_s, answer)) = held else { continue };
            if let Command::Pid { .. } = self.now[k] {
                if is_due {
                    *answer = law(k, self.now[k], *period_s);
                }
                self.now[k] = self.now[k].held(*answer, now_s);
            }
        }
    }
}
