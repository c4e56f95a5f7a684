//! What chance alone would gain: the study's own null.
//!
//! The noise of a study is what its best explanation leaves. Blocks of it that are longer than it hangs together, with
//! signs drawn at random (the wild bootstrap, Wu 1986), are noise of the same size, colour and place. What the effects of
//! the catalogue gain on such noise, to first order and after what the numbers take up, is the threshold.

use super::sight::{LARGEST, Sight};
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::score::Measure;
use crate::gap::hypothesis::trial::Trial;
use crate::number::math;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Draws of noise, and how many of them may exceed the threshold.
const DRAWS: usize = 199;
const BEYOND: usize = 1;
/// A block is this many correlation lengths long.
const BLOCK: f64 = 3.0;

/// Deviance that the best effect gains on noise alone, exceeded in one draw of two hundred.
pub(in crate::gap) fn threshold(evidence: &Evidence, sights: &[Sight], noise: &Trial) -> f64 {
    let Some(sight) = sights.first() else { return 0.0 };
    let measure = Measure::by(evidence, noise);
    let rows = sight.folded_residual(evidence, noise);
    let energy: f64 = rows.iter().map(|r| r * r).sum();
    let samples: usize = evidence.fit.iter().map(|e| e.compared()).sum();
    let correlation = samples as f64 / measure.effective * rows.len() as f64 / samples.max(1) as f64;
    let block = ((BLOCK * correlation).ceil() as usize).clamp(1, (rows.len() / 8).max(1));
    let columns: Vec<(&[f64], f64)> = sights
        .iter()
        .flat_map(|s| &s.points)
        .map(|p| (&p.moved[..rows.len().min(p.moved.len())], p.moved.iter().map(|m| m * m).sum::<f64>()))
        .filter(|(moved, norm)| norm.is_finite() && *norm > 0.0 && moved.len() == rows.len())
        .collect();
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut gains: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let mut drawn = rows.clone();
            let offset = random.random_range(0..block);
            let mut sign = 1.0;
            for (i, r) in drawn.iter_mut().enumerate() {
                if (i + offset) % block == 0 {
                    sign = if random.random::<bool>() { 1.0 } else { -1.0 };
                }
                *r *= sign;
            }
            let gain = |(moved, norm): &(&[f64], f64)| {
                let slope: f64 = -moved.iter().zip(&drawn).map(|(m, r)| m * r).sum::<f64>();
                let size = (slope / norm).clamp(0.0, LARGEST);
                2.0 * size * slope - size * size * norm
            };
            let most = columns.iter().map(gain).fold(0.0, f64::max);
            -measure.effective * math::ln(1.0 - (most / energy).min(0.999))
        })
        .collect();
    gains.sort_by(f64::total_cmp);
    gains[DRAWS - 1 - BEYOND]
}
