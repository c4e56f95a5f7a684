//! The gap by log and phase: its share of the angle's error, and how large the residual torque is there.

use super::blocks::Blocks;
use super::log_part::LogPart;
use crate::gap::diagnosis::{MapCell, Phase};
use crate::number::chance::chi_squared_tail;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Resamplings of the blocks behind a band.
const RESAMPLINGS: usize = 200;
/// Of the cells that are called significant this share may be false, on average (Benjamini and Hochberg 1995).
const FALSE_DISCOVERIES: f64 = 0.05;

/// One cell for each log and phase that occurs in it, in the order of the logs.
pub(in crate::gap) fn map(parts: &[LogPart]) -> Vec<MapCell> {
    let mut cells = Vec::new();
    let mut p_values = Vec::new();
    for (i, part) in parts.iter().enumerate() {
        let blocks = Blocks::of(part);
        for (j, phase) in Phase::ALL.into_iter().enumerate() {
            let samples: Vec<usize> = (0..part.len()).filter(|k| part.torque.phase[*k] == phase).collect();
            if samples.is_empty() {
                continue;
            }
            let torque = Torque::of(part, &samples, blocks, (i * Phase::ALL.len() + j) as u64);
            p_values.push(torque.p_value);
            cells.push(MapCell {
                file: part.file.clone(),
                phase,
                time_s: samples.iter().map(|k| part.weights_s[*k]).sum(),
                share: samples.iter().map(|k| part.excess(*k)).sum::<f64>().max(0.0),
                torque_rms_nm: torque.rms_nm,
                band_nm: torque.band_nm,
                significant: false,
            });
        }
    }
    let gap: f64 = cells.iter().map(|c| c.share).sum();
    for (cell, found) in cells.iter_mut().zip(discoveries(&p_values)) {
        cell.share = if gap > 0.0 { cell.share / gap } else { 0.0 };
        cell.significant = found;
    }
    cells
}

/// The residual torque of one cell; zeros where there is no estimate of it.
struct Torque {
    rms_nm: f64,
    band_nm: [f64; 2],
    /// How likely noise alone would give as much; one where the band reaches down to what noise gives.
    p_value: f64,
}

impl Torque {
    fn of(part: &LogPart, samples: &[usize], blocks: Blocks, seed: u64) -> Self {
        let r = &part.torque;
        let known: Vec<usize> = samples.iter().copied().filter(|k| r.torque_nm[*k].is_finite()).collect();
        let time_s: f64 = known.iter().map(|k| part.weights_s[*k]).sum();
        if !(time_s > 0.0) {
            return Self { rms_nm: 0.0, band_nm: [0.0; 2], p_value: 1.0 };
        }
        // Running sums of time and energy, from which any block's are a difference.
        let (mut time, mut energy) = (vec![0.0], vec![0.0]);
        let (mut in_sigmas, mut noise) = (0.0, 0.0);
        for &k in &known {
            let (w, torque) = (part.weights_s[k], r.torque_nm[k]);
            time.push(time[time.len() - 1] + w);
            energy.push(energy[energy.len() - 1] + w * torque * torque);
            in_sigmas += w * (torque / r.sigma_nm[k].max(f64::MIN_POSITIVE)).powi(2) / time_s;
            noise += w * r.sigma_nm[k].powi(2) / time_s;
        }
        let n = known.len();
        let length = ((blocks.length_s / time_s * n as f64).round() as usize).clamp(1, n);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut squares: Vec<f64> = (0..RESAMPLINGS)
            .map(|_| {
                let (mut t, mut e) = (0.0, 0.0);
                for _ in 0..n.div_ceil(length) {
                    let from = rng.random_range(0..=n - length);
                    t += time[from + length] - time[from];
                    e += energy[from + length] - energy[from];
                }
                e / t
            })
            .collect();
        squares.sort_unstable_by(f64::total_cmp);
        let quantile = |p: f64| squares[(p * (RESAMPLINGS - 1) as f64).round() as usize].sqrt();
        // As many independent values as there are correlation times.
        let freedom = (time_s / (2.0 * blocks.correlation_s)).max(1.0);
        let by_chance = chi_squared_tail(freedom * in_sigmas, freedom);
        let band_nm = [quantile(0.025), quantile(0.975)];
        let p_value = if band_nm[0] > noise.sqrt() { by_chance } else { 1.0 };
        Self { rms_nm: (energy[n] / time_s).sqrt(), band_nm, p_value }
    }
}

/// Which of several p-values are discoveries at the given rate of false ones.
pub(in crate::gap) fn discoveries(p_values: &[f64]) -> Vec<bool> {
    let mut sorted = p_values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let passes = |(i, p): (usize, &f64)| *p <= FALSE_DISCOVERIES * (i + 1) as f64 / n;
    let threshold = sorted.iter().enumerate().rev().find(|x| passes(*x)).map(|(_, p)| *p);
    p_values.iter().map(|p| threshold.is_some_and(|t| *p <= t)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discoveries_follow_the_step_up_rule() {
        // Thresholds 0.01, 0.02, ... 0.05: the third passes at 0.03 and takes the second, at 0.025 > 0.02, along.
        assert_eq!(discoveries(&[0.9, 0.001, 0.028, 0.025, 0.5]), [false, true, true, true, false]);
        assert_eq!(discoveries(&[0.2, 0.06]), [false, false]);
        assert!(discoveries(&[]).is_empty());
    }
}
