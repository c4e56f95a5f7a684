//! Stated probabilities against what came true.

use super::rate::Rate;
use crate::number::math;
use serde::Serialize;

/// Answers whose stated probability lies in a range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bin {
    /// Range of the stated probability, the upper end excluded but for 1.
    pub range: [f64; 2],
    /// Mean of the stated probabilities.
    pub stated: Option<f64>,
    /// How many answers were right.
    pub right: Rate,
}

/// How good stated probabilities are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stated {
    /// Mean of `ln p` for right answers and `ln(1 - p)` for wrong ones, `p` kept between 0.001 and 0.999; 0 is best.
    pub log_score: Option<f64>,
    /// Mean of `(p - 1)^2` for right answers and `p^2` for wrong ones; 0 is best.
    pub brier: Option<f64>,
    /// Mean stated probability less the share of right answers: above zero is too sure.
    pub excess: Option<f64>,
    /// The table.
    pub bins: Vec<Bin>,
}

/// Edges of the table.
const EDGES: [f64; 8] = [0.0, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 1.0];
/// No probability counts as surer than this.
const SUREST: f64 = 0.999;

impl Stated {
    /// Scores stated probabilities, each with whether the answer was right.
    pub fn of(answers: &[(f64, bool)]) -> Self {
        let count = answers.len() as f64;
        let mean = |value: &dyn Fn(f64, bool) -> f64| {
            (!answers.is_empty()).then(|| answers.iter().map(|(p, right)| value(*p, *right)).sum::<f64>() / count)
        };
        let bins = EDGES
            .windows(2)
            .map(|edge| {
                let range = [edge[0], edge[1]];
                let within = |p: f64| p >= range[0] && (p < range[1] || (range[1] == 1.0 && p <= 1.0));
                let here: Vec<&(f64, bool)> = answers.iter().filter(|(p, _)| within(*p)).collect();
                let stated = (!here.is_empty()).then(|| here.iter().map(|(p, _)| p).sum::<f64>() / here.len() as f64);
                Bin { range, stated, right: Rate::over(here.iter().map(|(_, right)| *right)) }
            })
            .collect();
        Self {
            log_score: mean(&|p, right| {
                let p = p.clamp(1.0 - SUREST, SUREST);
                if right { math::ln(p) } else { math::ln(1.0 - p) }
            }),
            brier: mean(&|p, right| (p - f64::from(u8::from(right))).powi(2)),
            excess: mean(&|p, right| p - f64::from(u8::from(right))),
            bins,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn scores_by_hand() {
        let stated = Stated::of(&[(0.8, true), (0.6, false), (1.0, true)]);
        assert_relative_eq!(stated.brier.unwrap(), (0.04 + 0.36 + 0.0) / 3.0, epsilon = 1e-12);
        let log = (0.8_f64.ln() + 0.4_f64.ln() + 0.999_f64.ln()) / 3.0;
        assert_relative_eq!(stated.log_score.unwrap(), log, epsilon = 1e-12);
        assert_relative_eq!(stated.excess.unwrap(), 2.4 / 3.0 - 2.0 / 3.0, epsilon = 1e-12);
        let counts: Vec<(u32, u32)> = stated.bins.iter().map(|bin| (bin.right.hits, bin.right.of)).collect();
        assert_eq!(counts, [(0, 0), (0, 0), (0, 1), (0, 0), (1, 1), (0, 0), (1, 1)]);
        assert_eq!(Stated::of(&[]).brier, None);
    }
}
