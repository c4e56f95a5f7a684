//! Which further effects would explain more: a cheap look at many points, then real fits from the best of them.
//!
//! At a fitted trial the residual of every starting point of an effect is projected off all columns that the trial can
//! move (its parameters, every log's start): what is left is, to first order, what a full refit would leave. Only the
//! best points are refitted, and only the serious ones of these to the end. An effect is never judged on frozen
//! parameters.

use super::evidence::Evidence;
use super::model::GapModel;
use super::trial::Trial;
use crate::fit::{Block, Budget, Residuals};
use crate::identify::{Found, Problem};
use crate::joint::EffectId;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;

/// Points of each effect that are refitted briefly, and evaluations for each.
const BRIEF_POINTS: usize = 2;
const BRIEF: Budget = Budget { evaluations: 10 };
/// Effects that are refitted at all, by what they promise; and the same for a second effect.
const PROMISING: usize = 10;
const PROMISING_SECONDS: usize = 5;
/// Evaluations of the searches that are carried to the end.
const FULL: Budget = Budget { evaluations: 40 };
/// A brief fit is carried on where its criterion is below the best brief one times this, or it is among the best few.
const SERIOUS: f64 = 1.6;
const AT_LEAST: usize = 3;

/// What a trial can take up by itself, to first order.
pub(super) struct Projector {
    /// For each log: an orthonormal basis of its start's columns, and the shared columns without their part in it.
    logs: Vec<(DMatrix<f64>, DMatrix<f64>)>,
    gram: Option<Cholesky<f64, Dyn>>,
}

impl Projector {
    pub(super) fn of(blocks: &[Block], shared: usize) -> Self {
        let mut gram = DMatrix::zeros(shared, shared);
        let logs: Vec<_> = blocks
            .iter()
            .map(|b| {
                let (rows, width) = (b.residual.len(), b.columns.len());
                let whole = DMatrix::from_row_slice(rows, width, &b.jacobian);
                let starts = whole.columns(shared, width - shared).into_owned();
                let basis = orthonormal(starts);
                let columns = whole.columns(0, shared).into_owned();
                let columns = &columns - &basis * (basis.transpose() * &columns);
                gram += columns.transpose() * &columns;
                (basis, columns)
            })
            .collect();
        // A little of each diagonal keeps directions that the logs leave open from being used.
        for i in 0..shared {
            gram[(i, i)] += 1e-6 * gram[(i, i)] + 1e-300;
        }
        Self { logs, gram: gram.cholesky() }
    }

    /// Square sum of residuals after the trial's own columns have taken up what they can.
    pub(super) fn left(&self, residuals: &[DVector<f64>]) -> f64 {
        let Some(gram) = &self.gram else { return f64::INFINITY };
        let mut sum = 0.0;
        let mut product = DVector::zeros(gram.l_dirty().nrows());
        for ((basis, columns), r) in self.logs.iter().zip(residuals) {
            let along = basis.transpose() * r;
            sum += r.norm_squared() - along.norm_squared();
            product += columns.transpose() * r;
        }
        sum - product.dot(&gram.solve(&product))
    }
}

/// Columns made orthonormal (Gram-Schmidt); columns of nothing are left out.
fn orthonormal(columns: DMatrix<f64>) -> DMatrix<f64> {
    let mut basis: Vec<DVector<f64>> = Vec::new();
    for column in columns.column_iter() {
        let mut rest = column.into_owned();
        let size = rest.norm();
        for known in &basis {
            let along = known.dot(&rest);
            rest.axpy(-along, known, 1.0);
        }
        if rest.norm() > 1e-9 * size && size > 0.0 {
            basis.push(rest.normalize());
        }
    }
    if basis.is_empty() { DMatrix::zeros(columns.nrows(), 0) } else { DMatrix::from_columns(&basis) }
}

/// The best fits of `base` with one of the effects added, one for each effect that promises something; best first.
///
/// `also` are further values of the base's parameters from which to start: what is missing may have bent the fitted
/// ones far from the truth, and what the engineer believes is then nearer to it.
pub(super) fn explore(evidence: &Evidence, base: &Trial, also: &[Vec<f64>], effects: &[EffectId]) -> Vec<Trial> {
    let problem = Problem::new(&base.model, &evidence.fit);
    let Ok(blocks) = problem.linearise(&problem.coordinates_from(&base.found)) else { return Vec::new() };
    let projector = Projector::of(&blocks, base.model.free());
    let mut points: Vec<Point> = effects
        .par_iter()
        .flat_map(|&effect| {
            let model = base.model.with(effect, &evidence.reach);
            let from = |values: &Vec<f64>| best_points(evidence, base, values, &model, effect, &projector);
            [&base.found.values].into_iter().chain(also).flat_map(from).collect::<Vec<_>>()
        })
        .collect();
    points.sort_by(|a, b| a.promise.total_cmp(&b.promise));
    let promising = if base.effects().is_empty() { PROMISING } else { PROMISING_SECONDS };
    let mut kept: Vec<EffectId> = Vec::new();
    for point in &points {
        if kept.len() < promising && !kept.contains(&point.effect) {
            kept.push(point.effect);
        }
    }
    points.retain(|point| kept.contains(&point.effect));
    let brief: Vec<Trial> = points
        .into_par_iter()
        .map(|point| {
            let model = base.model.with(point.effect, &evidence.reach);
            Trial::solved(evidence, model, &point.values, base.found.starts.clone(), BRIEF)
        })
        .collect();
    let best: Vec<Trial> = one_of_each(brief).into_par_iter().map(|trial| scanned_finely(evidence, trial)).collect();
    let line = best.first().map_or(f64::INFINITY, |t| SERIOUS * t.criterion());
    let done: Vec<Trial> = best
        .into_par_iter()
        .enumerate()
        .map(
            |(rank, trial)| {
                if rank < AT_LEAST || trial.criterion() < line { trial.continued(evidence, FULL) } else { trial }
            },
        )
        .collect();
    one_of_each(done)
}

