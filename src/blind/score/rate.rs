//! Rates with intervals.

use crate::number::chance::beta_quantile;
use serde::Serialize;

/// So many of so many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Rate {
    /// How many.
    pub hits: u32,
    /// Of how many.
    pub of: u32,
    /// Their share; `None` of none.
    pub share: Option<f64>,
    /// 95 % interval of the share after Clopper and Pearson (1934): never too narrow.
    pub interval: [f64; 2],
}

impl Rate {
    /// So many of so many.
    pub fn new(hits: u32, of: u32) -> Self {
        let hits = hits.min(of);
        let share = (of > 0).then(|| f64::from(hits) / f64::from(of));
        Self { hits, of, share, interval: [lower(hits, of, 0.025), 1.0 - lower(of - hits, of, 0.025)] }
    }

    /// How many of the items a property holds for.
    pub fn over(items: impl IntoIterator<Item = bool>) -> Self {
        let (mut hits, mut of) = (0, 0);
        for item in items {
            hits += u32::from(item);
            of += 1;
        }
        Self::new(hits, of)
    }

    /// 95 % upper bound of the share (one-sided); 1 where nothing was seen.
    pub fn upper_bound(&self) -> f64 {
        1.0 - lower(self.of - self.hits, self.of, 0.05)
    }
}

/// The share of which so many or more would be seen with a probability of `tail`.
fn lower(hits: u32, of: u32, tail: f64) -> f64 {
    if hits == 0 {
        return 0.0;
    }
    beta_quantile(tail, f64::from(hits), f64::from(of - hits) + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn intervals_are_those_of_the_tables() {
        // Clopper and Pearson for 5 of 10: 0.1871 to 0.8129
        let rate = Rate::new(5, 10);
        assert_relative_eq!(rate.interval[0], 0.1871, epsilon = 1e-4);
        assert_relative_eq!(rate.interval[1], 0.8129, epsilon = 1e-4);
        // none of n: the upper bound is 1 - 0.05^(1/n)
        assert_relative_eq!(Rate::new(0, 100).upper_bound(), 1.0 - 0.05_f64.powf(0.01), epsilon = 1e-6);
        assert_eq!(Rate::new(0, 0).interval, [0.0, 1.0]);
        assert_eq!((Rate::new(0, 0).share, Rate::new(7, 7).interval[1]), (None, 1.0));
        assert_eq!(Rate::over([true, false, true]), Rate::new(2, 3));
    }
}
