//! A torque explained by its mean over a variable, in bins.
//!
//! A mean is judged on samples that it was not taken from: odd blocks are explained by the means of even ones and the
//! other way round. Blocks are longer than the torque's own correlation, so that noise explains nothing.

use crate::gap::diagnosis::ProfileBin;
use crate::number::chance::HALF_95;
use crate::number::math;

/// Bins of equal numbers of samples.
const BINS: usize = 10;
/// The range holds at least this share of what the variable explains.
const MOST: f64 = 0.6;
/// Samples from which the bins' edges are taken, about.
const EDGE_SAMPLES: usize = 1000;
/// Fewest blocks from which anything is said.
const FEWEST_BLOCKS: usize = 6;

/// One sample of the residual torque.
pub(in crate::gap) struct Sample {
    pub torque_nm: f64,
    /// The same but for a spike.
    pub clipped_nm: f64,
    pub sigma_nm: f64,
    pub weight: f64,
    /// Counted over all logs.
    pub block: usize,
    /// Which half of the blocks.
    pub odd: bool,
}

/// The torque in bins of a variable.
#[derive(Clone, Debug)]
pub(in crate::gap) struct Binned {
    /// Share of the torque's energy that the means explain.
    pub share: f64,
    bins: Vec<Bin>,
    /// Energy of the torque.
    energy: f64,
}

#[derive(Clone, Copy, Debug)]
struct Bin {
    low: f64,
    high: f64,
    /// Mean of the variable.
    at: f64,
    /// Mean torque in the form's sign, and its standard deviation.
    mean_nm: f64,
    sd_nm: f64,
    /// Energy in the bin, and how much of it the mean of other samples explains.
    energy: f64,
    explained: f64,
}

/// Explains samples by a variable: `looked` holds its value at each, and the sign with which the torque enters; where
/// that is zero the variable says nothing.
pub(in crate::gap) fn explain(samples: &[Sample], looked: &[(f64, f64)]) -> Binned {
    let energy: f64 = samples.iter().map(|s| s.weight * s.clipped_nm * s.clipped_nm).sum();
    let nothing = Binned { share: 0.0, bins: Vec::new(), energy };
    let upper = upper_edges(looked);
    let blocks = samples.chunk_by(|a, b| a.block == b.block).count();
    if upper.is_empty() || blocks < FEWEST_BLOCKS || !(energy > 0.0) {
        return nothing;
    }
    let bin_of = |x: f64| upper.partition_point(|u| *u < x).min(upper.len() - 1);
    let counted =
        || samples.iter().zip(looked).filter(|(_, (_, c))| *c != 0.0).map(|(s, &(x, c))| (s, bin_of(x), x, c));
    let mut sums = vec![Sums::default(); upper.len()];
    for (s, bin, x, c) in counted() {
        sums[bin].add(s, x, c);
    }
    let mut spreads = vec![Spread::default(); upper.len()];
    for (s, bin, _, c) in counted() {
        spreads[bin].add(s, c, &sums[bin]);
    }
    let bins: Vec<Bin> = sums.iter().zip(&spreads).map(|(sums, spread)| spread.bin(sums)).collect();
    let explained: f64 = bins.iter().map(|b| b.explained).sum();
    Binned { share: (explained / energy).clamp(0.0, 1.0), bins, energy }
}

/// Sums over a bin.
#[derive(Clone, Copy, Debug)]
struct Sums {
    low: f64,
    high: f64,
    weight: f64,
    value: f64,
    torque: f64,
    sigma: f64,
    /// Of even and of odd blocks: clipped torque, and weight.
    halves: [[f64; 2]; 2],
}

impl Default for Sums {
    fn default() -> Self {
        let empty = [[0.0; 2]; 2];
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { low, high, weight: 0.0, value: 0.0, torque: 0.0, sigma: 0.0, halves: empty }
    }
}

