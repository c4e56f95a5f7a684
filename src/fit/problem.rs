//! What a fit is asked: coordinates, residuals in blocks, and how a trial point may be refused.

use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// One coordinate in which an optimiser moves; the problem maps it to a physical parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinate {
    /// For messages.
    pub name: String,
    /// Lowest allowed value; may be minus infinity.
    pub lower: f64,
    /// Highest allowed value; may be infinity.
    pub upper: f64,
    /// A typical change: steps are kept below it, and bounds are rounded off on its scale.
    pub scale: f64,
}

/// A trial point at which the model has no answer. Not an error: the optimiser steps back.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("trial point rejected: {why}")]
pub struct Rejected {
    /// What happened there.
    pub why: String,
}

/// The residuals of one log and their sensitivities to the coordinates that matter to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Block {
    /// Which coordinates the columns of `jacobian` belong to.
    pub columns: Vec<usize>,
    /// `sqrt(w_i) (model_i - measured_i)`; their squares sum to the criterion (3.7) \[rad^2 s\].
    pub residual: Vec<f64>,
    /// Row-major, one row per residual.
    pub jacobian: Vec<f64>,
}

/// Samples that carry less information than their number suggests.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rounding {
    /// Quantisation step, in the residual's unit and with its weight left out \[rad\].
    pub step: f64,
    /// Runs of one and the same reading: one rounding error each, not many.
    pub runs: Vec<Range<usize>>,
}

/// A least-squares problem whose residuals come in blocks, one per log.
pub trait Residuals: Sync {
    /// The coordinates, in the order of `x` below.
    fn coordinates(&self) -> &[Coordinate];

    /// Sum of the squared residuals at `x`, the criterion (3.7).
    ///
    /// # Errors
    /// [`Rejected`] where the model diverges at `x`.
    fn criterion(&self, x: &[f64]) -> Result<f64, Rejected>;

    /// Residuals and their derivatives at `x`.
    ///
    /// # Errors
    /// As [`Residuals::criterion`].
    fn linearise(&self, x: &[f64]) -> Result<Vec<Block>, Rejected>;

    /// Rounding of the readings in a block, for honest intervals.
    fn rounding(&self, block: usize) -> Rounding;

    /// Weights `w_i` \[s\] of the residuals in a block.
    fn weights(&self, block: usize) -> &[f64];

    /// Whether the time for a search is over: it ends where it is.
    fn is_over(&self) -> bool {
        false
    }

    /// For a block of beliefs, not of readings: the variance of each of its residuals.
    fn belief_variance(&self, _block: usize) -> Option<f64> {
        None
    }
}

/// Normal equations of a linearised problem: `J'J` and `J'r`, with the criterion and the number of residuals.
#[derive(Clone, Debug)]
pub struct Normal {
    /// `J'J`
    pub jtj: DMatrix<f64>,
    /// `J'r`
    pub jtr: DVector<f64>,
    /// `r'r`, the criterion (3.7) \[rad^2 s\].
    pub criterion: f64,
    /// Number of residuals.
    pub residuals: usize,
}

impl Normal {
    /// Sums the blocks in their order.
    pub fn of(blocks: &[Block], coordinates: usize) -> Self {
        let mut normal = Self {
            jtj: DMatrix::zeros(coordinates, coordinates),
            jtr: DVector::zeros(coordinates),
            criterion: 0.0,
            residuals: 0,
        };
        for block in blocks {
            normal.criterion += block.residual.iter().map(|r| r * r).sum::<f64>();
            normal.residuals += block.residual.len();
            let m = block.columns.len();
            if m == 0 {
                continue;
            }
            let mut jtj = vec![0.0; m * m];
            let mut jtr = vec![0.0; m];
            for (row, &r) in block.jacobian.chunks_exact(m).zip(&block.residual) {
                for i in 0..m {
                    jtr[i] += row[i] * r;
                    for k in 0..=i {
                        jtj[i * m + k] += row[i] * row[k];
                    }
                }
            }
            for (i, &ci) in block.columns.iter().enumerate() {
                normal.jtr[ci] += jtr[i];
                for (k, &ck) in block.columns.iter().enumerate() {
                    normal.jtj[(ci, ck)] += jtj[i.max(k) * m + i.min(k)];
                }
            }
        }
        normal
    }

    /// Coordinates that a bound does not block: pushing them down the gradient stays inside.
    pub fn unblocked(&self, x: &[f64], coordinates: &[Coordinate]) -> Vec<usize> {
        (0..x.len())
            .filter(|&i| {
                let (c, slope) = (&coordinates[i], self.jtr[i]);
                !(x[i] <= c.lower && slope > 0.0 || x[i] >= c.upper && slope < 0.0)
            })
            .collect()
    }

