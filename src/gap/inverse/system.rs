//! Least squares under beliefs, kept as sums over blocks of the logs so that any choice of columns and blocks is one small
//! factorisation.

use nalgebra::{DMatrix, DVector};

/// An unknown, counted from what is believed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unknown {
    /// Standard deviation of the belief.
    pub sd: f64,
    /// What it may be.
    pub bounds: [f64; 2],
}

/// A stretch of one log of one joint: sums of products of its columns, all weighed.
#[derive(Clone, Debug)]
pub(super) struct Block {
    /// Which log of the study.
    pub log: usize,
    /// Whether its log is fitted.
    pub is_fit: bool,
    /// The part of the log that is held out with it where logs are cut.
    pub part: usize,
    /// Samples, and the square of the standard deviation by which each is divided.
    pub samples: usize,
    pub unit: f64,
    gram: DMatrix<f64>,
    right: DVector<f64>,
    square: f64,
}

impl Block {
    /// Of columns and of what they have to explain, and the standard deviation of a sample by which both are divided.
    /// `place`: log, part.
    pub fn new(place: [usize; 2], is_fit: bool, columns: &DMatrix<f64>, target: &DVector<f64>, sd: f64) -> Self {
        let [log, part] = place;
        let (columns, target) = (columns / sd, target / sd);
        Self {
            samples: target.len(),
            unit: sd * sd,
            log,
            part,
            is_fit,
            gram: columns.tr_mul(&columns),
            right: columns.tr_mul(&target),
            square: target.norm_squared(),
        }
    }

    /// The same where a sample's standard deviation is so many times what it was.
    pub fn rescale(&mut self, times: f64) {
        let square = times * times;
        self.gram /= square;
        self.right /= square;
        self.square /= square;
        self.unit *= square;
    }

    /// Weighed square of what unknowns leave.
    pub fn squares(&self, x: &DVector<f64>) -> f64 {
        (self.square - 2.0 * self.right.dot(x) + x.dot(&(&self.gram * x))).max(0.0)
    }
}

/// A linear problem.
#[derive(Clone, Debug)]
pub(super) struct System {
    pub unknowns: Vec<Unknown>,
    pub blocks: Vec<Block>,
}

/// What a choice of columns comes to.
#[derive(Clone, Debug)]
pub(super) struct Solved {
    /// Of all unknowns; zero for those that were not chosen.
    pub x: DVector<f64>,
    /// Covariance of those that were.
    pub covariance: DMatrix<f64>,
    /// In the covariance's order.
    pub chosen: Vec<usize>,
}

impl Solved {
    /// Standard deviation of an unknown; infinite where it was not chosen.
    pub fn sd(&self, unknown: usize) -> f64 {
        let at = self.chosen.iter().position(|k| *k == unknown);
        at.map_or(f64::INFINITY, |at| self.covariance[(at, at)].max(0.0).sqrt())
    }
}

impl System {
    /// All unknowns.
    pub fn all(&self) -> Vec<usize> {
        (0..self.unknowns.len()).collect()
    }

    /// What a fit to the fitted blocks comes to: weighed squares, and those of what was believed.
    pub fn criterion(&self, solved: &Solved) -> f64 {
        let left: f64 = self.blocks.iter().filter(|block| block.is_fit).map(|block| block.squares(&solved.x)).sum();
        let strain = |k: &usize| (solved.x[*k] / self.unknowns[*k].sd).powi(2);
        left + solved.chosen.iter().map(strain).sum::<f64>()
    }

    /// The chosen unknowns fitted to blocks, the others as believed. Bounds are kept by holding what would leave them.
    pub fn fit(&self, chosen: &[usize], on: impl Fn(&Block) -> bool) -> Solved {
        let mut gram = DMatrix::zeros(chosen.len(), chosen.len());
        let mut right = DVector::zeros(chosen.len());
        for block in self.blocks.iter().filter(|block| on(block)) {
            for (a, i) in chosen.iter().enumerate() {
                right[a] += block.right[*i];
                for (b, j) in chosen.iter().enumerate() {
                    gram[(a, b)] += block.gram[(*i, *j)];
                }
            }
        }
        for (a, i) in chosen.iter().enumerate() {
            gram[(a, a)] += self.unknowns[*i].sd.powi(-2);
        }
        // What may have one value has it from the beginning: others would be held for want of it.
        let one_value =
            |i: &usize| Some(self.unknowns[*i].bounds).filter(|[low, high]| low == high).map(|[low, _]| low);
        let mut held: Vec<Option<f64>> = chosen.iter().map(one_value).collect();
        loop {
            let solved = self.solve(chosen, &gram, &right, &held);
            let beyond = |(a, i): (usize, &usize)| {
                let [low, high] = self.unknowns[*i].bounds;
                let x = solved.x[*i];
                let out = (low - x).max(x - high);
                (held[a].is_none() && out > 0.0).then_some((a, x.clamp(low, high), out / self.unknowns[*i].sd))
            };
            match chosen.iter().enumerate().filter_map(beyond).max_by(|a, b| a.2.total_cmp(&b.2)) {
                Some((a, end, _)) => held[a] = Some(end),
                None => return solved,
            }
        }
    }

