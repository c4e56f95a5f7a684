//! What a late encoder still shows: where the joint was a little while ago.

use crate::joint::Real;
use std::collections::VecDeque;

/// Angle and rate on the encoder's side at the ends of the latest steps.
///
/// Between them and up to the present stage of a step the motion is a cubic, which has the accuracy of a Runge-Kutta step;
/// so the delay may be any part or multiple of a step. Before its beginning the joint moved at the rate at which it begins.
pub(super) struct History<T> {
    delay_s: T,
    /// Time, angle, rate.
    knots: VecDeque<[T; 3]>,
}

impl<T: Real> History<T> {
    /// From a first state on, which the encoder reads at that instant: answers it, and where the joint is then.
    pub fn begin(delay_s: T, t_s: T, [angle_rad, rate_rad_s]: [T; 2]) -> (Self, T) {
        let angle_rad = angle_rad + delay_s * rate_rad_s;
        (Self { delay_s, knots: VecDeque::from([[t_s, angle_rad, rate_rad_s]]) }, angle_rad)
    }

    /// The end of a step.
    pub fn push(&mut self, t_s: T, [angle_rad, rate_rad_s]: [T; 2]) {
        if self.knots.len() > 1 && self.knots.back().is_some_and(|last| last[0].re() >= t_s.re()) {
            self.knots.pop_back();
        }
        self.knots.push_back([t_s, angle_rad, rate_rad_s]);
        let oldest_s = t_s.re() - self.delay_s.re();
        while self.knots.len() > 2 && self.knots[1][0].re() < oldest_s {
            self.knots.pop_front();
        }
    }

    /// What the encoder shows at an instant at which the joint is in a state.
    pub fn at(&self, t_s: T, state: [T; 2]) -> [T; 2] {
        let when_s = t_s - self.delay_s;
        let present = [t_s, state[0], state[1]];
        // Older knots are dropped: the instant lies near the first.
        let mut next = self.knots.iter().take_while(|knot| knot[0].re() <= when_s.re()).count();
        while next > 0 {
            let earlier = &self.knots[next - 1];
            let later = self.knots.get(next).unwrap_or(&present);
            if later[0].re() > earlier[0].re() {
                return cubic(earlier, later, when_s);
            }
            next -= 1;
        }
        let first = self.knots.front().unwrap_or(&present);
        [first[1] + first[2] * (when_s - first[0]), first[2]]
    }
}

/// Angle and rate on the cubic through two knots.
fn cubic<T: Real>(from: &[T; 3], to: &[T; 3], t_s: T) -> [T; 2] {
    let h = to[0] - from[0];
    let u = (t_s - from[0]) / h;
    let rise = (to[1] - from[1]) / h;
    // q = q0 + h u (v0 + u (b + u c)), with the slopes of both ends.
    let b = rise * 3.0 - from[2] * 2.0 - to[2];
    let c = from[2] + to[2] - rise * 2.0;
    [from[1] + h * u * (from[2] + u * (b + u * c)), from[2] + u * (b * 2.0 + u * c * 3.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_shows_a_smooth_motion_as_it_was_whatever_the_step() {
        for (delay_s, step_s) in [(0.004, 0.01), (0.013, 0.01), (0.05, 0.01), (0.05, 0.07)] {
            let state = |t: f64| [(3.0 * t).sin(), 3.0 * (3.0 * t).cos()];
            let (mut history, _) = History::begin(delay_s, 0.0, state(0.0));
            for k in 1..60 {
                let t = k as f64 * step_s;
                history.push(t, state(t));
                let stage = t + 0.5 * step_s;
                if stage - delay_s > step_s {
                    let [q, v] = history.at(stage, state(stage));
                    let [q_true, v_true] = state(stage - delay_s);
                    assert!((q - q_true).abs() < 0.3 * step_s.powi(4) && (v - v_true).abs() < 3.0 * step_s.powi(3));
                }
            }
        }
    }
}
