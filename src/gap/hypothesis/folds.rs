//! Predictions of parts of logs by fits to the rest, for choosing among hypotheses.
//!
//! A fit without a part lies near the fit to all: one Gauss-Newton step without that part's rows leads there (the
//! jackknife of Jaeckel 1972, carried to the whole step). What it says of the part is what the log's own motion shows
//! there. So a prediction costs one simulation, and choosing costs little more than fitting.

use super::compare::{Difference, blocks};
use super::evidence::Evidence;
use super::model::GapModel;
use super::trial::{Trial, residual};
use crate::fit::{Block, Coordinate, Normal, Residuals};
use crate::identify::{Experiment, Problem};
use rayon::prelude::*;
use std::ops::Range;

/// Parts in all, at the least, and of each log.
const PARTS: usize = 8;
const OF_EACH: usize = 2;

/// Shares of the step that are tried, beside none.
const SHARES: [f64; 3] = [1.0, 0.5, 0.2];

/// A part of a log that is predicted by the rest: the log, and its rows.
struct Fold {
    log: usize,
    rows: Range<usize>,
}

/// Parts of the fitted logs.
pub(in crate::gap) struct Folds<'a> {
    evidence: &'a Evidence,
    folds: Vec<Fold>,
    /// Whether a log without its first part starts where the whole log does, and not where the rest of it says.
    holds_starts: bool,
}

impl<'a> Folds<'a> {
    pub fn of(evidence: &'a Evidence) -> Self {
        let each = PARTS.div_ceil(evidence.fit.len().max(1)).max(OF_EACH);
        let of_log = |(log, e): (usize, &Experiment)| {
            let n = e.compared();
            (0..each).map(move |part| Fold { log, rows: part * n / each..(part + 1) * n / each }).collect::<Vec<_>>()
        };
        Self { holds_starts: false, evidence, folds: evidence.fit.iter().enumerate().flat_map(of_log).collect() }
    }

    /// The same where a log that loses its first part keeps its start: the rest of a damped log tells little of that, and a
    /// hypothesis that follows it is charged for where it went.
    pub fn with_starts_held(self) -> Self {
        Self { holds_starts: true, ..self }
    }

    /// Model less reading of each fitted log \[rad\], every part as the rest predicts it.
    pub fn residuals(&self, trial: &Trial) -> Vec<Vec<f64>> {
        let problem = Problem::new(&trial.model, &self.evidence.fit);
        let x = problem.coordinates_from(&trial.found);
        let Ok(all) = problem.linearise(&x) else { return trial.fit.clone() };
        let mut predicted = trial.fit.clone();
        if trial.model.free() == 0 {
            return predicted;
        }
        let coordinates = problem.coordinates();
        let inside = |i: usize, x: f64| x.max(coordinates[i].lower).min(coordinates[i].upper);
        let unmoved: Vec<f64> = x.iter().enumerate().map(|(i, x)| inside(i, *x)).collect();
        let here: Vec<Vec<f64>> = (0..self.evidence.fit.len()).map(|k| residual(&problem, &unmoved, k)).collect();
        let whole = Normal::of(&all, x.len());
        let of_fold = |fold: &Fold| {
            let mut normal = whole.clone();
            let own = Normal::of(std::slice::from_ref(&rows_of(&all[fold.log], &fold.rows)), x.len());
            normal.jtj -= own.jtj;
            normal.jtr -= own.jtr;
            normal.criterion -= own.criterion;
            normal.residuals -= own.residuals;
            let start = trial.model.free() + 2 * fold.log;
            let is_held = |i: &usize| self.holds_starts && fold.rows.start == 0 && (start..start + 2).contains(i);
            let mut open = normal.unblocked(&x, coordinates);
            open.retain(|i| !is_held(i));
            let step = normal.step(&open, coordinates, 1e-6)?;
            let part = |share: f64| -> Vec<f64> {
                let moved = |(i, c): (usize, &Coordinate)| {
                    inside(i, x[i] + (share * step[i]).clamp(-0.3 * c.scale, 0.3 * c.scale))
                };
                coordinates.iter().enumerate().map(moved).collect()
            };
            // Where joints stick the model has kinks, and a whole step may go too far: the rest of the logs says so.
            let at_rest = self.rest(&problem, &unmoved, fold, f64::INFINITY, |k| here[k].clone());
            let mut least = at_rest;
            let tried = SHARES.map(|share| {
                let there = part(share);
                let rest = self.rest(&problem, &there, fold, least, |k| residual(&problem, &there, k));
                least = least.min(rest);
                (rest, share)
            });
            let (_, share) = tried.into_iter().chain([(at_rest, 0.0)]).min_by(|a, b| a.0.total_cmp(&b.0))?;
            let r = if share > 0.0 { residual(&problem, &part(share), fold.log) } else { here[fold.log].clone() };
            r[fold.rows.clone()].iter().all(|r| r.is_finite()).then(|| r[fold.rows.clone()].to_vec())
        };
        let parts: Vec<Option<Vec<f64>>> = self.folds.par_iter().map(of_fold).collect();
        for (fold, part) in self.folds.iter().zip(parts) {
            if let Some(part) = part {
                predicted[fold.log][fold.rows.clone()].copy_from_slice(&part);
            }
        }
        predicted
    }

    /// Criterion of a point on everything but a part, by what it leaves of each log; infinite where the logs alone exceed
    /// a bound.
    fn rest(
        &self,
        problem: &Problem<'_, GapModel>,
        x: &[f64],
        fold: &Fold,
        bound: f64,
        left: impl Fn(usize) -> Vec<f64>,
    ) -> f64 {
        let mut readings = 0.0;
        for (k, e) in self.evidence.fit.iter().enumerate() {
            let squares = left(k).into_iter().zip(&e.weights_s).map(|(r, w)| w * r * r);
            let inside = |i: &usize| k != fold.log || !fold.rows.contains(i);
            readings += squares.enumerate().filter(|(i, _)| inside(i)).map(|(_, s)| s).sum::<f64>();
            if readings > bound {
                return f64::INFINITY;
            }
        }
        readings + problem.beliefs(x).iter().flat_map(|b| &b.residual).map(|r| r * r).sum::<f64>()
    }

    /// How much worse residuals `a` predict than `b`.
    pub fn difference(&self, a: &[Vec<f64>], b: &[Vec<f64>]) -> Difference {
        Difference::of(&blocks(&self.evidence.fit, a, b).collect::<Vec<f64>>())
    }
}

/// Some rows of a block.
fn rows_of(block: &Block, rows: &Range<usize>) -> Block {
    let width = block.columns.len();
    Block {
        columns: block.columns.clone(),
        residual: block.residual[rows.clone()].to_vec(),
        jacobian: block.jacobian[rows.start * width..rows.end * width].to_vec(),
    }
}
