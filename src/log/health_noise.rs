//! The noise of readings, from how rough they are: white noise is rough, a motion and a misfit are smooth.

use crate::number::extent;

/// Samples over which roughness is averaged to one value.
const BLOCK: usize = 24;
/// One in so many blocks is set aside at either end.
const TRIMMED: usize = 8;
/// Readings that change less often than this creep through steps; beyond, they flicker.
const FLICKERS: f64 = 0.2;

/// Standard deviation of the readings' noise, rounding included: fourth differences, whose variance is seventy times that
/// of white noise, leave nothing of a motion that is sampled well.
///
/// A joint at rest repeats one rounding error, which differences do not show: where readings flicker by whole steps, the
/// variance of rounding is added. The extreme blocks are set aside. Never below the rounding of a `step_rad`; 0 for a step
/// that is not known and fewer than five readings.
pub(super) fn reading_floor_rad(q_rad: &[f64], step_rad: f64) -> f64 {
    let fourth: Vec<f64> = q_rad.windows(5).map(|w| w[4] - 4.0 * w[3] + 6.0 * w[2] - 4.0 * w[1] + w[0]).collect();
    let rounding = step_rad * step_rad / 12.0;
    let variance = |(c, q): (&[f64], &[f64])| {
        let [low, high] = extent(q.iter().copied());
        let changes = q.windows(2).filter(|w| w[0] != w[1]).count() as f64 / q.len() as f64;
        with_rounding(mean_square(c) / 70.0, rounding, high - low < 2.5 * step_rad, changes)
    };
    pooled(whole_blocks(&fourth).zip(q_rad.chunks(BLOCK)).map(variance).collect(), rounding)
}

/// The variance of a block's noise. A joint that stands still, or creeps, repeats one rounding error, which roughness
/// does not show: where its readings flicker, rounding comes on top; where they hardly change, it is all there is.
fn with_rounding(roughness: f64, rounding: f64, stands: bool, changes: f64) -> f64 {
    match stands {
        true if changes > FLICKERS => roughness + rounding,
        true => rounding,
        false => roughness,
    }
}

/// Blocks of differences; a rest at the end is left out.
fn whole_blocks(differences: &[f64]) -> impl Iterator<Item = &[f64]> {
    let whole = if differences.len() < BLOCK { differences.len().max(1) } else { BLOCK };
    differences.chunks_exact(whole)
}

/// Standard deviation from the blocks' variances, without the extremes; never below the rounding.
fn pooled(mut variances: Vec<f64>, rounding: f64) -> f64 {
    variances.retain(|x| x.is_finite());
    variances.sort_unstable_by(f64::total_cmp);
    let aside = variances.len() / TRIMMED;
    let middle = &variances[aside..variances.len() - aside];
    let mean = middle.iter().sum::<f64>() / middle.len().max(1) as f64;
    mean.max(rounding).sqrt()
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// A decaying swing that ends at rest, at 5 ms.
    fn swing() -> Vec<f64> {
        let at = |t: f64| 1.2 * (-0.8 * t).exp() * (7.0 * t).cos();
        (0..1600).map(|k| at((k as f64 * 0.005).min(5.0))).collect()
    }

    /// Readings in steps with a flicker of one step either way, each with a probability.
    fn read(angles: &[f64], step: f64, flicker: f64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut noise = || match rng.random::<f64>() {
            u if u < flicker => step,
            u if u < 2.0 * flicker => -step,
            _ => 0.0,
        };
        angles.iter().map(|q| (q / step).round() * step + noise()).collect()
    }

    #[test]
    fn a_silent_encoder_has_the_noise_of_its_rounding_even_where_it_rests() {
        let angles = swing();
        for step in [0.0004, 0.0015, 0.006] {
            let readings = read(&angles, step, 0.0);
            let ratio = reading_floor_rad(&readings, step) / (step / 12f64.sqrt());
            assert!((0.999..1.06).contains(&ratio), "{step}: {ratio}");
            let ratio = reading_floor_rad(&readings[1100..], step) / (step / 12f64.sqrt());
            assert!((0.999..1.001).contains(&ratio), "{step} at rest: {ratio}");
        }
    }

    #[test]
    fn a_flicker_is_seen_in_motion_and_at_rest() {
        let angles = swing();
        for step in [0.0004, 0.006] {
            for flicker in [0.1, 1.0 / 3.0] {
                let readings = read(&angles, step, flicker);
                let truth = (step * step * (1.0 / 12.0 + 2.0 * flicker)).sqrt();
                for (name, part) in [("all", &readings[..]), ("moving", &readings[..700]), ("rest", &readings[1100..])]
                {
                    let ratio = reading_floor_rad(part, step) / truth;
                    // Of few samples, and where the readings rest: their rounding cannot be told.
                    let allowed = if name == "all" { 0.9..1.1 } else { 0.84..1.2 };
                    assert!(allowed.contains(&ratio), "{step} {flicker} {name}: {ratio}");
                }
            }
        }
    }

    #[test]
    fn a_continuous_encoder_and_too_few_readings() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let noise: Vec<f64> = (0..1600).map(|_| rng.random_range(-0.003..0.003)).collect();
        let readings: Vec<f64> = swing().iter().zip(&noise).map(|(q, n)| q + n).collect();
        let truth = 0.003 / 3f64.sqrt();
        assert!((reading_floor_rad(&readings, 0.0) / truth - 1.0).abs() < 0.06);
        assert_eq!((reading_floor_rad(&[1.0, 2.0], 0.0), reading_floor_rad(&[], 0.012)), (0.0, 0.012 / 12f64.sqrt()));
    }

    #[test]
    fn an_impact_does_not_count_as_noise() {
        let mut readings = read(&swing(), 0.0015, 0.0);
        for (k, r) in readings.iter_mut().enumerate().skip(400).take(30) {
            *r += if k % 2 == 0 { 0.05 } else { -0.05 };
        }
        assert!(reading_floor_rad(&readings, 0.0015) < 1.2 * 0.0015 / 12f64.sqrt());
    }
}
