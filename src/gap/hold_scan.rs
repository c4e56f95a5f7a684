//! Which holds of the setpoint are worth a real look.
//!
//! Which setpoints get through changes by leaps with the time between them: the residual has a narrow dip at the true
//! one, and no slope leads there. So many times are tried that no dip is passed over, each through the linear response of
//! joint and controller to what the hold takes from the setpoint; only the best are simulated.

use super::evidence::Evidence;
use super::model::GapModel;
use super::projector::Projector;
use crate::identify::{Experiment, JointModel, Signal};
use crate::joint::{Driven, Motor};
use crate::log::{Derivative, Hold, MotorSpec};
use nalgebra::DVector;
use rayon::prelude::*;

/// Times that are tried: from the sampling period times the first to that times the second.
const FROM: f64 = 1.5;
const TO: f64 = 40.0;
/// Step from one time to the next, as a share of what moves the last hold of all by one; and most times.
const STEP: f64 = 0.125;
const MOST: usize = 20_000;
/// The best of them about which more are tried, and where, as a share of the same: the dips are narrow.
const WORTH: usize = 200;
const FINER: [f64; 4] = [-0.06, -0.03, 0.03, 0.06];
/// Times that are simulated.
const BEST: usize = 16;
/// Two of them differ by this share at least.
const APART: f64 = 0.004;

/// Starting values of the hold \[s\], most promising first; none where no setpoint drives the joint.
///
/// `absent` is what a hypothesis of these values leaves of each log.
pub(super) fn hold_scan(
    evidence: &Evidence,
    model: &GapModel,
    values: &[f64],
    absent: &[DVector<f64>],
    projector: &Projector,
) -> Vec<Vec<f64>> {
    let Some(driven) = evidence.reach.driven.filter(|driven| driven.by_setpoint) else { return Vec::new() };
    let responses: Vec<(usize, Response)> =
        evidence.fit.iter().enumerate().filter_map(|(k, e)| Some((k, Response::of(e, model, values)?))).collect();
    let stays = |k: &usize| responses.iter().all(|(moved, _)| moved != k);
    let Some(staying) = projector.seen(absent, (0..absent.len()).filter(stays)) else { return Vec::new() };
    let scanned = |times: Vec<f64>| -> Vec<(f64, f64)> {
        let left = |hold_s: f64| {
            let mut seen = staying.clone();
            for (k, response) in &responses {
                seen.add(*k, &(&absent[*k] + response.to_hold(hold_s)));
            }
            seen.left()
        };
        times.into_par_iter().map(|hold_s| (left(hold_s), hold_s)).filter(|(left, _)| left.is_finite()).collect()
    };
    // Steps of equal width in the number of holds. They are counted from the beginning of a log, of which this may be a
    // late part.
    let end_s = responses.iter().map(|(_, response)| response.end_s()).fold(0.0, f64::max);
    let [most, fewest] = [FROM, TO].map(|periods| end_s / (periods * driven.period_s));
    let steps = (((most - fewest) / STEP).ceil() as usize).clamp(1, MOST);
    let between = (0..=steps).map(|n| end_s / (most + (fewest - most) * n as f64 / steps as f64));
    let whole = (2..=TO as u32).map(|n| f64::from(n) * driven.period_s);
    let mut tried = scanned(whole.chain(between).collect());
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let about = |&(_, hold_s): &(f64, f64)| FINER.map(|step| end_s / (end_s / hold_s + step));
    tried.extend(scanned(tried.iter().take(WORTH).flat_map(about).collect()));
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best: Vec<f64> = Vec::new();
    for (_, hold_s) in tried {
        if best.len() < BEST && best.iter().all(|known| (hold_s / known - 1.0).abs() > APART) {
            best.push(hold_s);
        }
    }
    best.into_iter().map(|hold_s| vec![hold_s]).collect()
}

/// Linear response of a driven joint to a change of its setpoint.
struct Response<'a> {
    e: &'a Experiment,
    setpoint_rad: &'a [f64],
    hold: Hold,
    law: MotorSpec,
    inertia_kg_m2: f64,
    /// Of controller and gravity \[N m/rad\].
    stiffness_nm_rad: f64,
    /// Of controller and friction \[N m s/rad\].
    damping_nm_s_rad: f64,
}

impl<'a> Response<'a> {
    fn of(e: &'a Experiment, model: &GapModel, values: &[f64]) -> Option<Self> {
        let Signal::Position { setpoint_rad, hold, .. } = &e.signal else { return None };
        let law = e.motor?;
        let chain = model.chain(values, e);
        let mean_rad = e.measured_rad.iter().sum::<f64>() / e.measured_rad.len() as f64;
        let (kp_nm_rad, kd_nm_s_rad) = Motor::<f64>::new(law).stiffness_and_damping(Driven::ByLaw);
        let aside_rad = 1e-3;
        let passive = |q: f64| chain.passive_nm(q, 0.0);
        let gravity_nm_rad = (passive(mean_rad - aside_rad) - passive(mean_rad + aside_rad)) / (2.0 * aside_rad);
        Some(Self {
            e,
            setpoint_rad,
            hold: *hold,
            law,
            inertia_kg_m2: chain.inertia_kg_m2(),
            stiffness_nm_rad: kp_nm_rad + gravity_nm_rad,
            damping_nm_s_rad: kd_nm_s_rad + chain.friction.viscous_nm_s_rad,
        })
    }