    fn solve(&self, chosen: &[usize], gram: &DMatrix<f64>, right: &DVector<f64>, held: &[Option<f64>]) -> Solved {
        let free: Vec<usize> = (0..chosen.len()).filter(|a| held[*a].is_none()).collect();
        let mut x = DVector::zeros(self.unknowns.len());
        for (a, end) in held.iter().enumerate() {
            x[chosen[a]] = end.unwrap_or(0.0);
        }
        let part = DMatrix::from_fn(free.len(), free.len(), |a, b| gram[(free[a], free[b])]);
        let pulled = |a: usize| {
            let by_held = held.iter().enumerate().map(|(b, end)| gram[(a, b)] * end.unwrap_or(0.0));
            right[a] - by_held.sum::<f64>()
        };
        let target = DVector::from_iterator(free.len(), free.iter().map(|a| pulled(*a)));
        let mut covariance = DMatrix::zeros(chosen.len(), chosen.len());
        // The beliefs make the matrix positive definite.
        if let Some(factors) = part.cholesky() {
            let found = factors.solve(&target);
            let inverse = factors.inverse();
            for (a, i) in free.iter().enumerate() {
                x[chosen[*i]] = found[a];
                for (b, j) in free.iter().enumerate() {
                    covariance[(*i, *j)] = inverse[(a, b)];
                }
            }
        }
        Solved { x, covariance, chosen: chosen.to_vec() }
    }

    /// What is held out together: logs that are fitted, or parts of the only one.
    fn fold(&self, block: &Block) -> usize {
        let mut logs = self.blocks.iter().filter(|block| block.is_fit).map(|block| block.log);
        let first = logs.next();
        if logs.any(|log| Some(log) != first) { block.log } else { block.part }
    }

    /// Weighed squares that a choice of columns leaves on each fitted block when its log is held out.
    pub fn held_out(&self, chosen: &[usize]) -> Vec<f64> {
        let mut folds: Vec<usize> = self.blocks.iter().filter(|b| b.is_fit).map(|block| self.fold(block)).collect();
        let of_block = folds.clone();
        folds.sort_unstable();
        folds.dedup();
        let fits: Vec<Solved> =
            folds.iter().map(|fold| self.fit(chosen, |block| block.is_fit && self.fold(block) != *fold)).collect();
        let fitted = self.blocks.iter().filter(|block| block.is_fit);
        let left = |(block, fold): (&Block, &usize)| {
            let at = folds.partition_point(|known| known < fold);
            block.squares(&fits[at].x)
        };
        fitted.zip(&of_block).map(left).collect()
    }

    /// The refits of a choice without each fold.
    pub fn refits(&self, chosen: &[usize]) -> Vec<Solved> {
        let mut folds: Vec<usize> = self.blocks.iter().filter(|b| b.is_fit).map(|block| self.fold(block)).collect();
        folds.sort_unstable();
        folds.dedup();
        folds.iter().map(|fold| self.fit(chosen, |block| block.is_fit && self.fold(block) != *fold)).collect()
    }
}

/// How much better one prediction of the same blocks is than another: the sum of what it saves, and by how many of its
/// standard deviations that lies above nothing.
pub(super) fn saved(before: &[f64], after: &[f64]) -> (f64, f64) {
    let n = before.len() as f64;
    let differences: Vec<f64> = before.iter().zip(after).map(|(before, after)| before - after).collect();
    let mean = differences.iter().sum::<f64>() / n.max(1.0);
    let variance = differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    let sd = (variance / n.max(1.0)).sqrt();
    (mean * n, if sd > 0.0 { mean / sd } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two columns over four blocks; the target is 2 of the first.
    fn system(sd: f64, low: f64) -> System {
        let block = |k: usize| {
            let at = |i: usize, c: usize| ((i + 5 * k) as f64 * (0.7 + c as f64)).sin();
            let columns = DMatrix::from_fn(20, 2, at);
            let target = DVector::from_fn(20, |i, _| 2.0 * at(i, 0));
            Block::new([k / 2, k], true, &columns, &target, 1.0)
        };
        let unknown = Unknown { sd, bounds: [low, f64::INFINITY] };
        System { unknowns: vec![unknown; 2], blocks: (0..4).map(block).collect() }
    }

    #[test]
    fn what_made_the_logs_is_found_and_what_is_not_chosen_stays() {
        let system = system(10.0, 0.0);
        let solved = system.fit(&[0], |_| true);
        assert!((solved.x[0] - 2.0).abs() < 1e-3 && solved.x[1] == 0.0 && solved.sd(0) < 0.3);
        assert!(system.held_out(&[0]).iter().sum::<f64>() < 1e-3);
        assert!(system.held_out(&[1]).iter().sum::<f64>() > 10.0);
    }

    #[test]
    fn beliefs_hold_what_the_logs_would_move_and_bounds_are_kept() {
        assert!(system(0.01, 0.0).fit(&[0, 1], |_| true).x[0] < 0.1);
        let mut told = system(10.0, 0.0);
        told.unknowns[0].bounds = [2.0, 2.0];
        let solved = told.fit(&[0, 1], |_| true);
        assert!(solved.x[0] == 2.0 && solved.x[1].abs() < 1e-3);
        let bound = system(10.0, 3.0).fit(&[0], |_| true);
        assert_eq!((bound.x[0], bound.sd(0)), (3.0, 0.0));
    }

    #[test]
    fn savings_that_are_the_same_everywhere_stand_out() {
        assert!(saved(&[2.0, 2.1, 1.9, 2.0], &[1.0, 1.0, 1.0, 1.0]).1 > 10.0);
        assert!(saved(&[2.0, 0.0, 2.0, 0.0], &[1.0; 4]).1.abs() < 0.1);
    }
}
