//! Whether the noise of readings hangs together over time, from where the joint stands still.

use crate::number::extent;
use std::ops::Range;

/// Lags that are looked at.
const LAGS: usize = 50;
/// A stretch is used from so many samples on, and all of them together have so many.
const STRETCH: usize = 64;
const FEWEST: usize = 256;

/// A joint has come to rest so long after its setpoint did, and is looked at for as long \[s\].
const SETTLES_S: f64 = 0.5;
/// Of the travel, what a joint at rest may move by.
const MOVES: f64 = 0.02;

/// Where the setpoint has not moved for a while and the reading stays: there a joint is at rest even where its readings
/// tremble.
pub(super) fn at_rest(t_s: &[f64], q_rad: &[f64], q_ref_rad: &[f64]) -> Vec<Range<usize>> {
    let range = |values: &[f64]| {
        let [low, high] = extent(values.iter().copied());
        (high - low).max(0.0)
    };
    let most_rad = MOVES * range(q_rad);
    let (mut stretches, mut from) = (Vec::new(), 0);
    for held in q_ref_rad[..q_ref_rad.len().min(q_rad.len())].chunk_by(|a, b| a == b) {
        let to = from + held.len();
        let settled = from + t_s[from..to].partition_point(|t| *t < t_s[from] + SETTLES_S);
        if settled + 1 < to && t_s[to - 1] - t_s[settled] >= SETTLES_S && range(&q_rad[settled..to]) <= most_rad {
            stretches.push(settled..to);
        }
        from = to;
    }
    stretches
}

/// Correlation of the noise with itself so many samples later, from 0 on (1 there); empty where the joint never stands
/// still for long, or its readings do not scatter there. A straight line is taken off each stretch.
pub(super) fn correlation(t_s: &[f64], q_rad: &[f64], still: &[Range<usize>], least_rad: f64) -> Vec<f64> {
    let (mut sums, mut counts, mut samples) = (vec![0.0; LAGS + 1], vec![0.0; LAGS + 1], 0);
    for stretch in still.iter().filter(|stretch| stretch.len() >= STRETCH) {
        let left = without_line(&t_s[stretch.clone()], &q_rad[stretch.clone()]);
        samples += left.len();
        for lag in 0..=LAGS.min(left.len() / 4) {
            sums[lag] += left.iter().zip(&left[lag..]).map(|(a, b)| a * b).sum::<f64>();
            counts[lag] += (left.len() - lag) as f64;
        }
    }
    let variance = sums[0] / f64::max(counts[0], 1.0);
    if samples < FEWEST || variance.sqrt() <= least_rad {
        return Vec::new();
    }
    let lags = counts.iter().position(|count| *count == 0.0).unwrap_or(counts.len());
    (0..lags).map(|lag| sums[lag] / counts[lag] / variance).collect()
}

/// How long the noise hangs together \[s\]: the area under its correlation up to the first lag at which there is none.
pub(super) fn lasts_s(correlation: &[f64], period_s: f64) -> f64 {
    let there = correlation.iter().skip(1).take_while(|value| **value > 0.0);
    period_s * there.map(|value| 2.0 * value).sum::<f64>()
}

/// Values less the straight line through them.
fn without_line(t_s: &[f64], q_rad: &[f64]) -> Vec<f64> {
    let n = t_s.len() as f64;
    let (t0, q0) = (t_s.iter().sum::<f64>() / n, q_rad.iter().sum::<f64>() / n);
    let (xx, xy) =
        t_s.iter().zip(q_rad).fold((0.0, 0.0), |(xx, xy), (t, q)| (xx + (t - t0).powi(2), xy + (t - t0) * (q - q0)));
    let slope = if xx > 0.0 { xy / xx } else { 0.0 };
    t_s.iter().zip(q_rad).map(|(t, q)| q - q0 - slope * (t - t0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn noise(memory: f64) -> (Vec<f64>, Vec<f64>) {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let mut last = 0.0;
        let mut next = || {
            last = memory * last + rng.random_range(-1e-3..1e-3);
            last
        };
        let t: Vec<f64> = (0..4000).map(|k| 0.002 * f64::from(k)).collect();
        let q = t.iter().map(|t| 0.1 * t + next()).collect();
        (t, q)
    }

    #[test]
    fn white_noise_does_not_hang_together_and_filtered_noise_does() {
        for (memory, lasts) in [(0.0, 0.0..0.0008), (0.8, 0.012..0.02)] {
            let (t, q) = noise(memory);
            let found = correlation(&t, &q, &[0..2000, 2000..4000], 1e-5);
            assert!((found[0] - 1.0).abs() < 1e-12 && (found[1] - memory).abs() < 0.08, "{memory}: {:?}", &found[..3]);
            let seen = lasts_s(&found, 0.002);
            assert!(lasts.contains(&seen), "{memory}: {seen} s");
        }
    }

    #[test]
    fn a_joint_is_at_rest_some_time_after_its_setpoint() {
        let t: Vec<f64> = (0..300).map(|k| 0.01 * f64::from(k)).collect();
        let asked: Vec<f64> = t.iter().map(|t| t.min(1.0)).collect();
        let found = at_rest(&t, &asked, &asked);
        assert_eq!((found.len(), found[0].clone()), (1, 150..300));
        let moving: Vec<f64> = t.iter().map(|t| t.sin()).collect();
        assert!(at_rest(&t, &moving, &asked).is_empty());
        assert!(at_rest(&t, &moving, &[]).is_empty());
    }

    #[test]
    fn readings_that_do_not_scatter_or_stand_too_shortly_say_nothing() {
        let (t, q) = noise(0.5);
        assert!(correlation(&t, &q, &[0..60, 100..200], 1e-5).is_empty());
        assert!(correlation(&t, &vec![0.25; 4000], &[0..2000, 2000..4000], 1e-5).is_empty());
    }
}
