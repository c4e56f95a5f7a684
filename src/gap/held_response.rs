//! What a hold takes from the setpoint, through the linear response of joint and controller; and which holds to try so.

use crate::log::Hold;

/// Times that are tried go up to so many sampling periods.
const TO: f64 = 40.0;
/// Step from one time to the next, as a share of what moves the last hold of all by one; and most times.
const STEP: f64 = 0.125;
const MOST: usize = 20_000;
/// The best of them about which more are tried, and where, as a share of the same: the dips are narrow.
pub(super) const WORTH: usize = 200;
const FINER: [f64; 4] = [-0.06, -0.03, 0.03, 0.06];
/// Times that are simulated.
const BEST: usize = 16;
/// Two of them differ by this share at least.
const APART: f64 = 0.004;

/// Holds to try of a log that ends at a time and is sampled with a period \[s\], from so many periods on.
///
/// Steps of equal width in the number of holds. They are counted from the beginning of a log, of which this may be a late
/// part.
pub(super) fn tried_holds_s(end_s: f64, period_s: f64, from: f64) -> impl Iterator<Item = f64> {
    let [most, fewest] = [from, TO].map(|periods| end_s / (periods * period_s));
    let steps = (((most - fewest) / STEP).ceil() as usize).clamp(1, MOST);
    let between = (0..=steps).map(move |n| end_s / (most + (fewest - most) * n as f64 / steps as f64));
    let whole = (2..=TO as u32).map(move |n| f64::from(n) * period_s);
    whole.chain(between)
}

/// Holds to try about others.
pub(super) fn finer_holds_s(end_s: f64, about_s: impl Iterator<Item = f64>) -> impl Iterator<Item = f64> {
    about_s.flat_map(move |hold_s| FINER.map(|step| end_s / (end_s / hold_s + step)))
}

/// The first few that differ, of times with the best first.
pub(super) fn best_apart(holds_s: impl Iterator<Item = f64>) -> impl Iterator<Item = f64> {
    let mut best: Vec<f64> = Vec::new();
    for hold_s in holds_s {
        if best.len() < BEST && best.iter().all(|known| (hold_s / known - 1.0).abs() > APART) {
            best.push(hold_s);
        }
    }
    best.into_iter()
}

/// Linear response of a driven joint to what a hold takes from its setpoint.
pub(super) struct HeldResponse<'a> {
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

impl HeldResponse<'_> {
    pub fn end_s(&self) -> f64 {
        self.t_s[self.t_s.len() - 1]
    }

    /// Setpoint at a time in the sampling interval that begins with sample `k` \[rad\].
    fn setpoint_rad(&self, k: usize, t_s: f64) -> f64 {
        let here = self.setpoint_rad[k];
        match (self.hold, self.setpoint_rad.get(k + 1)) {
            (Hold::Linear, Some(next)) => here + (next - here) * (t_s - self.t_s[k]) / (self.t_s[k + 1] - self.t_s[k]),
            _ => here,
        }
    }

    /// What a hold changes of the joint's angle, sample by sample \[rad\].
    pub fn to_hold(&self, hold_s: f64) -> Vec<f64> {
        let t_s = self.t_s;
        let mut moved_rad = Vec::with_capacity(t_s.len());
        let (mut angle_rad, mut rate_rad_s) = (0.0, 0.0);
        let (mut held_rad, mut reading) = (self.setpoint_rad[0], 0);
        let mut taken = (t_s[0] / hold_s).floor();
        for k in 0..t_s.len() {
            moved_rad.push(angle_rad);
            let Some(next_s) = t_s.get(k + 1) else { break };
            let (from_s, to_s) = (t_s[k], *next_s);
            let step_s = to_s - from_s;
            let mut mean_rad = 0.0;
            let mut since_s = from_s;
            // The next reading; a hair before a sample it takes that sample.
            while (taken + 1.0) * hold_s < to_s - 1e-9 {
                taken += 1.0;
                let read_s = (taken * hold_s).max(from_s);
                mean_rad += held_rad * (read_s - since_s);
                while reading < k && t_s[reading + 1] <= read_s + 1e-9 {
                    reading += 1;
                }
                held_rad = self.setpoint_rad(reading, read_s);
                since_s = read_s;
            }
            mean_rad = (mean_rad + held_rad * (to_s - since_s)) / step_s;
            let mut torque_nm = self.kp_nm_rad * (mean_rad - self.setpoint_rad(k, 0.5 * (from_s + to_s)));
            let change_rad = self.setpoint_rad(k, to_s) - self.setpoint_rad(k, from_s);
            torque_nm -= self.of_rate_nm_s_rad * change_rad / step_s;
            // Implicit in stiffness and damping.
            let inertia =
                self.inertia_kg_m2 + step_s * self.damping_nm_s_rad + step_s * step_s * self.stiffness_nm_rad.max(0.0);
            let resists_nm = self.damping_nm_s_rad * rate_rad_s + self.stiffness_nm_rad * angle_rad;
            rate_rad_s += step_s * (torque_nm - resists_nm) / inertia;
            angle_rad += step_s * rate_rad_s;
        }
        moved_rad
    }
}
