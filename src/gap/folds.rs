//! Predictions of logs, or parts of one, by fits to the others.
//!
//! A fit without one log lies near the fit to all: one Gauss-Newton step without that log's rows leads there (the
//! infinitesimal jackknife, Jaeckel 1972, carried to the whole step). The log's own start is then found with everything
//! else held.

use super::compare::{Difference, blocks};
use super::evidence::Evidence;
use super::trial::{Trial, predicted};
use crate::fit::{Block, Normal, Residuals};
use crate::identify::{Experiment, Found, Problem};
use rayon::prelude::*;

/// Logs or parts that are predicted from one another.
pub(super) struct Folds {
    pub experiments: Vec<Experiment>,
    /// Parts of one log have starts of their own, which a fit to the whole log does not know.
    cut: bool,
}

/// Folds at the least: fewer logs are cut into parts.
const FEWEST: usize = 6;
/// Parts are no shorter than this \[s\].
const SHORTEST_S: f64 = 0.8;

impl Folds {
    /// Each fitted log in turn; parts of them where they are few.
    pub fn of(evidence: &Evidence) -> Self {
        let all = &evidence.fit;
        if all.len() >= FEWEST {
            return Self { experiments: all.clone(), cut: false };
        }
        let parts = FEWEST.div_ceil(all.len().max(1)) as f64;
        let cut = |e: &Experiment| {
            let duration_s = e.t_s[e.t_s.len() - 1] - e.t_s[0];
            e.parts((duration_s / parts).max(SHORTEST_S))
        };
        Self { experiments: all.iter().flat_map(cut).collect(), cut: true }
    }

    /// Each log in turn, whole; the parts of a single one.
    pub fn of_logs(evidence: &Evidence) -> Self {
        match &evidence.fit[..] {
            [_] => Self::of(evidence),
            all => Self { experiments: all.to_vec(), cut: false },
        }
    }

    /// Whether these are parts of one log.
    pub fn are_parts(&self) -> bool {
        self.cut
    }

    /// Model less reading of each, by a fit to the others \[rad\].
    pub fn residuals(&self, evidence: &Evidence, trial: &Trial) -> Vec<Vec<f64>> {
        let values = self.values(trial);
        (0..self.experiments.len())
            .into_par_iter()
            .map(|k| {
                let near = (!self.cut).then(|| trial.found.starts.get(k).copied()).flatten();
                let values = values.get(k).unwrap_or(&trial.found.values);
                let here = predicted(&trial.model, &self.experiments[k], values, near).1;
                if here.iter().all(|r| r.is_finite()) || evidence.fit.is_empty() {
                    here
                } else {
                    predicted(&trial.model, &self.experiments[k], &trial.found.values, near).1
                }
            })
            .collect()
    }

    /// Values of a hypothesis fitted without each of these in turn.
    pub fn values(&self, trial: &Trial) -> Vec<Vec<f64>> {
        let problem = Problem::new(&trial.model, &self.experiments);
        let starts = if self.cut {
            let own = |e: &Experiment| predicted(&trial.model, e, &trial.found.values, None).0;
            self.experiments.par_iter().map(own).collect()
        } else {
            trial.found.starts.clone()
        };
        let x = problem.coordinates_from(&Found { starts, ..trial.found.clone() });
        let free = trial.model.free();
        let Ok(all) = problem.linearise(&x) else { return Vec::new() };
        if free == 0 || self.experiments.len() < 2 {
            return Vec::new();
        }
        let coordinates = problem.coordinates();
        (0..self.experiments.len())
            .map(|k| {
                let others: Vec<Block> =
                    all.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, b)| b.clone()).collect();
                let normal = Normal::of(&others, x.len());
                let open = normal.unblocked(&x, coordinates);
                let mut there = x.clone();
                if let Some(step) = normal.step(&open, coordinates, 1e-9) {
                    for (i, c) in coordinates.iter().enumerate() {
                        let step = step[i].clamp(-c.scale, c.scale);
                        there[i] = (x[i] + step).max(c.lower).min(c.upper);
                    }
                }
                let mut values = trial.found.values.clone();
                let fitted = problem.values(&there);
                for (i, p) in crate::identify::JointModel::parameters(&trial.model).iter().enumerate() {
                    if !p.fixed {
                        values[i] = fitted[i];
                    }
                }
                values
            })
            .collect()
    }

    /// How much worse residuals `a` predict than `b`.
    pub fn difference(&self, a: &[Vec<f64>], b: &[Vec<f64>]) -> Difference {
        Difference::of(&blocks(&self.experiments, a, b).collect::<Vec<f64>>())
    }
}
