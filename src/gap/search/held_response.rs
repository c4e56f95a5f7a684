//! What a hold takes from the setpoint, through the linear response of joint and controller; and which holds to try so.

use crate::log::Hold;

/// Times that are tried go up to so many sampling periods.
const TO: f64 = 40.0;
/// Step from one time to the next, as a share of what moves the last hold of all by one; and most times.
const STEP: f64 = 0.125;
const MOST: usize = 20_000;
/// The best of them about which more are tried, and where, as a share of the same: the dips are narrow.
pub(in crate::gap) const WORTH: usize = 200;
const FINER: [f64; 4] = [-0.06, -0.03, 0.03, 0.06];
/// Times that are simulated.
const BEST: usize = 16;
/// Two of them differ by this share at least.
const APART: f64 = 0.004;

/// Holds to try of a log that ends at a time and is sampled with a period \[s\], from so many periods on.
///
/// Steps of equal width in the number of holds. They are counted from the beginning of a log, of which this may be a late
/// part.
pub(in crate::gap) fn tried_holds_s(end_s: f64, period_s: f64, from: f64) -> impl Iterator<Item = f64> {
    let [most, fewest] = [from, TO].map(|periods| end_s / (periods * period_s));
    let steps = (((most - fewest) / STEP).ceil() as usize).clamp(1, MOST);
    let between = (0..=steps).map(move |n| end_s / (most + (fewest - most) * n as f64 / steps as f64));
    let whole = (2..=TO as u32).map(move |n| f64::from(n) * period_s);
    whole.chain(between)
}

/// Holds to try about others.
pub(in crate::gap) fn finer_holds_s(end_s: f64, about_s: impl Iterator<Item = f64>) -> impl Iterator<Item = f64> {
    about_s.flat_map(move |hold_s| FINER.map(|step| end_s / (end_s / hold_s + step)))
}

/// The first few that differ, of times with the best first.
pub(in crate::gap) fn best_apart(holds_s: impl Iterator<Item = f64>) -> impl Iterator<Item = f64> {
    let mut best: Vec<f64> = Vec::new();
    for hold_s in holds_s {
        if best.len() < BEST && best.iter().all(|known| (hold_s / known - 1.0).abs() > APART) {
            best.push(hold_s);
        }
    }
    best.into_iter()
}

/// A driven joint as its controller holds it, to first order, with the setpoints of a log.
pub(in crate::gap) struct HeldJoint<'a> {
    /// Times of the setpoints \[s\], from the beginning of the log.
    pub t_s: &'a [f64],
    /// \[rad\]
    pub setpoint_rad: &'a [f64],
    /// Between two of them.
    pub hold: Hold,
    /// Torque per setpoint \[N m/rad\] ...
    pub kp_nm_rad: f64,
    /// ... and per slope of it, which a held setpoint does not have \[N m s/rad\].
    pub of_rate_nm_s_rad: f64,
    pub inertia_kg_m2: f64,
    /// Of controller and gravity.
    pub stiffness_nm_rad: f64,
    /// Of controller and friction.
    pub damping_nm_s_rad: f64,
}

impl HeldJoint<'_> {
    /// Setpoint at a time in the sampling interval that begins with sample `k` \[rad\].
    fn setpoint_rad(&self, k: usize, t_s: f64) -> f64 {
        let here = self.setpoint_rad[k];
        match (self.hold, self.setpoint_rad.get(k + 1)) {
            (Hold::Linear, Some(next)) => here + (next - here) * (t_s - self.t_s[k]) / (self.t_s[k + 1] - self.t_s[k]),
            _ => here,
        }
    }
}

/// Holds that are answered together, for the processor to have something to do while each waits for itself.
pub(in crate::gap) const LANES: usize = 8;

/// What no hold changes of a sampling interval.
struct Interval {
    from_s: f64,
    to_s: f64,
    /// Torque that the setpoint asks for where nothing is held \[N m\].
    asked_nm: f64,
    /// What a torque adds to the rate, implicit in stiffness and damping \[rad/s per N m\].
    rate_per_nm: f64,
}

/// Linear response of a driven joint to what a hold takes from its setpoint.
pub(in crate::gap) struct HeldResponse<'a> {
    joint: HeldJoint<'a>,
    intervals: Vec<Interval>,
}

impl<'a> HeldResponse<'a> {
    pub fn of(joint: HeldJoint<'a>) -> Self {
        let interval = |(k, ends): (usize, &[f64])| {
            let (from_s, to_s) = (ends[0], ends[1]);
            let step_s = to_s - from_s;
            let change_rad = joint.setpoint_rad(k, to_s) - joint.setpoint_rad(k, from_s);
            let asked_nm = joint.kp_nm_rad * joint.setpoint_rad(k, 0.5 * (from_s + to_s))
                + joint.of_rate_nm_s_rad * change_rad / step_s;
            let inertia = joint.inertia_kg_m2
                + step_s * joint.damping_nm_s_rad
                + step_s * step_s * joint.stiffness_nm_rad.max(0.0);
            Interval { from_s, to_s, asked_nm, rate_per_nm: step_s / inertia }
        };
        let intervals = joint.t_s.windows(2).enumerate().map(interval).collect();
        Self { joint, intervals }
    }

    pub fn setpoint_rad(&self) -> &[f64] {
        self.joint.setpoint_rad
    }

    pub fn end_s(&self) -> f64 {
        self.joint.t_s[self.joint.t_s.len() - 1]
    }

