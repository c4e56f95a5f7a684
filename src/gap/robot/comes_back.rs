//! Whether what is left comes back with the motion. Noise does not, whatever its colour; and what is less than one step of the
//! encoder may be noise.

use super::bench::Bench;
use super::map::{VARIABLES, along};
use crate::gap::Variable;
use std::ops::AddAssign;

/// Share of what is left above the sensor's noise that its dependence on one variable, learnt where fits saw it, predicts
/// where none did: of one joint, and of all together.
const OF_A_JOINT: f64 = 0.3;
const OF_ALL: f64 = 0.1;
/// Bins of a variable.
const BINS: usize = 8;

/// Squares over samples that no fit saw.
#[derive(Clone, Copy, Default)]
struct Squares {
    /// Less by what was learnt \[rad^2\].
    predicted: f64,
    /// What is left above the sensor's noise \[rad^2\].
    excess: f64,
}

impl Squares {
    fn come_back(self, share: f64) -> bool {
        self.excess > 0.0 && self.predicted > share * self.excess
    }
}

impl AddAssign for Squares {
    fn add_assign(&mut self, other: Self) {
        self.predicted += other.predicted;
        self.excess += other.excess;
    }
}

/// Whether what is left of every joint is less than one step of its encoder and does not come back.
pub(super) fn may_be_noise(bench: &Bench<'_>, left: &[f64]) -> bool {
    let Some(step_rad) = bench.case.study.sensor.resolution_rad else { return false };
    let moving = bench.layout.moving();
    let is_small = |joint: &usize| bench.rms_rad(*joint, left) < step_rad;
    if !moving.iter().all(is_small) || !bench.layout.held.iter().any(|held| *held) {
        return false;
    }
    let comes_back = VARIABLES.into_iter().any(|variable| {
        let mut all = Squares::default();
        let of_one = moving.iter().any(|joint| {
            let own = learnt(bench, *joint, variable, left).unwrap_or_default();
            all += own;
            own.come_back(OF_A_JOINT)
        });
        of_one || all.come_back(OF_ALL)
    });
    !comes_back
}

/// What the dependence of a joint's residual on a variable predicts of the samples that no fit saw.
fn learnt(bench: &Bench<'_>, joint: usize, variable: Variable, left: &[f64]) -> Option<Squares> {
    let (mut seen, mut unseen) = (Vec::new(), Vec::new());
    for (_, row) in bench.layout.joints().filter(|(of, _)| *of == joint) {
        let values = along(bench, row, joint, variable)?;
        for (k, value) in row.range.clone().zip(values).filter(|(k, _)| bench.layout.compared[*k]) {
            if bench.layout.held[k] { unseen.push((value, left[k])) } else { seen.push((value, left[k])) }
        }
    }
    Some(predicted(seen, &unseen, bench.sigma_rad))
}

/// Means of bins with as many samples each, held against others.
fn predicted(mut seen: Vec<(f64, f64)>, unseen: &[(f64, f64)], sigma_rad: f64) -> Squares {
    seen.sort_by(|a, b| a.0.total_cmp(&b.0));
    let bins: Vec<&[(f64, f64)]> = seen.chunks(seen.len().div_ceil(BINS).max(1)).collect();
    let means: Vec<f64> =
        bins.iter().map(|bin| bin.iter().map(|(_, left)| left).sum::<f64>() / bin.len() as f64).collect();
    let mut squares = Squares::default();
    for (value, left) in unseen {
        let bin = bins.partition_point(|bin| bin[0].0 <= *value).saturating_sub(1);
        let mean = means.get(bin).copied().unwrap_or(0.0);
        squares +=
            Squares { predicted: left.powi(2) - (left - mean).powi(2), excess: left.powi(2) - sigma_rad.powi(2) };
    }
    squares
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swings(shift: f64, left: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        (0..400).map(|k| f64::from(k) * 0.1 + shift).map(|t| (t.sin(), left(t))).collect()
    }

    #[test]
    fn what_depends_on_the_angle_comes_back_and_what_does_not_depend_on_it_does_not() {
        let cogs = |t: f64| 1e-3 * (4.0 * t.sin()).sin();
        let of_angle = predicted(swings(0.0, cogs), &swings(0.3, cogs), 1e-5);
        assert!(of_angle.come_back(0.8), "{} of {}", of_angle.predicted, of_angle.excess);
        let hums = |t: f64| 1e-3 * (7.31 * t).sin();
        let of_time = predicted(swings(0.0, hums), &swings(0.3, hums), 1e-5);
        assert!(!of_time.come_back(0.1), "{} of {}", of_time.predicted, of_time.excess);
    }

    #[test]
    fn nothing_comes_back_where_nothing_is_left() {
        assert!(!predicted(Vec::new(), &[], 1e-3).come_back(0.1));
        assert!(!predicted(swings(0.0, |_| 1e-4), &swings(0.3, |_| 1e-4), 1e-3).come_back(0.1));
    }
}
