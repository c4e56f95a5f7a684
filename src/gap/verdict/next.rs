//! The experiment that would tell apart what these logs cannot.
//!
//! Candidates are swings from wider angles and with more mass, and, where the joint has a motor, motions within the
//! range that the logs already use. What only a motor that is on can show is looked for with the motor on: with it off
//! the hypotheses would differ by the masses and frictions that each asks for, and the joint could be any third thing.
//! For each, both hypotheses predict the reading; what is left of the difference after
//! the rival has been refitted to the old logs and the new one together, in units of the noise, gives the power
//! (T-optimal discrimination, Atkinson and Fedorov 1975, to first order).

use crate::fit::{Normal, Residuals};
use crate::gap::diagnosis::Next;
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::trial::Trial;
use crate::gap::search::attribute::Attribution;
use crate::identify::{Experiment, Load, Problem, Signal};
use crate::joint::Stage;
use crate::number::chance::normal_below;
use crate::number::math;
use crate::pendulum::Start;
use std::f64::consts::TAU;

/// Deviance by which two hypotheses must differ to be told apart.
const TOLD_APART: f64 = 16.0;
/// Length of a proposed log \[s\].
const DURATION_S: f64 = 6.0;

struct Proposal {
    what: String,
    experiment: Experiment,
    motion: Option<(Vec<f64>, Vec<f64>)>,
}

impl Proposal {
    fn is_driven(&self) -> bool {
        self.experiment.is_driven()
    }
}

/// The proposal that separates the answer from all its rivals best; `None` where there is nothing to separate.
pub(in crate::gap) fn next(evidence: &Evidence, a: &Attribution, answer: &Trial, rivals: &[&Trial]) -> Option<Next> {
    if rivals.is_empty() {
        return None;
    }
    let shown_freely = rivals.iter().all(|rival| differ_freely(answer, rival));
    let mut proposals = proposals(evidence);
    if !shown_freely && proposals.iter().any(Proposal::is_driven) {
        proposals.retain(Proposal::is_driven);
    }
    let coarse = evidence.coarse();
    let begun = |trial: &Trial| Trial { found: trial.begun_in(evidence, &coarse), ..trial.clone() };
    let (here, against): (Trial, Vec<Trial>) = (begun(answer), rivals.iter().map(|rival| begun(rival)).collect());
    let rated = proposals.into_iter().map(|proposal| {
        let weakest = against.iter().flat_map(|rival| {
            [
                power(&coarse, a, &proposal.experiment, &here, rival),
                power(&coarse, a, &proposal.experiment, rival, &here),
            ]
        });
        (weakest.fold(1.0, f64::min), proposal)
    });
    let (power, best) = rated.max_by(|x, y| x.0.total_cmp(&y.0))?;
    let others: Vec<String> = rivals.iter().map(|rival| name(rival)).collect();
    let what = format!("{}, to tell {} from {}.", best.what, name(answer), others.join(" and "));
    Some(Next { what, power, motion: best.motion })
}

/// Whether two hypotheses differ by something that a motor that is off shows too.
fn differ_freely(a: &Trial, b: &Trial) -> bool {
    let only = |a: &Trial, b: &Trial| a.effects().iter().any(|e| !b.effects().contains(e) && !e.is_driven_only());
    let law = |trial: &Trial| {
        trial.model.law().map(|law| law.stage()).filter(|stage| [Stage::Link, Stage::Sensor].contains(stage))
    };
    let by_law = |a: &Trial, b: &Trial| law(a).is_some() && law(a) != law(b);
    only(a, b) || only(b, a) || by_law(a, b) || by_law(b, a)
}

/// Of what a hypothesis consists.
fn name(trial: &Trial) -> String {
    let effects: Vec<&str> = trial.effects().iter().map(|e| e.id()).collect();
    let law = trial.model.law().map(|_| "a law");
    let parts: Vec<&str> = effects.into_iter().chain(law).collect();
    if parts.is_empty() { "numbers alone".to_owned() } else { parts.join("+") }
}

/// Probability that the experiment, made by `truth`, tells it from `rival`.
fn power(coarse: &Evidence, a: &Attribution, e: &Experiment, truth: &Trial, rival: &Trial) -> f64 {
    let unit = a.noise_rad.powi(2) * a.correlation;
    left_after_refit(coarse, e, truth, rival).map_or(0.0, |left| {
        // A difference of deviances has twice its root as standard deviation.
        let deviance = left / unit;
        let z = (deviance - TOLD_APART) / (2.0 * deviance.max(1.0).sqrt());
        normal_below(z)
    })
}

/// Counted square sum by which the rival misses what the truth does in the new log, after a refit to all logs.
fn left_after_refit(coarse: &Evidence, e: &Experiment, truth: &Trial, rival: &Trial) -> Option<f64> {
    let start = e.start_coordinates(&e.start);
    let predicted = |trial: &Trial| -> Option<Vec<f64>> {
        let one = std::slice::from_ref(e);
        let problem = Problem::of_starts(&trial.model, one, &trial.found.values);
        let mut q = Vec::with_capacity(e.t_s.len());
        problem.motion(&start, 0, |_, s| q.push(s.angle_rad)).ok()?;
        Some(q)
    };
    let reading = predicted(truth)?;
    let period = e.weights_s.iter().copied().fold(0.0, f64::max);
    let mut all = coarse.fit.clone();
    all.push(Experiment { measured_rad: reading, ..e.clone() });
    let mut starts = rival.found.starts.clone();
    starts.push(start);
    let problem = Problem::new(&rival.model, &all);
    let found = crate::identify::Found { starts, ..rival.found.clone() };
    let x = problem.coordinates_from(&found);
    let mut blocks = problem.linearise(&x).ok()?;
    let new = all.len() - 1;
    for block in blocks.iter_mut().enumerate().filter(|(k, _)| *k != new).map(|(_, block)| block) {
        block.residual.iter_mut().for_each(|r| *r = 0.0);
    }
    let normal = Normal::of(&blocks, x.len());
    let mut jtj = normal.jtj.clone();
    for i in 0..x.len() {
        jtj[(i, i)] += 1e-9 * jtj[(i, i)] + 1e-300;
    }
    let taken = normal.jtr.dot(&jtj.cholesky()?.solve(&normal.jtr));
    Some(((normal.criterion - taken) / period).max(0.0))
}