impl Sums {
    fn add(&mut self, s: &Sample, x: f64, c: f64) {
        (self.low, self.high) = (self.low.min(x), self.high.max(x));
        self.weight += s.weight;
        self.value += s.weight * x;
        self.torque += s.weight * c * s.torque_nm;
        self.sigma += s.weight * s.sigma_nm;
        let half = &mut self.halves[usize::from(s.odd)];
        half[0] += s.weight * c * s.clipped_nm;
        half[1] += s.weight;
    }

    fn mean_nm(&self) -> f64 {
        self.torque / self.weight
    }

    /// Mean of the blocks to which a sample does not belong; zero without any.
    fn mean_of_others(&self, odd: bool) -> f64 {
        let [torque, weight] = self.halves[usize::from(!odd)];
        if weight > 0.0 { torque / weight } else { 0.0 }
    }
}

/// What is left about a bin's mean. Deviations add up inside a block and count as one there.
#[derive(Clone, Copy, Debug, Default)]
struct Spread {
    energy: f64,
    explained: f64,
    block: usize,
    in_block: f64,
    squares: f64,
    blocks: usize,
}

impl Spread {
    fn add(&mut self, s: &Sample, c: f64, sums: &Sums) {
        let square = s.clipped_nm * s.clipped_nm;
        self.energy += s.weight * square;
        self.explained += s.weight * (square - (s.clipped_nm - c * sums.mean_of_others(s.odd)).powi(2));
        if self.blocks == 0 || self.block != s.block {
            self.squares += self.in_block * self.in_block;
            self.in_block = 0.0;
            self.block = s.block;
            self.blocks += 1;
        }
        self.in_block += s.weight * (c * s.torque_nm - sums.mean_nm());
    }

    fn bin(&self, sums: &Sums) -> Bin {
        let blocks = self.blocks as f64;
        let squares = self.squares + self.in_block * self.in_block;
        // Of one block nothing is known but its size.
        let variance = if self.blocks > 1 { squares * blocks / (blocks - 1.0) } else { self.energy * sums.weight };
        Bin {
            low: sums.low,
            high: sums.high,
            at: sums.value / sums.weight,
            mean_nm: sums.mean_nm(),
            // What the smoother may have bent is the same in all blocks.
            sd_nm: math::hypot(variance.sqrt(), sums.sigma) / sums.weight,
            energy: self.energy,
            explained: self.explained,
        }
    }
}

/// Upper edges of bins with about the same number of samples each; equal values share a bin.
fn upper_edges(looked: &[(f64, f64)]) -> Vec<f64> {
    let every = (looked.len() / EDGE_SAMPLES).max(1);
    let mut values: Vec<f64> = looked.iter().filter(|(_, c)| *c != 0.0).step_by(every).map(|(x, _)| *x).collect();
    values.sort_unstable_by(f64::total_cmp);
    let Some(last) = values.len().checked_sub(1) else { return Vec::new() };
    let mut upper: Vec<f64> = (1..=BINS).map(|i| values[i * last / BINS]).collect();
    upper.dedup();
    upper
}

impl Binned {
    /// First and last of the fewest neighbouring bins that hold most of what is explained.
    fn span(&self) -> Option<[usize; 2]> {
        let gains: Vec<f64> = self.bins.iter().map(|b| b.explained.max(0.0)).collect();
        let needed = MOST * gains.iter().sum::<f64>();
        let n = gains.len();
        for width in 1..=n {
            let sum = |from: usize| gains[from..from + width].iter().sum::<f64>();
            let best = (0..=n - width).map(|from| (sum(from), from)).max_by(|a, b| a.0.total_cmp(&b.0))?;
            if best.0 >= needed && needed > 0.0 {
                return Some([best.1, best.1 + width - 1]);
            }
        }
        None
    }

    /// Between which values most of what is explained lies, in the variable's unit.
    pub(in crate::gap) fn range(&self) -> Option<[f64; 2]> {
        self.span().map(|[first, last]| [self.bins[first].low, self.bins[last].high])
    }

    /// Share of the residual torque's energy that lies there.
    pub(in crate::gap) fn energy_in_range(&self) -> f64 {
        let inside = |[first, last]: [usize; 2]| self.bins[first..=last].iter().map(|b| b.energy).sum::<f64>();
        self.span().map_or(0.0, |span| (inside(span) / self.energy).min(1.0))
    }

