//! One hypothesis about the joint, fitted: its values, what it leaves of the fitted logs and of the held-out ones.

use super::evidence::{Evidence, counts};
use super::model::{BASELINE, GapModel};
use crate::fit::{Budget, Solution, approach};
use crate::identify::{self, BeliefFound, Experiment, Found, JointModel, Parameter, Problem};
use crate::joint::{EffectForm, EffectId};
use rayon::prelude::*;

/// Distance from its optimum, in variances of the residuals, at which a fit is close enough to be judged.
pub(in crate::gap) const CLOSE: f64 = 0.01;

/// Share of the unit of the beliefs below which that of the residuals sets another.
const MUCH_LESS: f64 = 0.5;

/// Evaluations of a fit that is made again from where another ended, and so begins near its end.
pub(in crate::gap) const AGAIN: Budget = Budget { evaluations: 24 };

/// Evaluations of a fit of starts alone.
const STARTS: Budget = Budget { evaluations: 12 };

/// A model with the values that were found, and its residuals.
#[derive(Clone, Debug)]
pub(in crate::gap) struct Trial {
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
        let given = |p: &Parameter| if p.fixed { p.start } else { p.nominal.unwrap_or(p.start) };
        let values: Vec<f64> = model.parameters().iter().map(given).collect();
        let model = model.clone().holding(&held, &values);
        let starts = evidence.fit.iter().map(|e| e.start_coordinates(&e.start)).collect();
        Self::solved(evidence, model, &values, starts, Budget { evaluations: 40 })
    }

    /// A model fitted from values and starts.
    pub fn solved(evidence: &Evidence, model: GapModel, values: &[f64], starts: Vec<[f64; 2]>, budget: Budget) -> Self {
        let values = &model.allowed(values);
        let model = model.at(values);
        let problem = Problem::new(&model, &evidence.fit).until(&evidence.deadline);
        let nothing = Solution {
            x: Vec::new(),
            criterion: f64::NAN,
            trace: vec![],
            stop: crate::Stop::StartRejected,
            evaluations: 0,
        };
        let from = Found { values: values.to_vec(), starts, solution: nothing };
        let solution = approach(&problem, &problem.coordinates_from(&from), budget, CLOSE);
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

    /// Begins logs anew that begin elsewhere in other evidence of the same logs.
    pub fn begin_as(&mut self, here: &Evidence, there: &Evidence) {
        let anew = |starts: &mut [[f64; 2]], here: &[Experiment], there: &[Experiment]| {
            for (start, (a, b)) in starts.iter_mut().zip(here.iter().zip(there)) {
                if a.t_s[0] != b.t_s[0] {
                    *start = b.start_coordinates(&b.start);
                }
            }
        };
        anew(&mut self.found.starts, &here.fit, &there.fit);
        anew(&mut self.held_starts, &here.held, &there.held);
    }

    /// The same hypothesis in other evidence of the same logs, fitted again from where it stands.
    pub fn carried(&self, here: &Evidence, there: &Evidence, budget: Budget) -> Self {
        let mut carried = self.clone();
        carried.begin_as(here, there);
        carried.on(there, budget)
    }

    /// The same numbers in other evidence of the same logs: where these begin elsewhere, their starts are fitted.
    pub fn begun_in(&self, here: &Evidence, there: &Evidence) -> Found {
        let mut begun = self.clone();
        begun.begin_as(here, there);
        if begun.found.starts != self.found.starts {
            let all: Vec<usize> = (0..self.model.parameters().len()).collect();
            let model = self.model.clone().holding(&all, &self.found.values);
            let starts = std::mem::take(&mut begun.found.starts);
            begun.found.starts = Self::solved(there, model, &self.found.values, starts, STARTS).found.starts;
        }
        begun.found
    }

    /// The same with only the first so many of its logs fitted, and the others held out; it has to be fitted again.
    pub fn holding_out_from(mut self, from: usize) -> Self {
        self.held_starts = self.found.starts.split_off(from);
        self.fit.truncate(from);
        self.held.clear();
        self
    }

    /// The same hypothesis on other samples of the same logs.
    pub fn on(&self, evidence: &Evidence, budget: Budget) -> Self {
        let mut there = self.continued(evidence, budget);
        there.held_starts = self.held_starts.clone();
        there
    }

    /// With these of its effects only, fitted again from where it stands.
    pub fn keeping(&self, evidence: &Evidence, kept: &[usize], budget: Budget) -> Self {
        let (model, values) = self.model.keeping(&self.found.values, kept, evidence.baseline(), &evidence.reach);
        Self::solved(evidence, model, &values, self.found.starts.clone(), budget)
    }

    /// Without its effect number `k`, fitted again from where it stands.
    pub fn without(&self, evidence: &Evidence, k: usize, budget: Budget) -> Self {
        let kept: Vec<usize> = (0..self.effects().len()).filter(|i| *i != k).collect();
        self.keeping(evidence, &kept, budget)
    }

    /// With its effect number `k` in another form, fitted again from where it stands.
    pub fn in_form(&self, evidence: &Evidence, k: usize, form: EffectForm, budget: Budget) -> Self {
        let change = (k, form);
        let (model, values) = self.model.reformed(&self.found.values, change, evidence.baseline(), &evidence.reach);
        Self::solved(evidence, model, &values, self.found.starts.clone(), budget)
    }

    /// The search carried on with beliefs in the unit that its own residuals set.
    pub fn settled(self, evidence: &Evidence, budget: Budget) -> Self {
        let unit = self.unit_rad2_s(evidence);
        let model = self.model.clone().in_unit(unit);
        Self::solved(evidence, model, &self.found.values, self.found.starts.clone(), budget)
    }

    /// The same where the beliefs weigh far more than its own residuals say, as they do where others were far from the logs.
    pub fn at_rest(self, evidence: &Evidence, budget: Budget) -> Self {
        let unit = self.unit_rad2_s(evidence);
        let weighs_too_much = unit > 0.0 && unit < MUCH_LESS * self.model.unit_rad2_s();
        if weighs_too_much { self.settled(evidence, budget) } else { self }
    }

    /// What one unit of deviance weighs in the criterion \[rad^2 s\], by the residuals' size and how long they hang
    /// together, and never below the encoder's rounding.
    pub fn unit_rad2_s(&self, evidence: &Evidence) -> f64 {
        identify::unit_rad2_s(&evidence.fit, &self.fit)
    }

    /// What was believed of each number that is not exact, and where it is now.
    pub fn beliefs(&self) -> Vec<BeliefFound> {
        BeliefFound::of(&self.model.parameters()[..BASELINE], &self.found.values)
    }

    /// What the fitted logs leave to what is believed of the joint's numbers, in sentences.
    pub fn undetermined(&self, evidence: &Evidence) -> Vec<String> {
        let problem = Problem::new(&self.model, &evidence.fit);
        let x = problem.coordinates_from(&self.found);
        identify::undetermined(&problem, &x, |i| i < BASELINE, self.unit_rad2_s(evidence))
    }

    /// Deviance of its values under the beliefs.
    pub fn strain(&self) -> f64 {
        self.model.strain(&self.found.values)
    }

    /// Predicts the held-out logs; `near` gives starts from which theirs are sought.
    pub fn predict(&mut self, evidence: &Evidence, near: Option<&Trial>) {
        if !self.held.is_empty() {
            return;
        }
        let known = std::mem::take(&mut self.held_starts);
        let of = |(k, e): (usize, &Experiment)| {
            let guess = known.get(k).copied().or_else(|| near.and_then(|t| t.held_starts.get(k).copied()));
            predicted(&self.model, e, &self.found.values, guess)
        };
        (self.held_starts, self.held) = evidence.held.par_iter().enumerate().map(of).unzip();
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
        losses(&evidence.fit, &self.fit)
    }

    /// Root of the mean counted square over the fitted logs \[rad\].
    pub fn fit_rms_rad(&self, evidence: &Evidence) -> f64 {
        let samples: f64 = evidence.fit.iter().map(|e| counts(e).sum::<f64>()).sum();
        (self.fit_loss(evidence) / samples).sqrt()
    }

    /// Sum over the held-out logs of the counted squared residuals \[rad^2\].
    pub fn held_loss(&self, evidence: &Evidence) -> f64 {
        losses(&evidence.held, &self.held)
    }
}

