//! The logs of a study as evidence: what is fitted, what is held out, and how much each sample counts.

use super::model::GapModel;
use super::reach::reach_of;
use super::torque_seen::gain_seen;
use crate::deadline::Deadline;
pub(in crate::gap) use crate::identify::counts;
use crate::identify::{Belief, Case, Directives, Experiment, Signal};
use crate::joint::Reach;
use crate::log::{Nominal, Role, Uncertain};
use std::sync::Arc;

/// What a simulation of the whole robot, at its best, leaves of a joint: root of the mean square on held-out logs \[rad\].
#[derive(Clone, Copy, Debug)]
pub(in crate::gap) struct WholeLeft {
    /// With numbers alone.
    pub bare_rad: f64,
    /// With all causes that were found so far.
    pub found_rad: f64,
}

/// A study's logs, made ready to be argued from.
pub(in crate::gap) struct Evidence {
    /// Logs that parameters are fitted to.
    pub fit: Vec<Experiment>,
    /// Logs that are only predicted; empty where the study names none, and where they were pooled.
    pub held: Vec<Experiment>,
    /// Where the logs that the study holds out begin among the fitted ones, if they were pooled.
    pub pooled_from: Option<usize>,
    /// The joint as given.
    pub nominal: Nominal,
    /// How sure the engineer is of it.
    pub uncertain: Uncertain,
    /// Whether beliefs are normal: held-out logs refute numbers that heavy tails let go far.
    pub normal_beliefs: bool,
    /// What logged torques say of the drive's gain.
    pub gain_seen: Option<Belief>,
    /// Of a joint of a robot: what the whole robot leaves of it.
    pub whole: Option<WholeLeft>,
    /// Whether nothing is asked for but numbers: no law either.
    pub numbers_alone: bool,
    /// What the user demands of numbers and of parameters of effects.
    pub demands: Arc<Directives>,
    /// Where it hangs, as given; 0 where nothing is said \[rad\].
    pub rest_rad: f64,
    /// Typical sizes.
    pub reach: Reach,
    /// Whether a drive or a known mass shows torques, not only their ratios.
    pub scale_known: bool,
    /// Until when they may be argued from.
    pub deadline: Deadline,
}

/// A phase in which the encoder repeats one rounding error counts like this many samples.
const RUN_COUNTS: f64 = 12.0;

impl Evidence {
    /// Whether other joints push this one: what is known of their motion is known to an encoder's step.
    pub fn is_carried(&self) -> bool {
        self.fit.iter().any(|e| e.carriage.is_some())
    }

    /// Whether a drive whose torques no log has moves the joint in all of them, with no known mass and below its limit: torques
    /// show against one another alone.
    pub fn shows_ratios_alone(&self) -> bool {
        let is_below_limit = |e: &Experiment| {
            e.motor.and_then(|motor| motor.torque_limit_nm).is_none_or(|limit_nm| e.largest_command_nm() < limit_nm)
        };
        let shows_ratios = |e: &Experiment| {
            matches!(e.signal, Signal::Position { .. })
                && e.torque_seen_nm.is_none()
                && e.load.is_none()
                && is_below_limit(e)
        };
        !self.is_carried() && self.fit.iter().all(shows_ratios)
    }

    /// The evidence of a case; `None` where no log to be fitted moves.
    pub fn of(case: &Case, nominal: Nominal) -> Option<Self> {
        let mut fit = case.experiments(Role::Fit);
        let mut held = case.experiments(Role::Validate);
        if fit.is_empty() {
            fit = std::mem::take(&mut held);
        }
        if fit.is_empty() {
            return None;
        }
        for e in fit.iter_mut().chain(&mut held) {
            lighten_runs(e);
        }
        let all: Vec<Experiment> = fit.iter().chain(&held).cloned().collect();
        let loads = |e: &Experiment| e.load.map_or(0.0, |l| l.moment_kg_m);
        let scale_known = fit.iter().any(|e| e.is_driven() || loads(e) > 0.1 * nominal.moment_kg_m);
        Some(Self {
            reach: reach_of(&all, &nominal),
            fit,
            held,
            pooled_from: None,
            nominal,
            uncertain: case.uncertain.clone(),
            normal_beliefs: false,
            gain_seen: gain_seen(&all, &case.uncertain),
            whole: None,
            numbers_alone: false,
            demands: Arc::default(),
            rest_rad: case.joint.rest_rad.unwrap_or(0.0),
            scale_known,
            deadline: Deadline::default(),
        })
    }

    /// The joint as it is believed to be.
    pub fn baseline(&self) -> GapModel {
        let model = GapModel::baseline(&self.nominal, self.rest_rad, &self.reach, &self.uncertain)
            .with_gain_seen(self.gain_seen)
            .under(&self.demands);
        if self.normal_beliefs { model.believed_normally() } else { model }
    }

