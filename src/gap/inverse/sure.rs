//! How sure an answer is: how often redraws of the held-out seconds give the same one.

use super::search::{COMES, Choice, Found, LEAST};
use super::system::saved;
use crate::gap::Verdict;
use crate::joint::EffectId;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Redraws.
const REDRAWS: usize = 400;

/// Shares of redraws, given all causes behind the first.
#[derive(Clone, Debug)]
pub(super) struct Redraws {
    /// In which each family predicts best.
    pub first: Vec<(EffectId, f64)>,
    /// In which none helps.
    pub none: f64,
}

impl Redraws {
    pub fn new(found: &Found) -> Self {
        let families = &found.design.families;
        let squares = |choice: &Choice| found.system.held_out(&choice.columns(&found.design));
        let choice = Choice { curve: None, ..found.choice() };
        let others = choice.causes.first().map_or_else(Choice::default, |first| choice.without(*first));
        let without = squares(&others);
        let is_open = |effect: EffectId| others.causes.iter().all(|c| families[*c].effect != effect);
        let rivals: Vec<(EffectId, Vec<f64>)> = families
            .iter()
            .enumerate()
            .filter(|(_, family)| is_open(family.effect))
            .map(|(k, family)| (family.effect, squares(&others.with(k))))
            .collect();
        let mut dice = ChaCha8Rng::seed_from_u64(0);
        let mut first: Vec<(EffectId, f64)> = Vec::new();
        let mut none = 0.0;
        let one = 1.0 / REDRAWS as f64;
        for _ in 0..REDRAWS {
            let drawn: Vec<usize> = without.iter().map(|_| dice.random_range(0..without.len())).collect();
            let redrawn = |squares: &[f64]| drawn.iter().map(|k| squares[*k]).collect::<Vec<f64>>();
            let before = redrawn(&without);
            let nothing: f64 = before.iter().sum();
            let saves = |(effect, squares): &(EffectId, Vec<f64>)| {
                let (gain, sds) = saved(&before, &redrawn(squares));
                (sds >= COMES && gain > LEAST * nothing).then_some((*effect, gain))
            };
            match rivals.iter().filter_map(saves).max_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((effect, _)) => match first.iter_mut().find(|(known, _)| *known == effect) {
                    Some((_, share)) => *share += one,
                    None => first.push((effect, one)),
                },
                None => none += one,
            }
        }
        Self { first, none }
    }

    /// Of a family.
    pub fn of(&self, effect: EffectId) -> f64 {
        self.first.iter().find(|(known, _)| *known == effect).map_or(0.0, |(_, share)| *share)
    }

    /// Of an answer, and what that means.
    pub fn of_answer(&self, verdict: Verdict, first: Option<EffectId>) -> (f64, String) {
        let share = match verdict {
            Verdict::Effect | Verdict::Unexplained => first.map_or(self.none, |effect| self.of(effect)),
            Verdict::None | Verdict::Calibration => self.none,
        };
        let source = format!(
            "the share of {REDRAWS} redraws of the held-out seconds that put the same cause, or none, first; measured on \
             this study, not in a trial"
        );
        (share.min(1.0), source)
    }
}
