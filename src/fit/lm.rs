//! Levenberg-Marquardt with bounds, the work horse.
//!
//! Ours and not a library's for two reasons: friction needs a bound at zero that a coordinate can touch and leave
//! again, and a trial point at which the motion diverges must be stepped back from, not end the solve.
//! Damping after Nielsen (1999), on the diagonal of `J'J` as Marquardt (1963).

use super::{Budget, Normal, Residuals, Solution, Stop};

/// Distance to the optimum, in standard deviations squared, below which the fit has converged.
pub(super) const CONVERGED_VARIANCES: f64 = 1e-8;

/// Accepted steps that gain less than this, in the same unit, creep along a valley that the logs leave open...
const CREEPING_VARIANCES: f64 = 0.05;
/// ... and this many of them in a row end the search.
const PATIENCE: usize = 8;

/// Minimises the criterion from `start`, to within so many variances of the residuals.
pub(super) fn levenberg_marquardt(problem: &dyn Residuals, start: &[f64], budget: Budget, close: f64) -> Solution {
    let coordinates = problem.coordinates();
    let mut x = clamped(start, coordinates.iter().map(|c| (c.lower, c.upper)));
    let mut evaluations = 1;
    let mut normal = match problem.linearise(&x) {
        Ok(blocks) => Normal::of(&blocks, x.len()),
        Err(_) => return Solution::rejected(x),
    };
    let mut trace = vec![normal.criterion];
    let (mut damping, mut growth) = (1e-3, 2.0);
    let mut idle = 0;
    // Where steps succeed the next trial point is linearised at once, without a look at its criterion first.
    let mut confident = true;
    let stop = loop {
        let free = normal.unblocked(&x, coordinates);
        if normal.distance_in_variances(&free, coordinates) < close {
            break Stop::Converged;
        }
        if evaluations >= budget.evaluations || problem.is_over() {
            break Stop::BudgetSpent;
        }
        if damping > 1e14 || idle >= PATIENCE {
            break Stop::NoFurtherDecrease;
        }
        let Some(step) = normal.step(&free, coordinates, damping) else {
            damping *= 10.0;
            continue;
        };
        let moved: Vec<f64> =
            (0..x.len()).map(|i| x[i] + step[i].clamp(-coordinates[i].scale, coordinates[i].scale)).collect();
        let trial = clamped(&moved, coordinates.iter().map(|c| (c.lower, c.upper)));
        evaluations += 1;
        let moved = nalgebra::DVector::from_fn(x.len(), |i, _| trial[i] - x[i]);
        let predicted = -(2.0 * normal.jtr.dot(&moved) + moved.dot(&(&normal.jtj * &moved)));
        let gain_of = |criterion: f64| {
            if predicted > 0.0 {
                (normal.criterion - criterion) / predicted
            } else if criterion < normal.criterion {
                0.1
            } else {
                -1.0
            }
        };
        let is_last = evaluations + 1 >= budget.evaluations;
        let linearised = || problem.linearise(&trial).map(|blocks| Normal::of(&blocks, x.len()));
        let seen = if confident && !is_last {
            linearised().map(|next| (next.criterion, Some(next)))
        } else {
            problem.criterion(&trial).map(|criterion| (criterion, None))
        };
        let (criterion, next) = seen.unwrap_or((f64::NAN, None));
        let gain = gain_of(criterion);
        confident = gain > 1e-4;
        if confident && is_last {
            trace.push(criterion);
            return Solution { x: trial, criterion, trace, stop: Stop::BudgetSpent, evaluations };
        }
        let next = if confident { next.or_else(|| linearised().ok()) } else { None };
        let Some(next) = next else {
            confident = false;
            damping *= growth;
            growth *= 2.0;
            continue;
        };
        evaluations += 1;
        let gained_variances = (normal.criterion - next.criterion) / next.criterion * next.residuals as f64;
        idle = if gained_variances < CREEPING_VARIANCES { idle + 1 } else { 0 };
        (x, normal) = (trial, next);
        trace.push(normal.criterion);
        damping = (damping * (1.0 - (2.0 * gain - 1.0).powi(3)).clamp(1.0 / 3.0, 2.0)).max(1e-12);
        growth = 2.0;
    };
    Solution { x, criterion: normal.criterion, trace, stop, evaluations }
}

/// A point moved inside its bounds.
pub(super) fn clamped(x: &[f64], bounds: impl Iterator<Item = (f64, f64)>) -> Vec<f64> {
    x.iter().zip(bounds).map(|(x, (lower, upper))| x.max(lower).min(upper)).collect()
}