    /// The same study with other logs.
    pub fn with_logs(&self, fit: Vec<Experiment>, held: Vec<Experiment>) -> Self {
        let (uncertain, demands) = (self.uncertain.clone(), Arc::clone(&self.demands));
        Self { fit, held, uncertain, demands, deadline: self.deadline.clone(), ..*self }
    }

    /// The same logs, all of them to be fitted: for what only a held-out log shows.
    pub fn pooled(&self) -> Self {
        let fit = self.fit.iter().chain(&self.held).cloned().collect();
        Self { pooled_from: Some(self.fit.len()), ..self.with_logs(fit, Vec::new()) }
    }

    /// The fitted logs cut into short parts with starts of their own: over a short time no hypothesis runs far from its
    /// log, so that a search has few local minima.
    pub fn in_parts(&self) -> Self {
        let total_s: f64 = self.fit.iter().map(|e| e.t_s[e.t_s.len() - 1] - e.t_s[0]).sum();
        let part_s = (total_s / PARTS).max(SHORTEST_PART_S);
        let fit = self.fit.iter().flat_map(|e| e.parts(part_s)).collect();
        self.with_logs(fit, Vec::new())
    }

    /// The same logs with fewer samples, for the many fits of an exploration.
    pub fn coarse(&self) -> Self {
        let thin = |all: &[Experiment]| all.iter().map(thinned).collect();
        self.with_logs(thin(&self.fit), thin(&self.held))
    }
}

/// Short parts of all logs together, at the most, and how short they may be \[s\].
const PARTS: f64 = 48.0;
const SHORTEST_PART_S: f64 = 0.6;
/// Samples of a free log that an exploration looks at, at the most.
const COARSE_SAMPLES: usize = 260;

/// Samples and time \[s\] of a driven log that an exploration looks at, at the most: whichever is more.
const COARSE_DRIVEN: usize = 600;
const COARSE_DRIVEN_S: f64 = 8.0;

/// A free log with every few samples left out; those that stay count for those that go. What drives a log between two
/// samples counts: of a long driven one the part is looked at in which most happens.
fn thinned(e: &Experiment) -> Experiment {
    if e.is_driven() {
        return liveliest(e);
    }
    let stride = e.compared().div_ceil(COARSE_SAMPLES);
    if stride < 2 {
        return e.clone();
    }
    let keep: Vec<usize> = (0..e.uncompared).chain((e.uncompared..e.t_s.len()).step_by(stride)).collect();
    let pick = |values: &[f64]| keep.iter().map(|&k| values[k]).collect::<Vec<f64>>();
    Experiment {
        t_s: pick(&e.t_s),
        measured_rad: pick(&e.measured_rad),
        weights_s: e.weights_s.chunks(stride).map(|part| part.iter().sum()).collect(),
        runs: Vec::new(),
        ..e.clone()
    }
}

/// The part of a long log along which the joint goes farthest.
fn liveliest(e: &Experiment) -> Experiment {
    let by_time = e.t_s.partition_point(|t| *t < e.t_s[0] + COARSE_DRIVEN_S);
    let width = by_time.max(COARSE_DRIVEN);
    if e.t_s.len() <= width {
        return e.clone();
    }
    let range = crate::log::liveliest(&e.measured_rad, width);
    let part = e.part(range.clone());
    // What counts little in the log counts little in the part.
    match (range.start + part.uncompared).checked_sub(e.uncompared) {
        Some(first) => Experiment { weights_s: e.weights_s[first..][..part.compared()].to_vec(), ..part },
        None => part,
    }
}

/// A long phase of one repeated reading is one rounding error: it gets the weight of a few samples, because its
/// hundreds would pull the friction to where the joint happens to rest within a step of the encoder.
fn lighten_runs(e: &mut Experiment) {
    for run in &e.runs {
        let share = (RUN_COUNTS / run.len() as f64).min(1.0);
        for weight in &mut e.weights_s[run.clone()] {
            *weight *= share;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_counts_little_in_a_log_counts_little_in_its_liveliest_part() {
        let case = Case::of_study("data/examples/delay/study.toml".as_ref()).unwrap();
        let mut evidence = Evidence::of(&case, case.joint.nominal.unwrap()).unwrap();
        evidence.fit[0].weights_s[900..1000].iter_mut().for_each(|weight| *weight *= 0.01);
        let (whole, coarse) = (&evidence.fit[0], &evidence.coarse().fit[0]);
        let from = coarse.first_sample;
        assert!(from > 0, "it is cut");
        for k in [from + 1, 895, 905, 995, 1005] {
            approx::assert_relative_eq!(coarse.weights_s[k - from], whole.weights_s[k], max_relative = 1e-9);
        }
    }
}