    /// The step `-(J'J + damping D)^-1 J'r` on the coordinates `free`, zero elsewhere.
    ///
    /// `D` is the diagonal of `J'J`, but for a coordinate to which the residuals hardly answer: it is restrained as if
    /// a change of its typical size mattered a millionth as much as the others'. Coordinates to which no residual
    /// answers stay put. `None` where the system is singular to rounding.
    pub fn step(&self, free: &[usize], coordinates: &[Coordinate], damping: f64) -> Option<DVector<f64>> {
        let free: Vec<usize> = free.iter().copied().filter(|&i| self.jtj[(i, i)] > 0.0).collect();
        let n = free.len();
        let answer = |i: usize| self.jtj[(i, i)] * coordinates[i].scale.powi(2);
        let floor = 1e-6 * free.iter().map(|&i| answer(i)).fold(0.0, f64::max);
        // Scaling to a unit diagonal makes the factorisation independent of the coordinates' units.
        let scale: Vec<f64> = free.iter().map(|&i| answer(i).max(floor).sqrt() / coordinates[i].scale).collect();
        let a = DMatrix::from_fn(n, n, |i, k| {
            self.jtj[(free[i], free[k])] / (scale[i] * scale[k]) + if i == k { damping + 1e-15 } else { 0.0 }
        });
        let b = DVector::from_fn(n, |i, _| -self.jtr[free[i]] / scale[i]);
        let solution = a.cholesky()?.solve(&b);
        let mut step = DVector::zeros(self.jtr.len());
        for (i, &c) in free.iter().enumerate() {
            step[c] = solution[i] / scale[i];
        }
        step.iter().all(|s| s.is_finite()).then_some(step)
    }

    /// How far the criterion is above its quadratic model's minimum over `free`, in units of the residual variance.
    ///
    /// Its root is the distance to the optimum in standard deviations, so that it says "converged" without units.
    pub fn distance_in_variances(&self, free: &[usize], coordinates: &[Coordinate]) -> f64 {
        let Some(step) = self.step(free, coordinates, 1e-12) else { return f64::INFINITY };
        let decrement = -step.dot(&self.jtr);
        let freedom = self.residuals.saturating_sub(free.len()).max(1) as f64;
        decrement * freedom / self.criterion.max(f64::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn blocks_that_share_a_coordinate_add_up() {
        let blocks = [
            Block { columns: vec![0, 1], residual: vec![1.0, 2.0], jacobian: vec![1.0, 0.0, 1.0, 1.0] },
            Block { columns: vec![0, 2], residual: vec![-1.0], jacobian: vec![2.0, 3.0] },
        ];
        let n = Normal::of(&blocks, 3);
        assert_relative_eq!(n.criterion, 6.0);
        assert_eq!(n.jtr.as_slice(), &[1.0, 2.0, -3.0]);
        assert_eq!(n.jtj[(0, 0)], 6.0);
        assert_eq!((n.jtj[(0, 1)], n.jtj[(1, 2)], n.jtj[(2, 0)]), (1.0, 0.0, 6.0));
        let c = Coordinate { name: "x".into(), lower: f64::NEG_INFINITY, upper: f64::INFINITY, scale: 1.0 };
        let step = n.step(&[0, 1, 2], &[c.clone(), c.clone(), c], 0.0).expect("three rows, three coordinates");
        assert_relative_eq!(step.as_slice(), [-1.0, -1.0, 1.0].as_slice(), epsilon = 1e-9);
    }

    #[test]
    fn a_block_to_which_no_coordinate_matters_still_counts() {
        let block = Block { columns: Vec::new(), residual: vec![3.0, 4.0], jacobian: Vec::new() };
        let n = Normal::of(&[block], 0);
        assert_eq!((n.criterion, n.residuals), (25.0, 2));
    }

    #[test]
    fn a_coordinate_at_its_bound_is_blocked_only_against_it() {
        let c = Coordinate { name: "mu".into(), lower: 0.0, upper: 1.0, scale: 1.0 };
        let block = |r: f64| [Block { columns: vec![0], residual: vec![r], jacobian: vec![1.0] }];
        assert!(Normal::of(&block(1.0), 1).unblocked(&[0.0], std::slice::from_ref(&c)).is_empty());
        assert_eq!(Normal::of(&block(-1.0), 1).unblocked(&[0.0], &[c]), vec![0]);
    }
}
