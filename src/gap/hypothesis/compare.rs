//! Which of two hypotheses explains the logs better, with residuals that are not independent.
//!
//! The unit is the difference of squared residuals, sample by sample (Vuong 1989). Its spread is taken from blocks that
//! are longer than the residuals remember, so that a misfit which comes back in every half swing counts once.

use super::evidence::{Evidence, counts};
use super::trial::Trial;
use crate::identify::{self, Experiment};

/// Time over which differences are summed to one draw \[s\].
const BLOCK_S: f64 = 0.25;

/// A difference of two losses with its spread.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::gap) struct Difference {
    /// Loss of the first less loss of the second \[rad^2\].
    pub sum: f64,
    /// Standard deviation of that \[rad^2\].
    pub sd: f64,
}

impl Difference {
    /// The sum over blocks, with the spread that they show.
    pub fn of(blocks: &[f64]) -> Self {
        let n = blocks.len() as f64;
        let sum: f64 = blocks.iter().sum();
        let spread: f64 = blocks.iter().map(|b| (b - sum / n).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
        Self { sum, sd: (n * spread).sqrt() }
    }

    /// The same where blocks that follow one another may be alike for long, as they are along a whole predicted log: where a
    /// joint that sticks comes to rest decides all that follows. The spread is Newey and West's (1987), over lags up to
    /// the root of their number.
    pub fn of_a_whole(blocks: &[f64]) -> Self {
        let independent = Self::of(blocks);
        let n = blocks.len();
        let mean = independent.sum / n as f64;
        let lags = (n as f64).sqrt() as usize;
        let covariance = |lag: usize| -> f64 {
            blocks.iter().zip(&blocks[lag..]).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>()
        };
        let weight = |lag: usize| 1.0 - lag as f64 / (lags + 1) as f64;
        let alike: f64 = (1..=lags.min(n.saturating_sub(1))).map(|lag| weight(lag) * covariance(lag)).sum();
        Self { sd: (independent.sd.powi(2) + 2.0 * alike).max(independent.sd.powi(2)).sqrt(), ..independent }
    }

    /// How many standard deviations the first is worse.
    pub fn z(&self) -> f64 {
        if self.sd > 0.0 { self.sum / self.sd } else { 0.0 }
    }
}

/// Loss of `a` less loss of `b` over all logs.
pub(in crate::gap) fn difference(evidence: &Evidence, a: &Trial, b: &Trial) -> Difference {
    let fit = blocks(&evidence.fit, &a.fit, &b.fit);
    Difference::of(&fit.chain(blocks(&evidence.held, &a.held, &b.held)).collect::<Vec<f64>>())
}

/// Loss of residuals `a` less that of `b`, summed over blocks of each log.
pub(in crate::gap) fn blocks<'a>(
    experiments: &'a [Experiment],
    a: &'a [Vec<f64>],
    b: &'a [Vec<f64>],
) -> impl Iterator<Item = f64> + 'a {
    experiments.iter().zip(a).zip(b).flat_map(|((e, a), b)| {
        let lost: Vec<f64> = counts(e).zip(a.iter().zip(b)).map(|(c, (a, b))| c * (a * a - b * b)).collect();
        lost.chunks(block_samples(e)).map(|part| part.iter().sum::<f64>()).collect::<Vec<f64>>()
    })
}

/// Samples in a block.
pub(in crate::gap) fn block_samples(e: &Experiment) -> usize {
    let period_s = (e.t_s[e.t_s.len() - 1] - e.t_s[0]) / (e.t_s.len() - 1).max(1) as f64;
    ((BLOCK_S / period_s) as usize).clamp(4, 500)
}

/// How many successive residuals count as one, over all fitted logs of a trial.
pub(in crate::gap) fn correlation_length(evidence: &Evidence, trial: &Trial) -> f64 {
    identify::correlation_length(&evidence.fit, &trial.fit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stays_for_long_counts_as_few_draws() {
        // The same size in every block, by turns of one and of twenty blocks.
        let alternating = |length: usize| -> Vec<f64> {
            (0..400_usize).map(|k| if (k / length).is_multiple_of(2) { 3.0 } else { -1.0 }).collect()
        };
        let [short, long] = [1, 20].map(|length| Difference::of_a_whole(&alternating(length)));
        let independent = Difference::of(&alternating(20));
        assert_eq!((short.sum, long.sum), (400.0, 400.0));
        assert_eq!(short.sd, Difference::of(&alternating(1)).sd);
        assert!(long.sd > 2.5 * independent.sd, "{} against {}", long.sd, independent.sd);
    }
}