/// A trial whose setpoint hold has been scanned finely about where it stands: which setpoints get through changes by
/// leaps, and no slope leads from one to the next.
fn scanned_finely(evidence: &Evidence, trial: Trial) -> Trial {
    let Some(k) = trial.effects().iter().position(|e| *e == EffectId::SetpointHold) else { return trial };
    let at = trial.model.place(k).start;
    let problem = Problem::new(&trial.model, &evidence.fit);
    let values = |share: f64| {
        let mut values = trial.found.values.clone();
        values[at] *= share;
        values
    };
    let criterion = |values: &Vec<f64>| {
        let x = problem.coordinates_from(&Found { values: values.clone(), ..trial.found.clone() });
        problem.criterion(&x).unwrap_or(f64::INFINITY)
    };
    let shares = (-FINE..=FINE).map(|n| 1.0 + f64::from(n) * FINE_SHARE).map(values);
    let best = shares.map(|v| (criterion(&v), v)).min_by(|a, b| a.0.total_cmp(&b.0));
    match best {
        Some((criterion, values)) if criterion < 0.999 * trial.criterion() => {
            let again = Trial::solved(evidence, trial.model.clone(), &values, trial.found.starts.clone(), BRIEF);
            if again.criterion() < trial.criterion() { again } else { trial }
        }
        _ => trial,
    }
}

/// Steps either way of the fine scan, and their size as a share.
const FINE: i32 = 30;
const FINE_SHARE: f64 = 0.0025;

/// The best trial for each set of effects; best first.
pub(super) fn one_of_each(trials: Vec<Trial>) -> Vec<Trial> {
    let mut best: Vec<Trial> = Vec::new();
    for trial in trials {
        let same = |t: &&mut Trial| t.effects().iter().all(|e| trial.effects().contains(e));
        match best.iter_mut().find(|t| t.effects().len() == trial.effects().len() && same(t)) {
            Some(known) if known.criterion() <= trial.criterion() => {}
            Some(known) => *known = trial,
            None => best.push(trial),
        }
    }
    best.sort_by(|a, b| a.criterion().total_cmp(&b.criterion()));
    best
}

/// A place from which an effect may be refitted.
struct Point {
    effect: EffectId,
    values: Vec<f64>,
    /// Criterion that a refit would leave, to first order.
    promise: f64,
}

/// Points from which the effect's refit promises most, with the base's parameters at `from`.
fn best_points(
    evidence: &Evidence,
    base: &Trial,
    from: &[f64],
    model: &GapModel,
    effect: EffectId,
    projector: &Projector,
) -> Vec<Point> {
    let problem = Problem::new(model, &evidence.fit);
    let weighted = |x: &[f64], problem: &Problem<'_, GapModel>, k: usize| -> Option<DVector<f64>> {
        let e = &evidence.fit[k];
        let mut r = DVector::zeros(e.compared());
        let motion = problem.motion(x, k, |i, s| {
            if i >= e.uncompared {
                let row = i - e.uncompared;
                r[row] = e.weights_s[row].sqrt() * (s.angle_rad - e.measured_rad[i]);
            }
        });
        motion.ok().map(|()| r)
    };
    let bare = Problem::new(&base.model, &evidence.fit);
    let bare_x = bare.coordinates_from(&Found { values: from.to_vec(), ..base.found.clone() });
    let Some(absent) = (0..evidence.fit.len()).map(|k| weighted(&bare_x, &bare, k)).collect::<Option<Vec<_>>>() else {
        return Vec::new();
    };
    let left_absent = projector.left(&absent);
    let mut ranked: Vec<Point> = effect
        .starts(&evidence.reach)
        .into_iter()
        .filter_map(|start| {
            let values: Vec<f64> = from.iter().copied().chain(start).collect();
            let x = problem.coordinates_from(&Found { values: values.clone(), ..base.found.clone() });
            let there: Vec<DVector<f64>> = (0..evidence.fit.len())
                .map(|k| {
                    // What only a drive shows leaves a free swing as it is.
                    if effect.is_driven_only() && !evidence.fit[k].is_driven() {
                        Some(absent[k].clone())
                    } else {
                        weighted(&x, &problem, k)
                    }
                })
                .collect::<Option<_>>()?;
            let left = projector.left(&there);
            let moved: Vec<DVector<f64>> = there.iter().zip(&absent).map(|(there, absent)| there - absent).collect();
            let change = projector.left(&moved);
            // Along the line from no effect to this one: the least of the parabola, up to four times the size.
            let slope = 0.5 * (left - left_absent - change);
            let size = (-slope / change).clamp(0.0, 4.0);
            let least = left_absent + 2.0 * size * slope + size * size * change;
            let promise = if least.is_finite() { left.min(least) } else { left };
            Some(Point { effect, values, promise })
        })
        .collect();
    ranked.sort_by(|a, b| a.promise.total_cmp(&b.promise));
    ranked.truncate(if base.effects().is_empty() { BRIEF_POINTS } else { 1 });
    ranked
}
