//! Which holds of the setpoint are worth a real look.
//!
//! Which setpoints get through changes by leaps with the time between them: the residual has a narrow dip at the true
//! one, and no slope leads there. So many times are tried that no dip is passed over, each through the linear response of
//! joint and controller to what the hold takes from the setpoint; only the best are simulated.

use super::held_response::{HeldJoint, HeldResponse, LANES, WORTH, best_apart, finer_holds_s, tried_holds_s};
use super::projector::{Projector, Seen};
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::model::GapModel;
use crate::identify::{Experiment, JointModel, Signal};
use crate::joint::{Driven, Motor};
use crate::log::{Derivative, Hold};
use nalgebra::DVector;
use rayon::prelude::*;

/// The shortest hold, in sampling periods.
const FROM: f64 = 1.5;

/// Starting values of the hold \[s\], most promising first; none where no setpoint drives the joint.
///
/// `absent` is what a hypothesis of these values leaves of each log.
pub(in crate::gap) fn hold_scan(
    evidence: &Evidence,
    model: &GapModel,
    values: &[f64],
    absent: &[DVector<f64>],
    projector: &Projector,
) -> Vec<Vec<f64>> {
    let Some(driven) = evidence.reach.driven.filter(|driven| driven.by_setpoint) else { return Vec::new() };
    let responses: Vec<Scanned<'_>> =
        evidence.fit.iter().enumerate().filter_map(|(k, e)| Scanned::of(k, e, model, values)).collect();
    // By what they leave, best first, of holds in some of the logs.
    let scanned = |logs: &[Scanned<'_>], times: Vec<f64>| -> Vec<f64> {
        let stays = |k: &usize| logs.iter().all(|moved| moved.log != *k);
        let Some(staying) = projector.seen(absent, (0..absent.len()).filter(stays)) else { return Vec::new() };
        let left = |own: &[f64]| {
            let mut seen = vec![staying.clone(); own.len()];
            for of in logs {
                of.add_to(&mut seen, &absent[of.log], own);
            }
            let left = seen.iter().map(|seen| seen.left()).zip(own.iter().copied());
            left.filter(|(left, _)| left.is_finite()).collect::<Vec<_>>()
        };
        let mut all: Vec<(f64, f64)> = times.par_chunks(LANES).flat_map_iter(left).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.into_iter().map(|(_, hold_s)| hold_s).collect()
    };
    // One log shows the dips of all: the net is cast there, and all look at what is in it.
    let Some(widest) = responses.iter().max_by(|a, b| a.asked_rad().total_cmp(&b.asked_rad())) else {
        return Vec::new();
    };
    let end_s = responses.iter().map(|of| of.response.end_s()).fold(0.0, f64::max);
    let mut caught = scanned(std::slice::from_ref(widest), tried_holds_s(end_s, driven.period_s, FROM).collect());
    caught.truncate(WORTH);
    let finer: Vec<f64> = finer_holds_s(end_s, caught.iter().copied()).collect();
    caught.extend(finer);
    best_apart(scanned(&responses, caught).into_iter()).map(|hold_s| vec![hold_s]).collect()
}

/// A log with the response of its joint.
struct Scanned<'a> {
    log: usize,
    experiment: &'a Experiment,
    response: HeldResponse<'a>,
    /// Of the weights of the compared samples.
    roots: Vec<f64>,
}

impl<'a> Scanned<'a> {
    /// `None` where no setpoint drives it.
    fn of(log: usize, experiment: &'a Experiment, model: &GapModel, values: &[f64]) -> Option<Self> {
        let response = response(experiment, model, values)?;
        let roots = experiment.weights_s.iter().map(|weight_s| weight_s.sqrt()).collect();
        Some(Self { log, experiment, response, roots })
    }

    /// How far its setpoints go in all \[rad\].
    fn asked_rad(&self) -> f64 {
        self.response.setpoint_rad().windows(2).map(|ends| (ends[1] - ends[0]).abs()).sum()
    }

    /// Adds to what is seen of each hold what the log leaves with it, `absent` being what it leaves without.
    fn add_to(&self, seen: &mut [Seen<'_>], absent: &DVector<f64>, holds_s: &[f64]) {
        let moved = self.response.to_holds(holds_s);
        let compared = &moved[self.experiment.uncompared..];
        let mut left = absent.clone();
        for (lane, seen) in seen.iter_mut().enumerate() {
            for (((left, absent), moved), root) in left.iter_mut().zip(absent).zip(compared).zip(&self.roots) {
                *left = absent + root * moved[lane];
            }
            seen.add(self.log, &left);
        }
    }
}

/// Response of the joint of a log; `None` where no setpoint drives it.
fn response<'a>(e: &'a Experiment, model: &GapModel, values: &[f64]) -> Option<HeldResponse<'a>> {
    let Signal::Position { setpoint_rad, hold, .. } = &e.signal else { return None };
    let law = e.motor?;
    let chain = model.chain(values, e);
    let mean_rad = e.measured_rad.iter().sum::<f64>() / e.measured_rad.len() as f64;
    let (kp_nm_rad, kd_nm_s_rad) = Motor::<f64>::new(law).stiffness_and_damping(Driven::ByLaw);
    let aside_rad = 1e-3;
    let passive = |q: f64| chain.passive_nm(q, 0.0);
    let gravity_nm_rad = (passive(mean_rad - aside_rad) - passive(mean_rad + aside_rad)) / (2.0 * aside_rad);
    let asks_for_rate = law.derivative == Derivative::Error && *hold == Hold::Linear;
    Some(HeldResponse::of(HeldJoint {
        t_s: &e.t_s,
        setpoint_rad,
        hold: *hold,
        kp_nm_rad,
        of_rate_nm_s_rad: if asks_for_rate { law.nm_per_answer() * law.kd_nm_s_rad } else { 0.0 },
        inertia_kg_m2: chain.inertia_kg_m2(),
        stiffness_nm_rad: kp_nm_rad + gravity_nm_rad,
        damping_nm_s_rad: kd_nm_s_rad + chain.friction.viscous_nm_s_rad,
    }))
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