    /// Share of it in the bins whose middle lies between two values of the variable.
    pub(in crate::gap) fn energy_within(&self, [low, high]: [f64; 2]) -> f64 {
        let inside: f64 = self.bins.iter().filter(|b| (low..=high).contains(&b.at)).map(|b| b.energy).sum();
        if self.energy > 0.0 { (inside / self.energy).min(1.0) } else { 0.0 }
    }

    /// The mean torque over the variable, with 95 % bands.
    pub(in crate::gap) fn profile(&self) -> Vec<ProfileBin> {
        let bin = |b: &Bin| ProfileBin {
            at: b.at,
            torque_nm: b.mean_nm,
            band_nm: [b.mean_nm - HALF_95 * b.sd_nm, b.mean_nm + HALF_95 * b.sd_nm],
        };
        self.bins.iter().map(bin).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Samples of a torque, in blocks of 40.
    fn samples(torque: impl Iterator<Item = f64>) -> Vec<Sample> {
        let sample = |(k, torque_nm): (usize, f64)| {
            let block = k / 40;
            let odd = block % 2 == 1;
            Sample { torque_nm, clipped_nm: torque_nm, sigma_nm: 0.0, weight: 1.0, block, odd }
        };
        torque.enumerate().map(sample).collect()
    }

    /// Noise with a correlation of some ten samples.
    fn noise(n: usize, seed: u64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut x = 0.0;
        let mut next = || {
            x = 0.9 * x + rng.random_range(-1.0..1.0);
            x
        };
        (0..n).map(|_| next()).collect()
    }

    #[test]
    fn noise_explains_nothing_however_smooth_it_is() {
        for seed in 0..20 {
            // The variable is as slow as the noise itself, where chance would explain most.
            let torque = noise(2000, seed);
            let slow: Vec<(f64, f64)> = (0..2000).map(|k| ((k as f64 * 0.02).sin(), 1.0)).collect();
            let share = explain(&samples(torque.into_iter()), &slow).share;
            assert!(share < 0.08, "seed {seed}: {share}");
        }
    }

    #[test]
    fn a_dependence_is_explained_and_its_range_is_where_it_acts() {
        let x = |k: usize| (k as f64 * 0.37).sin();
        let torque = noise(2000, 1).into_iter().enumerate().map(|(k, n)| 0.05 * n + if x(k) > 0.8 { 1.0 } else { 0.0 });
        let looked: Vec<(f64, f64)> = (0..2000).map(|k| (x(k), 1.0)).collect();
        let binned = explain(&samples(torque), &looked);
        assert!(binned.share > 0.8, "{}", binned.share);
        let [low, high] = binned.range().unwrap();
        assert!(low > 0.7 && high > 0.99, "{low} {high}");
        assert_eq!(binned.energy_within([low, high]), binned.energy_in_range());
        assert_eq!(binned.energy_within([1.5, 2.0]), 0.0);
        let profile = binned.profile();
        assert!(profile[0].band_nm[0] < 0.0 && profile[0].band_nm[1] > 0.0 && profile[0].band_nm[1] < 0.1);
        assert!(profile[9].band_nm[0] < 1.0 && profile[9].band_nm[1] > 1.0);
    }

    #[test]
    fn where_a_variable_says_nothing_or_is_always_the_same_a_mean_is_all() {
        let torque = || (0..400).map(|k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 });
        let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let same: Vec<(f64, f64)> = (0..400).map(|k| (5.0, sign(k))).collect();
        let binned = explain(&samples(torque()), &same);
        assert_eq!((binned.share, binned.range(), binned.profile().len()), (1.0, Some([5.0, 5.0]), 1));
        let silent: Vec<(f64, f64)> = (0..400).map(|_| (5.0, 0.0)).collect();
        let binned = explain(&samples(torque()), &silent);
        assert_eq!((binned.share, binned.range(), binned.profile().len()), (0.0, None, 0));
    }
}