/// Counted sum of squares over logs \[rad^2\].
pub(in crate::gap) fn losses(experiments: &[Experiment], residuals_rad: &[Vec<f64>]) -> f64 {
    experiments.iter().zip(residuals_rad).map(|(e, r)| loss(e, r)).sum()
}

/// Counted sum of squares \[rad^2\].
pub(in crate::gap) fn loss(e: &Experiment, residual: &[f64]) -> f64 {
    counts(e).zip(residual).map(|(c, r)| c * r * r).sum()
}

/// Model less reading along the compared samples; infinite where the motion runs away.
pub(in crate::gap) fn residual(problem: &Problem<'_, GapModel>, x: &[f64], k: usize) -> Vec<f64> {
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
pub(in crate::gap) fn predicted(
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
        .map(|start| approach(&problem, &start, budget, CLOSE))
        .min_by(|a, b| a.criterion.total_cmp(&b.criterion));
    let x = best.map_or_else(|| own.to_vec(), |s| s.x);
    ([x[0], x[1]], residual(&problem, &x, 0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::Case;

    #[test]
    fn where_a_log_begins_later_it_begins_where_its_readings_say() {
        let case = Case::of_study("data/examples/delay/study.toml".as_ref()).unwrap();
        let evidence = Evidence::of(&case, case.joint.nominal.unwrap()).unwrap();
        let coarse = evidence.coarse();
        let [whole, part] = [&evidence, &coarse].map(|e| &e.fit[0]);
        assert!(part.t_s[0] > whole.t_s[0], "the liveliest part of the log begins with it");
        let given = Trial::as_given(&evidence, &evidence.baseline());
        let begun = given.begun_in(&evidence, &coarse);
        assert_eq!(begun.values, given.found.values);
        approx::assert_abs_diff_eq!(begun.starts[0][0], part.measured_rad[0], epsilon = 0.1);
        assert_eq!(given.begun_in(&evidence, &evidence).starts, given.found.starts);
    }
}
