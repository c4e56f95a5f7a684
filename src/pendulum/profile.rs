//! The profile that a servo runs from where it is to its goal: speed up, run, slow down to rest.

use crate::joint::{ProfileLimits, Real};

/// A generator of setpoints under limits of speed and acceleration.
#[derive(Clone, Copy)]
pub(super) struct Profile<T> {
    limits: ProfileLimits<T>,
    goal_rad: T,
    /// Angle, rate and acceleration of the setpoint at an instant \[rad, rad/s, rad/s^2\], and that instant \[s\].
    pub now: [T; 3],
    pub from_s: T,
    /// Phases that are left: when each ends \[s\], and the acceleration of the next.
    phases: [(T, T); 3],
    left: usize,
}

/// A profile this near to its goal, at this speed, rests there.
const THERE: f64 = 1e-12;

impl<T: Real> Profile<T> {
    /// At rest at an angle.
    pub fn at_rest(limits: ProfileLimits<T>, angle_rad: T, from_s: T) -> Self {
        let nought = T::nought();
        let now = [angle_rad, nought, nought];
        Self { limits, goal_rad: angle_rad, now, from_s, phases: [(nought, nought); 3], left: 0 }
    }

    /// When the present phase ends \[s\]; `None` at rest.
    pub fn ends_s(&self) -> Option<T> {
        (self.left > 0).then(|| self.phases[3 - self.left].0)
    }

    fn go_to(&mut self, at_s: T) {
        let [angle, rate, acceleration] = self.now;
        let dt = at_s - self.from_s;
        self.now = [angle + dt * (rate + dt * acceleration * 0.5), rate + dt * acceleration, acceleration];
        self.from_s = at_s;
    }

    /// Takes up the next phase.
    pub fn turn(&mut self) {
        let Some(at_s) = self.ends_s() else { return };
        self.go_to(at_s);
        self.now[2] = self.phases[3 - self.left].1;
        self.left -= 1;
        if self.left == 0 {
            self.now = [self.goal_rad, T::nought(), T::nought()];
        }
    }

    /// Takes up a new goal at an instant.
    pub fn aim(&mut self, goal_rad: T, at_s: T) {
        self.go_to(at_s);
        self.goal_rad = goal_rad;
        self.left = 0;
        let ProfileLimits { speed_rad_s: most, acceleration_rad_s2: limit } = self.limits;
        let [angle, rate, _] = self.now;
        let ahead = goal_rad - angle;
        if ahead.re().abs() < THERE && rate.re().abs() < THERE {
            self.now = [goal_rad, T::nought(), T::nought()];
            return;
        }
        // Towards the goal from where it could stop at the soonest.
        let stop = rate.re() * rate.re().abs() / (2.0 * limit.re());
        let direction = if ahead.re() < stop { -1.0 } else { 1.0 };
        let (ahead, rate) = (ahead * direction, rate * direction);
        let square = limit * ahead + rate * rate * 0.5;
        let peak = if square.re() > THERE * THERE { square.sqrt() } else { T::nought() };
        let (peak, run_s) = if peak.re() > most.re() {
            let on_ramps = (most * most * 2.0 - rate * rate) / (limit * 2.0);
            (most, (ahead - on_ramps) / most)
        } else {
            (peak, T::nought())
        };
        let not_negative = |x: T| if x.re() > 0.0 { x } else { T::nought() };
        let fast_s = at_s + not_negative((peak - rate) / limit);
        let slow_s = fast_s + not_negative(run_s);
        let push = limit * direction;
        self.now[2] = push;
        self.phases = [(fast_s, T::nought()), (slow_s, -push), (slow_s + peak / limit, T::nought())];
        self.left = 3;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(goals: &[(f64, f64)], until_s: f64) -> Vec<[f64; 3]> {
        let mut profile = Profile::at_rest(ProfileLimits { speed_rad_s: 1.5, acceleration_rad_s2: 6.0 }, 0.1, 0.0);
        let mut goals = goals.iter().copied().peekable();
        (0..=(until_s * 1e3) as usize)
            .map(|k| {
                let t = k as f64 * 1e-3;
                loop {
                    let next = goals.peek().map_or(f64::INFINITY, |g| g.0);
                    match profile.ends_s() {
                        Some(end) if end <= next && end <= t => profile.turn(),
                        _ if next <= t => {
                            let (at, goal) = goals.next().unwrap();
                            profile.aim(goal, at);
                        }
                        _ => break,
                    }
                }
                let dt = t - profile.from_s;
                let [q, v, a] = profile.now;
                [q + dt * v + 0.5 * dt * dt * a, v + dt * a, a]
            })
            .collect()
    }

    #[test]
    fn it_reaches_every_goal_within_its_limits_and_rests_there() {
        // A long way, a goal that turns back on the run, one that is overshot, one in reach without running.
        let goals = [(0.0, 1.4), (0.7, -0.3), (0.8, 1.2), (2.6, 1.15)];
        let path = run(&goals, 4.0);
        for pair in path.windows(2) {
            let [before, after] = [pair[0], pair[1]];
            assert!(after[1].abs() <= 1.5 + 1e-9 && after[2].abs() <= 6.0 + 1e-9, "{after:?}");
            assert!((after[1] - before[1]).abs() <= 6.0e-3 + 1e-9, "{before:?} {after:?}");
            assert!((after[0] - before[0]).abs() <= 1.5e-3 + 1e-9, "{before:?} {after:?}");
        }
        assert!((path[2590][0] - 1.2).abs() < 1e-12 && path[2590][1] == 0.0);
        assert!((path[4000][0] - 1.15).abs() < 1e-12 && path[4000][1] == 0.0);
        // From rest to rest over 1.3 rad: 0.25 s up, 0.25 s down, the rest at full speed.
        let alone = run(&[(0.0, 1.4)], 2.0);
        let whole_s = 1.3 / 1.5 + 1.5 / 6.0;
        let arrived = alone.iter().position(|s| s[1] == 0.0 && s[0] > 1.0).unwrap();
        assert!((arrived as f64 * 1e-3 - whole_s).abs() < 2e-3, "{arrived}");
    }
}
