//! Other places from which sets of causes are grown, where the first set leaves much.
//!
//! A set grows by what helps most at each step. What imitates several causes at once then stays in their way, and causes of
//! which none helps before the others are there are not found at all. So sets begin elsewhere too: with setpoints that
//! are held, with all that servos have, with motor side and link apart, with other first causes. The first that suffices ends it. One that leaves much
//! and has more causes than the first set is taken only where it leaves far less, and none where held-out logs are predicted
//! clearly worse.

use super::explore::{explore_parting, one_of_each, refitted};
use super::grow::{Growth, Looked, MOST};
use super::refuted::refutes_in_turn;
use crate::fit::Budget;
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::score::is_better;
use crate::gap::hypothesis::trial::Trial;
use crate::joint::{EffectForm, EffectId};
use rayon::prelude::*;

/// Periods for which setpoints may be held.
const HELD: std::ops::RangeInclusive<u32> = 2..=6;
/// What servos have.
const SERVO: [EffectId; 5] =
    [EffectId::Delay, EffectId::DeadBand, EffectId::SpeedLimit, EffectId::LoadFriction, EffectId::Stribeck];
/// Fewer of these are found one by one.
const SEVERAL: usize = 3;
/// The form of a cause that most have.
const MOSTLY: (EffectId, &str) = (EffectId::SpeedLimit, "voltage");
/// Evaluations with which all are fitted at once.
const TOGETHER: Budget = Budget { evaluations: 40 };
/// Other first causes that are tried.
const FIRSTS: usize = 3;
/// Most causes of a set beside which they are: larger ones have passed by them.
const SMALL: usize = 2;

/// Share of the first set's squares that another has to be below which has more causes and does not suffice: of many that are
/// tried one fits better by chance.
const FAR_LESS: f64 = 0.5;

/// All that servos have, and motor side and link apart by themselves, are grown where they leave so many times what a set leaves
/// at the most: from farther away none came near.
const WITHIN: f64 = 10.0;
/// Motor side and link apart are grown where beside a set they leave no more than this share of what it leaves: where they do
/// not help beside it, nothing else has helped beside them.
const LOWERS: f64 = 0.98;

/// Where sets begin.
type Way<'a> = &'a dyn Fn(&Trial) -> Vec<Trial>;

impl Growth<'_> {
    /// The best of a set and of those that begin elsewhere, until one suffices, and whether held-out logs refuted one; `bare`
    /// has no causes, `looked` is what was seen from it, and `whole` has all samples.
    pub fn begun_elsewhere(
        &self,
        whole: &Evidence,
        (bare, looked): (&Trial, &Looked),
        first: Trial,
        suffices: &dyn Fn(&Trial) -> bool,
    ) -> (Trial, bool) {
        let ways: [Way<'_>; 4] = [
            &|best| self.held(bare, best),
            &|best| self.as_a_servo(bare, looked, best).into_iter().collect(),
            &|best| self.parted(bare, looked, best),
            &|best| self.other_firsts(looked, best),
        ];
        let leaves_far_less = leaves_at_most(self.evidence, FAR_LESS, &first);
        let most = first.effects().len();
        let (mut best, mut one_was_refuted) = (first, false);
        for begin in ways {
            if suffices(&best) || self.late("sets that begin with other causes") || self.progress.cancelled() {
                break;
            }
            let grown: Vec<Trial> = begin(&best).into_par_iter().map(|t| self.from(&t).0).collect();
            for other in grown {
                let contends = other.effects().len() <= most || leaves_far_less(&other) || suffices(&other);
                if contends && is_better(self.evidence, &other, &best) {
                    if refutes_in_turn(self.evidence, whole, &other, &best) {
                        one_was_refuted = true;
                    } else {
                        best = other;
                    }
                }
            }
        }
        (best, one_was_refuted)
    }

    /// Setpoints held for a whole number of their periods, as buses do: where what is missing has bent the numbers, a scan to first
    /// order passes by them.
    fn held(&self, bare: &Trial, best: &Trial) -> Vec<Trial> {
        let driven = self.evidence.reach.driven.filter(|driven| driven.by_setpoint);
        let Some(driven) = driven.filter(|_| self.effects.contains(&EffectId::SetpointHold)) else { return Vec::new() };
        let values = |periods: u32| [&bare.found.values[..], &[f64::from(periods) * driven.period_s]].concat();
        let candidates = HELD.map(|periods| (vec![EffectId::SetpointHold.into()], values(periods)));
        let mut held = refitted(self.evidence, bare, candidates.collect(), f64::INFINITY);
        held.retain(leaves_at_most(self.evidence, WITHIN, best));
        held
    }

    /// All that servos have, fitted at once, where that comes near a set.
    fn as_a_servo(&self, bare: &Trial, looked: &Looked, best: &Trial) -> Option<Trial> {
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
        let fitted = self.reshaped(fitted, 0);
        leaves_at_most(self.evidence, WITHIN, best)(&fitted).then_some(fitted)
    }

    /// Motor side and link apart, which are passed over for what is cheaper to try: beside a set, and by themselves; where
    /// they can stand beside it, only if they lower what it leaves.
    fn parted(&self, bare: &Trial, looked: &Looked, best: &Trial) -> Vec<Trial> {
        let near = |times: f64| leaves_at_most(self.evidence, times, best);
        let alone = |times: f64| {
            let all = explore_parting(self.evidence, bare, &looked.sights);
            all.into_iter().filter(near(times)).collect::<Vec<Trial>>()
        };
        if best.effects().is_empty() {
            return alone(LOWERS);
        }
        if best.effects().len() >= MOST || best.model.has_two_bodies() {
            return alone(WITHIN);
        }
        let mut others = self.others(best);
        others.retain(|effect| effect.parts_two_bodies());
        let mut apart = explore_parting(self.evidence, best, &self.sights(best, &others));
        apart.retain(near(LOWERS));
        if !apart.is_empty() {
            apart.extend(alone(WITHIN));
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

/// Whether a hypothesis leaves so many times the squares at the most that another leaves.
fn leaves_at_most<'a>(evidence: &'a Evidence, times: f64, other: &Trial) -> impl Fn(&Trial) -> bool + use<'a> {
    let most = times * other.fit_loss(evidence);
    move |t| t.fit_loss(evidence) <= most
}