    fn end_s(&self) -> f64 {
        self.e.t_s[self.e.t_s.len() - 1]
    }

    /// Setpoint at a time in the sampling interval that begins with sample `k` \[rad\].
    fn setpoint_rad(&self, k: usize, t_s: f64) -> f64 {
        let here = self.setpoint_rad[k];
        match (self.hold, self.setpoint_rad.get(k + 1)) {
            (Hold::Linear, Some(next)) => {
                here + (next - here) * (t_s - self.e.t_s[k]) / (self.e.t_s[k + 1] - self.e.t_s[k])
            }
            _ => here,
        }
    }

    /// What a hold changes of the compared samples, each times the root of its weight.
    fn to_hold(&self, hold_s: f64) -> DVector<f64> {
        let e = self.e;
        let mut moved = DVector::zeros(e.compared());
        let (mut angle_rad, mut rate_rad_s) = (0.0, 0.0);
        let (mut held_rad, mut reading) = (self.setpoint_rad[0], 0);
        let mut taken = (e.t_s[0] / hold_s).floor();
        for k in 0..e.t_s.len() {
            if k >= e.uncompared {
                moved[k - e.uncompared] = e.weights_s[k - e.uncompared].sqrt() * angle_rad;
            }
            let Some(next_s) = e.t_s.get(k + 1) else { break };
            let (from_s, to_s) = (e.t_s[k], *next_s);
            let step_s = to_s - from_s;
            let mut mean_rad = 0.0;
            let mut since_s = from_s;
            // The next reading; a hair before a sample it takes that sample.
            while (taken + 1.0) * hold_s < to_s - 1e-9 {
                taken += 1.0;
                let read_s = (taken * hold_s).max(from_s);
                mean_rad += held_rad * (read_s - since_s);
                while reading < k && e.t_s[reading + 1] <= read_s + 1e-9 {
                    reading += 1;
                }
                held_rad = self.setpoint_rad(reading, read_s);
                since_s = read_s;
            }
            mean_rad = (mean_rad + held_rad * (to_s - since_s)) / step_s;
            let per_answer = self.law.nm_per_answer();
            let mut torque_nm =
                per_answer * self.law.kp_nm_rad * (mean_rad - self.setpoint_rad(k, 0.5 * (from_s + to_s)));
            if self.law.derivative == Derivative::Error && self.hold == Hold::Linear {
                let change_rad = self.setpoint_rad(k, to_s) - self.setpoint_rad(k, from_s);
                torque_nm -= per_answer * self.law.kd_nm_s_rad * change_rad / step_s;
            }
            // Implicit in stiffness and damping.
            let inertia =
                self.inertia_kg_m2 + step_s * self.damping_nm_s_rad + step_s * step_s * self.stiffness_nm_rad.max(0.0);
            let resists_nm = self.damping_nm_s_rad * rate_rad_s + self.stiffness_nm_rad * angle_rad;
            rate_rad_s += step_s * (torque_nm - resists_nm) / inertia;
            angle_rad += step_s * rate_rad_s;
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Residuals;
    use crate::identify::{Case, Found, Problem};
    use crate::joint::EffectId;

    /// Whether the scan proposes a hold that the joint's own simulation shows.
    fn proposes(hold_s: f64) {
        let case = Case::of_study("data/examples/delay/study.toml".as_ref()).unwrap();
        let mut evidence = Evidence::of(&case, case.joint.nominal.unwrap()).unwrap();
        let baseline = evidence.baseline();
        let bare: Vec<f64> = baseline.parameters().iter().map(|p| p.start).collect();
        let held = baseline.with(EffectId::SetpointHold, &evidence.reach);
        let values: Vec<f64> = bare.iter().copied().chain([hold_s]).collect();
        let mut moved = evidence.fit.clone();
        let problem = Problem::new(&held, &evidence.fit);
        let found = |values: &[f64]| Found {
            values: values.to_vec(),
            starts: evidence.fit.iter().map(|e| e.start_coordinates(&e.start)).collect(),
            solution: crate::fit::Solution {
                x: Vec::new(),
                criterion: 0.0,
                trace: Vec::new(),
                stop: crate::Stop::StartRejected,
                evaluations: 0,
            },
        };
        let x = problem.coordinates_from(&found(&values));
        for (k, e) in moved.iter_mut().enumerate() {
            problem.motion(&x, k, |i, s| e.measured_rad[i] = s.angle_rad).unwrap();
        }
        let starts = found(&bare);
        evidence.fit = moved;
        let problem = Problem::new(&baseline, &evidence.fit);
        let x = problem.coordinates_from(&starts);
        let projector = Projector::of(&problem.linearise(&x).unwrap(), baseline.free());
        let absent: Vec<DVector<f64>> =
            (0..evidence.fit.len()).map(|k| super::super::sight::weighted(&problem, &x, k).unwrap()).collect();
        let proposed = hold_scan(&evidence, &baseline, &bare, &absent, &projector);
        let near = |p: &Vec<f64>| (p[0] / hold_s - 1.0).abs() < 2e-3;
        assert!(proposed.iter().any(near), "{hold_s}: {proposed:?}");
    }

    /// Its linear response is good enough, on a chirp that rises through the joint's resonance too.
    #[test]
    fn a_hold_is_among_those_proposed_whatever_its_time() {
        [0.0137, 0.0313, 0.0567, 0.1009].into_iter().for_each(proposes);
    }
}