fn proposals(evidence: &Evidence) -> Vec<Proposal> {
    let Some(example) = evidence.fit.first() else { return Vec::new() };
    let n = &evidence.nominal;
    let period_s = evidence.fit.iter().map(|e| e.t_s[1] - e.t_s[0]).fold(f64::INFINITY, f64::min).clamp(5e-4, 0.02);
    let t_s: Vec<f64> = (0..=(DURATION_S / period_s) as usize).map(|k| k as f64 * period_s).collect();
    let distance_m = if n.moment_kg_m > 0.0 { (n.inertia_kg_m2 / n.moment_kg_m).sqrt().clamp(0.03, 0.3) } else { 0.1 };
    let log = |signal: Signal, angle_rad: f64, load: Option<Load>, motor| Experiment {
        file: String::new(),
        first_sample: 0,
        measured_rad: vec![0.0; t_s.len()],
        uncompared: 0,
        weights_s: vec![period_s; t_s.len()],
        signal,
        motor,
        release_window_s: None,
        start: Start { angle_rad, rate_rad_s: 0.0, release_s: None },
        load,
        runs: Vec::new(),
        t_s: t_s.clone(),
        ..example.clone()
    };
    let mut all = Vec::new();
    for share in [0.0, 0.5, 1.0, 2.0] {
        let mass_kg = share * n.moment_kg_m / distance_m;
        let load = (mass_kg > 0.0).then_some(Load {
            inertia_kg_m2: mass_kg * distance_m * distance_m,
            moment_kg_m: mass_kg * distance_m,
            angle_rad: 0.0,
            hanging_rad: 0.0,
        });
        for angle in [-1.8, -0.7, 0.7, 1.4, 2.2] {
            let hung = if mass_kg > 0.0 {
                format!(" with {} hung on at {:.0} mm from the axis", grams(mass_kg), 1e3 * distance_m)
            } else {
                " without extra mass".to_owned()
            };
            let what = format!("Let it swing from {angle:.1} rad{hung}, motor off, for {DURATION_S:.0} s");
            all.push(Proposal { what, experiment: log(Signal::Off, angle, load, example.motor), motion: None });
        }
    }
    let driven = evidence.fit.iter().filter(|e| e.is_driven() && e.motor.is_some());
    let [low, high] = crate::number::extent(driven.clone().flat_map(|e| &e.measured_rad).copied());
    let (middle_rad, widest_rad) = (0.5 * (low + high), 0.5 * (high - low));
    if let Some(example) = driven.clone().next() {
        for (amplitude, from_hz, to_hz) in [(0.5, 0.2, 1.5), (1.0, 0.2, 1.5), (1.0, 0.5, 4.0)] {
            let amplitude = amplitude * widest_rad;
            let sweep = |t: f64| {
                let phase = TAU * (from_hz * t + 0.5 * (to_hz - from_hz) * t * t / DURATION_S);
                middle_rad + amplitude * math::sin(phase)
            };
            let setpoint_rad: Vec<f64> = t_s.iter().map(|t| sweep(*t)).collect();
            let motion = Some((t_s.clone(), setpoint_rad.clone()));
            let hold = example.motor.map(|m| m.hold).unwrap_or_default();
            let signal = Signal::Position { setpoint_rad, apart: None, hold, on: None };
            // No middle is minus nothing.
            let about_rad = (100.0 * middle_rad).round() / 100.0 + 0.0;
            let what = format!(
                "Drive it along the sweep in next.csv: {amplitude:.2} rad about {about_rad:.2} rad, from {from_hz} to {to_hz} Hz in {DURATION_S:.0} s"
            );
            all.push(Proposal { what, experiment: log(signal, middle_rad, None, example.motor), motion });
        }
    }
    all
}

fn grams(kg: f64) -> String {
    if kg < 1.0 { format!("{:.0} g", 1e3 * kg) } else { format!("{kg:.2} kg") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::Case;

    #[test]
    fn a_sweep_stays_where_the_logs_have_been() {
        let case = Case::of_study("data/examples/delay/study.toml".as_ref()).unwrap();
        let mut evidence = Evidence::of(&case, case.joint.nominal.unwrap()).unwrap();
        evidence.fit[0].measured_rad.iter_mut().for_each(|q| *q += 3.0);
        let been = &evidence.fit[0].measured_rad;
        let [low, high] = [been.iter().copied().fold(9.0, f64::min), been.iter().copied().fold(-9.0, f64::max)];
        let sweeps: Vec<Proposal> = proposals(&evidence).into_iter().filter(Proposal::is_driven).collect();
        assert_eq!(sweeps.len(), 3);
        for Proposal { motion, experiment, .. } in sweeps {
            let (_, setpoint_rad) = motion.unwrap();
            assert!(setpoint_rad.iter().all(|q| (low - 1e-9..=high + 1e-9).contains(q)));
            approx::assert_relative_eq!(experiment.start.angle_rad, setpoint_rad[0]);
        }
    }
}
