//! Other places from which sets of causes are grown, where the first set leaves much.
//!
//! A set grows by what helps most at each step. What imitates several causes at once then stays in their way, and causes of
//! which none helps before the others are there are not found at all. So sets begin elsewhere too: with all that servos
//! have, with motor side and link apart, with other first causes. The first that suffices ends it.

use super::explore::{explore_parting, one_of_each};
use super::grow::{Growth, Looked, MOST};
use super::score::better;
use super::trial::Trial;
use crate::fit::Budget;
use crate::joint::{EffectForm, EffectId};
use rayon::prelude::*;

/// What servos have.
const SERVO: [EffectId; 5] =
    [EffectId::Delay, EffectId::DeadBand, EffectId::SpeedLimit, EffectId::LoadFriction, EffectId::Stribeck];
/// Fewer of these are found one by one.
const SEVERAL: usize = 3;
/// The form of a cause that most have.
const MOSTLY: (EffectId, &str) = (EffectId::SpeedLimit, "voltage");
/// Evaluations with which all are fitted at once.
const TOGETHER: Budget = Budget { evaluations: 40 };
/// Other first causes, where a set has no more than so many: larger ones have passed by them.
const FIRSTS: usize = 3;
const SMALL: usize = 2;

/// Where sets begin.
type Way<'a> = &'a dyn Fn(&Trial) -> Vec<Trial>;

impl Growth<'_> {
    /// The best of a set and of those that begin elsewhere, until one suffices; `bare` has no causes, and `looked` is what was
    /// seen from it.
    pub fn begun_elsewhere(
        &self,
        bare: &Trial,
        looked: &Looked,
        mut best: Trial,
        suffices: impl Fn(&Trial) -> bool,
    ) -> Trial {
        let ways: [Way<'_>; 3] = [
            &|_| self.as_a_servo(bare, looked).into_iter().collect(),
            &|best| self.parted(bare, looked, best),
            &|best| self.other_firsts(looked, best),
        ];
        for begin in ways {
            if suffices(&best) || self.late("sets that begin with other causes") || self.progress.cancelled() {
                break;
            }
            let grown: Vec<Trial> = begin(&best).into_par_iter().map(|t| self.from(&t).0).collect();
            best = grown.into_iter().fold(best, |best, other| better(self.evidence, best, other));
        }
        best
    }

    /// All that servos have, fitted at once.
    fn as_a_servo(&self, bare: &Trial, looked: &Looked) -> Option<Trial> {
        self.evidence.reach.driven.filter(|driven| driven.by_setpoint)?;
        let sight = looked.sights.first()?;
        let points: Vec<_> = sight.best_of_each(1).filter(|point| SERVO.contains(&point.effect)).collect();
        if points.len() < SEVERAL {
            return None;
        }
        let (mostly, form) = MOSTLY;
        let mostly = EffectForm::named_so(mostly, Some(form)).expect("a form of the catalogue");
        let form = |effect: EffectId| if effect == mostly.id { mostly } else { effect.into() };
        let forms = points.iter().map(|point| form(point.effect));
        let model = forms.fold(bare.model.clone(), |model, form| model.with(form, &self.evidence.reach));
        let fitted = Trial::solved(self.evidence, model, &sight.with(&points), bare.found.starts.clone(), TOGETHER);
        Some(self.reshaped(fitted, 0))
    }

    /// Motor side and link apart, by themselves and beside a set: that is passed over for what is cheaper to try.
    fn parted(&self, bare: &Trial, looked: &Looked, best: &Trial) -> Vec<Trial> {
        let mut apart = explore_parting(self.evidence, bare, &looked.sights);
        if (1..MOST).contains(&best.effects().len()) && !best.model.has_two_bodies() {
            let mut others = self.others(best);
            others.retain(|effect| effect.parts_two_bodies());
            apart.extend(explore_parting(self.evidence, best, &self.sights(best, &others)));
        }
        one_of_each(apart)
    }

    /// Other single causes than those of a set, each in the form that suits it.
    fn other_firsts(&self, looked: &Looked, best: &Trial) -> Vec<Trial> {
        if best.effects().len() > SMALL {
            return Vec::new();
        }
        let others = looked.singles.iter().filter(|t| !best.effects().contains(&t.effects()[0]));
        let few: Vec<&Trial> = others.filter(|t| !t.model.has_two_bodies()).take(FIRSTS).collect();
        few.into_par_iter().map(|t| self.reshaped(t.clone(), 0)).collect()
    }
}
