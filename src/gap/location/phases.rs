//! What the joint is doing at every compared sample: held, stuck, reversing, moving, saturated, at a stop.

use super::along::Along;
use crate::gap::diagnosis::{Phase, ResidualTorque};
use crate::identify::Experiment;
use crate::joint::Chain;
use crate::pendulum::Input;

/// A log's course, sample by sample of those that are compared.
pub(in crate::gap) struct Course<'a, 'b> {
    pub chain: &'a Chain<f64>,
    pub along: &'a Along<'b>,
    pub e: &'a Experiment,
    /// Everything but its phases.
    pub torque: &'a ResidualTorque,
    /// +1 or -1; 0 before the release.
    pub direction: Vec<f64>,
    /// At rest under friction or under the motor.
    pub rests: Vec<bool>,
    /// Not yet released.
    pub held: Vec<bool>,
    pub noise_rad: f64,
}

/// A reversal lasts this long before and after its turning point \[s\].
const REVERSAL_S: f64 = 0.1;
/// A setpoint that stays for this long either way holds the joint \[s\].
const SETTLED_S: f64 = 0.05;
/// Motor torques above this share of the log's largest count as saturated.
const NEAR_LARGEST: f64 = 0.95;
/// Commands beyond what is ever delivered by this factor are clipped, where what is delivered reaches this share of its
/// own largest.
const BEYOND: f64 = 1.15;
const CLIPPED: f64 = 0.85;
/// A turning point at a stop lies within this share of the range from its end.
const NEAR_END: f64 = 0.05;
/// The push of a stop is looked for this long before and after the turning point \[s\].
const PUSH_S: f64 = 0.06;
/// Samples with more than this share of the largest push are at the stop.
const PUSHED: f64 = 0.3;

/// The phase of every sample. Where several apply the first of: hold, stick, stop, saturation, reversal, run.
pub(in crate::gap) fn phases(c: &Course<'_, '_>) -> Vec<Phase> {
    let mut phase = vec![Phase::Run; c.rests.len()];
    let turns: Vec<usize> = (1..phase.len())
        .filter(|&k| c.direction[k] * c.direction[k - 1] < 0.0 && !c.rests[k] && !c.rests[k - 1])
        .collect();
    for &turn in &turns {
        phase[c.near(turn, REVERSAL_S)].fill(Phase::Reversal);
    }
    let motor_nm = c.along.motor_compared_nm(c.torque, c.e.uncompared);
    for k in c.saturated(&motor_nm) {
        phase[k] = Phase::Saturation;
    }
    for k in turns.iter().flat_map(|turn| c.stopped(*turn, &motor_nm)) {
        phase[k] = Phase::Stop;
    }
    for (k, phase) in phase.iter_mut().enumerate() {
        if c.held[k] || (c.rests[k] && c.is_held_by_motor(k)) {
            *phase = Phase::Hold;
        } else if c.rests[k] {
            *phase = Phase::Stick;
        }
    }
    phase
}

impl Course<'_, '_> {
    /// Samples within `reach_s` of sample `k`.
    fn near(&self, k: usize, reach_s: f64) -> std::ops::Range<usize> {
        let t_s = &self.torque.t_s;
        let from = t_s.partition_point(|t| *t < t_s[k] - reach_s);
        from..t_s.partition_point(|t| *t <= t_s[k] + reach_s)
    }

    /// A motor that is on, with a setpoint that does not move.
    fn is_held_by_motor(&self, k: usize) -> bool {
        let Input::Position { setpoint_rad, on, .. } = self.e.input_at_samples() else { return false };
        let offset = self.e.uncompared;
        on.is_none_or(|on| on[k + offset])
            && self.near(k, SETTLED_S).all(|i| setpoint_rad[i + offset] == setpoint_rad[k + offset])
    }

    /// Samples of a driven log at which the motor does, or should do, about the most that it ever does.
    fn saturated(&self, motor_nm: &[f64]) -> Vec<usize> {
        let commanded = motor_nm.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        if !self.e.is_driven() || commanded == 0.0 {
            return Vec::new();
        }
        let torque = &self.torque.torque_nm;
        let delivered = |k: usize| if torque[k].is_finite() { motor_nm[k] + torque[k] } else { motor_nm[k] };
        // The most that is delivered but for a few samples, which the smoother may have overshot.
        let mut sizes: Vec<f64> = (0..motor_nm.len()).map(|k| delivered(k).abs()).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let ceiling = sizes[(sizes.len() - 1) * 98 / 100];
        let is_saturated = |k: &usize| {
            let clipped = motor_nm[*k].abs() > BEYOND * ceiling
                && delivered(*k).abs() > CLIPPED * ceiling
                && delivered(*k) * motor_nm[*k] > 0.0;
            motor_nm[*k].abs() >= NEAR_LARGEST * commanded || clipped
        };
        (0..motor_nm.len()).filter(is_saturated).collect()
    }

    /// Samples about a turning point at which something pushes the joint back harder than everything else together.
    fn stopped(&self, turn: usize, motor_nm: &[f64]) -> Vec<usize> {
        let angle = &self.torque.angle_rad;
        let [low, high] = crate::number::extent(angle.iter().copied());
        let margin = (NEAR_END * (high - low)).max(3.0 * self.noise_rad);
        // Before the turn the joint moved towards the stop.
        let towards = self.direction[turn - 1];
        let end = if towards > 0.0 { high } else { low };
        if (angle[turn] - end).abs() > margin {
            return Vec::new();
        }
        let near = self.near(turn, PUSH_S);
        let push = |k: usize| -towards * self.torque.torque_nm[k];
        let largest = near.clone().map(push).fold(0.0, f64::max);
        let motor = near.clone().map(|k| motor_nm[k].abs()).fold(0.0, f64::max);
        let breakaway = self.chain.breakaway_nm(self.torque.t_s[turn], angle[turn], towards, 0.0);
        if largest <= self.chain.link.peak_gravity_nm() + motor + breakaway {
            return Vec::new();
        }
        near.filter(|k| push(*k) > PUSHED * largest).collect()
    }
}