    /// What each of [`LANES`] holds at the most changes of the joint's angle, sample by sample \[rad\]; the last of them fills
    /// the lanes that are free.
    pub fn to_holds(&self, holds_s: &[f64]) -> Vec<[f64; LANES]> {
        let joint = &self.joint;
        let Some(last_s) = holds_s.last() else { return Vec::new() };
        let mut readings: [Readings; LANES] =
            std::array::from_fn(|lane| Readings::of(joint, *holds_s.get(lane).unwrap_or(last_s)));
        let (mut angle_rad, mut rate_rad_s) = ([0.0; LANES], [0.0; LANES]);
        let mut moved_rad = Vec::with_capacity(joint.t_s.len());
        moved_rad.push(angle_rad);
        for (k, interval) in self.intervals.iter().enumerate() {
            let step_s = interval.to_s - interval.from_s;
            let mut held_rad = [0.0; LANES];
            for (held_rad, readings) in held_rad.iter_mut().zip(&mut readings) {
                *held_rad = readings.mean_rad(joint, k, interval);
            }
            for lane in 0..LANES {
                let torque_nm = joint.kp_nm_rad * held_rad[lane] - interval.asked_nm;
                let resists_nm = joint.damping_nm_s_rad * rate_rad_s[lane] + joint.stiffness_nm_rad * angle_rad[lane];
                rate_rad_s[lane] += interval.rate_per_nm * (torque_nm - resists_nm);
                angle_rad[lane] += step_s * rate_rad_s[lane];
            }
            moved_rad.push(angle_rad);
        }
        moved_rad
    }
}

/// Setpoints as a hold lets them through, from one sampling interval to the next.
struct Readings {
    hold_s: f64,
    /// Holds that are over, and when the next one is.
    over: f64,
    next_s: f64,
    held_rad: f64,
    /// The sample from which on the last one was read.
    sample: usize,
}

impl Readings {
    fn of(joint: &HeldJoint<'_>, hold_s: f64) -> Self {
        let over = (joint.t_s[0] / hold_s).floor();
        Self { hold_s, over, next_s: (over + 1.0) * hold_s, held_rad: joint.setpoint_rad[0], sample: 0 }
    }

    /// Mean of what is held in the sampling interval `k` \[rad\].
    fn mean_rad(&mut self, joint: &HeldJoint<'_>, k: usize, &Interval { from_s, to_s, .. }: &Interval) -> f64 {
        // A hair before a sample it takes that sample.
        const HAIR_S: f64 = 1e-9;
        let (mut sum_rad_s, mut since_s) = (0.0, from_s);
        while self.next_s < to_s - HAIR_S {
            let read_s = self.next_s.max(from_s);
            sum_rad_s += self.held_rad * (read_s - since_s);
            while self.sample < k && joint.t_s[self.sample + 1] <= read_s + HAIR_S {
                self.sample += 1;
            }
            self.held_rad = joint.setpoint_rad(self.sample, read_s);
            since_s = read_s;
            self.over += 1.0;
            self.next_s = (self.over + 1.0) * self.hold_s;
        }
        if since_s == from_s {
            return self.held_rad;
        }
        (sum_rad_s + self.held_rad * (to_s - since_s)) / (to_s - from_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joint<'a>(t_s: &'a [f64], setpoint_rad: &'a [f64], hold: Hold) -> HeldJoint<'a> {
        HeldJoint {
            t_s,
            setpoint_rad,
            hold,
            kp_nm_rad: 5.0,
            of_rate_nm_s_rad: 0.0,
            inertia_kg_m2: 0.02,
            stiffness_nm_rad: 6.0,
            damping_nm_s_rad: 0.3,
        }
    }

    #[test]
    fn every_lane_is_the_response_to_its_own_hold() {
        let t_s: Vec<f64> = (0..400).map(|k| 0.7 + 0.01 * f64::from(k)).collect();
        let setpoint_rad: Vec<f64> = t_s.iter().map(|t| (9.0 * t).sin()).collect();
        let response = HeldResponse::of(joint(&t_s, &setpoint_rad, Hold::Linear));
        let holds_s = [0.013, 0.02, 0.037, 0.1, 0.25];
        let all = response.to_holds(&holds_s);
        for (lane, hold_s) in holds_s.into_iter().enumerate() {
            let own = response.to_holds(&[hold_s]);
            assert!(own.iter().zip(&all).all(|(own, all)| own[0] == all[lane]), "{hold_s}");
        }
        let last = |lane: usize| all.iter().map(|moved| moved[lane] * moved[lane]).sum::<f64>();
        assert!((1..5).all(|lane| last(lane) > last(lane - 1)), "a longer hold changes more");
    }

    #[test]
    fn a_hold_of_what_is_held_already_changes_nothing() {
        // Powers of two: no time is rounded.
        let t_s: Vec<f64> = (0..200).map(|k| f64::from(k) / 128.0).collect();
        let setpoint_rad: Vec<f64> = (0..200).map(|k| f64::from(k / 4 % 7)).collect();
        let response = HeldResponse::of(joint(&t_s, &setpoint_rad, Hold::Step));
        let moved = response.to_holds(&[1.0 / 128.0, 1.0 / 32.0, 1.0 / 16.0]);
        assert!(moved.iter().all(|moved| moved[0] == 0.0 && moved[1] == 0.0));
        assert!(moved.iter().any(|moved| moved[2].abs() > 0.01));
    }
}
