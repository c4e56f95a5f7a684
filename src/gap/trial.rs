//! One hypothesis about the joint, fitted: its values, what it leaves of the fitted logs and of the held-out ones.

use super::evidence::{Evidence, counts};
use super::model::{GapModel, INERTIA, MOMENT};
use crate::fit::{Budget, Method, Solution, solve};
use crate::identify::{Experiment, Found, JointModel, Problem};
use crate::joint::EffectId;

/// A model with the values that were found, and its residuals.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    pub model: GapModel,
    /// Values of all parameters, and each fitted log's start.
    pub found: Found,
    /// Model less reading of each fitted log's compared samples \[rad\].
    pub fit: Vec<Vec<f64>>,
    /// The same of each held-out log; empty before [`Trial::predict`].
    pub held: Vec<Vec<f64>>,
    /// Start of each held-out log.
    pub held_starts: Vec<[f64; 2]>,
}

impl Trial {
    /// The joint as given, with only the starts of the logs fitted.
    pub fn as_given(evidence: &Evidence, model: &GapModel) -> Self {
        let held: Vec<usize> = (0..model.parameters().len()).collect();
        let values: Vec<f64> = model.parameters().iter().map(|p| p.start).collect();
        let model = model.clone().holding(&held, &values);
        let starts = evidence.fit.iter().map(|e| e.start_coordinates(&e.start)).collect();
        Self::solved(evidence, model, &values, starts, Budget { evaluations: 40 })
    }

    /// A model fitted from values and starts.
    pub fn solved(evidence: &Evidence, model: GapModel, values: &[f64], starts: Vec<[f64; 2]>, budget: Budget) -> Self {
        // Ratios alone: the moment sets the scale, or the inertia of a joint that is said to have no moment.
        let scale = if values[MOMENT] > 0.0 { MOMENT } else { INERTIA };
        let model = if evidence.scale_known { model } else { model.holding(&[scale], values) }.at(values);
        let problem = Problem::new(&model, &evidence.fit);
        let nothing = Solution {
            x: Vec::new(),
            criterion: f64::NAN,
            trace: vec![],
            stop: crate::Stop::StartRejected,
            evaluations: 0,
        };
        let from = Found { values: values.to_vec(), starts, solution: nothing };
        let solution = solve(&problem, &problem.coordinates_from(&from), Method::Lm, budget);
        let fit = (0..evidence.fit.len()).map(|k| residual(&problem, &solution.x, k)).collect();
        // Held parameters keep the values they came with.
        let mut all = values.to_vec();
        for (i, p) in model.parameters().iter().enumerate() {
            if !p.fixed {
                all[i] = problem.values(&solution.x)[i];
            }
        }
        let found = Found {
            values: all,
            starts: (0..evidence.fit.len()).map(|k| problem.start(&solution.x, k)).collect(),
            solution,
        };
        Self { model, found, fit, held: Vec::new(), held_starts: Vec::new() }
    }

    /// The search carried on.
    pub fn continued(&self, evidence: &Evidence, budget: Budget) -> Self {
        Self::solved(evidence, self.model.clone(), &self.found.values, self.found.starts.clone(), budget)
    }

    /// The same hypothesis on other samples of the same logs.
    pub fn on(&self, evidence: &Evidence, budget: Budget) -> Self {
        let mut there = self.continued(evidence, budget);
        there.held_starts = self.held_starts.clone();
        there
    }

    /// Without its effect number `k`, fitted again from where it stands.
    pub fn without(&self, evidence: &Evidence, baseline: &GapModel, k: usize, budget: Budget) -> Self {
        let mut values = self.found.values.clone();
        values.drain(self.model.place(k));
        let mut model = baseline.clone();
        for (i, &effect) in self.effects().iter().enumerate() {
            if i != k {
                model = model.with(effect, &evidence.reach);
            }
        }
        Self::solved(evidence, model, &values, self.found.starts.clone(), budget)
    }

    /// Predicts the held-out logs; `near` gives starts from which theirs are sought.
    pub fn predict(&mut self, evidence: &Evidence, near: Option<&Trial>) {
        if !self.held.is_empty() {
            return;
        }
        let known = std::mem::take(&mut self.held_starts);
        for (k, e) in evidence.held.iter().enumerate() {
            let guess = known.get(k).copied().or_else(|| near.and_then(|t| t.held_starts.get(k).copied()));
            let (start, residual) = predicted(&self.model, e, &self.found.values, guess);
            self.held.push(residual);
            self.held_starts.push(start);
        }
    }

    /// The effects that were added.
    pub fn effects(&self) -> &[EffectId] {
        self.model.effects()
    }

    /// The criterion on the fitted logs; infinite where there is no motion.
    pub fn criterion(&self) -> f64 {
        self.found.solution.criterion
    }

    /// Sum over the fitted logs of the counted squared residuals \[rad^2\].
    pub fn fit_loss(&self, evidence: &Evidence) -> f64 {
        evidence.fit.iter().zip(&self.fit).map(|(e, r)| loss(e, r)).sum()
    }

    /// The same over the held-out logs.
    pub fn held_loss(&self, evidence: &Evidence) -> f64 {
        evidence.held.iter().zip(&self.held).map(|(e, r)| loss(e, r)).sum()
    }
}

/// Counted sum of squares \[rad^2\].
pub(super) fn loss(e: &Experiment, residual: &[f64]) -> f64 {
    counts(e).zip(residual).map(|(c, r)| c * r * r).sum()
}

/// Model less reading along the compared samples; infinite where the motion runs away.
fn residual(problem: &Problem<'_, GapModel>, x: &[f64], k: usize) -> Vec<f64> {
    let e = &problem.experiments[k];
    let mut r = Vec::with_capacity(e.compared());
    let motion = problem.motion(x, k, |i, s| {
        if i >= e.uncompared {
            r.push(s.angle_rad - e.measured_rad[i]);
        }
    });
    if motion.is_err() {
        r = vec![f64::INFINITY; e.compared()];
    }
    r
}

/// A log predicted at given values: its start is found first, from its own guess and from `near`.
pub(super) fn predicted(
    model: &GapModel,
    e: &Experiment,
    values: &[f64],
    near: Option<[f64; 2]>,
) -> ([f64; 2], Vec<f64>) {
    let one = std::slice::from_ref(e);
    let problem = Problem::of_starts(model, one, values);
    let own = e.start_coordinates(&e.start);
    let budget = Budget { evaluations: 30 };
    let best = near
        .into_iter()
        .chain([own])
        .map(|start| solve(&problem, &start, Method::Lm, budget))
        .min_by(|a, b| a.criterion.total_cmp(&b.criterion));
    let x = best.map_or_else(|| own.to_vec(), |s| s.x);
    ([x[0], x[1]], residual(&problem, &x, 0))
}
