//! Causes that hold in some logs only.
//!
//! Every cause that was found is tried in one session (or log) alone and in all others; and what a single session leaves
//! is searched for causes that did not stand out over all logs. A restriction is kept where it explains the logs clearly
//! better for what it is charged, and predicts parts of them that were not fitted.

use super::explore::explore;
use super::grow::{Growth, MOST};
use super::sight::Sight;
use crate::fit::Budget;
use crate::gap::hypothesis::evidence::{Evidence, counts};
use crate::gap::hypothesis::folds::Folds;
use crate::gap::hypothesis::held_out::HeldOut;
use crate::gap::hypothesis::logs::{By, Group, Groups, LogSet};
use crate::gap::hypothesis::model::BASELINE;
use crate::gap::hypothesis::reach::reach_of;
use crate::gap::hypothesis::score::Measure;
use crate::gap::hypothesis::trial::{AGAIN, Trial, loss, predicted};
use crate::identify::JointModel;
use crate::joint::EffectId;
use rayon::prelude::*;
use std::sync::Arc;

/// Evaluations with which a fit is brought to rest.
const REST: Budget = Budget { evaluations: 60 };
/// Score by which a restriction has to be better.
const CLEARLY: f64 = 12.0;
/// Standard deviations by which a cause that is looked for in one group only has to predict better.
const PREDICTS: f64 = 2.0;
/// Logs miss a cause where they are explained worse by this factor without it.
const MISSED: f64 = 1.1;
/// A rest of so many times what noise leaves is worth a look at single groups.
const WORTH_A_LOOK: f64 = 1.25;
/// A cause of one group has to lower the square sum over all logs to less than this share: one that no second log can
/// confirm to less than where the study names sessions.
const LESS_OF_SESSIONS: f64 = 0.6;
const LESS_OF_LOGS: f64 = 0.1;
/// Causes of one group that are refitted on all logs.
const TRIED: usize = 2;

/// The hypothesis with its causes restricted to the logs in which they hold, and with causes of single groups added.
/// `chance` is the deviance that chance alone may gain.
pub(in crate::gap) fn within_logs(growth: &Growth<'_>, mut best: Trial, chance: f64) -> Trial {
    let Some(groups) = Groups::of(&growth.evidence.fit, &growth.evidence.held) else { return best };
    let late = || growth.evidence.deadline.leaves_out("causes that hold in some logs only");
    for k in (0..best.effects().len()).take_while(|_| !late()) {
        best = restricted(growth.evidence, best, k, &groups);
    }
    for group in groups.groups.iter().take_while(|_| !late()) {
        best = placed_anew(growth.evidence, best, group);
    }
    // What is less than one step of the encoder may be noise of any colour.
    let samples: f64 = growth.evidence.fit.iter().map(|e| counts(e).sum::<f64>()).sum();
    let enough = (WORTH_A_LOOK * growth.enough).max(samples * growth.evidence.reach.resolution_rad.powi(2));
    while best.effects().len() < MOST && best.fit_loss(growth.evidence) > enough && !late() {
        match added(growth, &best, &groups, chance) {
            // Brought to rest, so that what it has not yet reached is taken for no cause.
            Some(more) => best = growth.pruned(more.continued(growth.evidence, REST)).best,
            None => break,
        }
    }
    best
}

/// Cause number `k` in the logs of one group, or in all others, where that is clearly better.
fn restricted(evidence: &Evidence, best: Trial, k: usize, groups: &Groups) -> Trial {
    let missed: Vec<bool> = groups.groups.par_iter().map(|group| is_missed(evidence, &best, k, group)).collect();
    let missing = missed.iter().filter(|missed| **missed).count();
    let alone = |(i, group): (usize, &Group)| match (missed[i], missing) {
        (true, 1) => Some(group.inside.clone()),
        (false, _) if missing > 0 => Some(group.outside.clone()),
        _ => None,
    };
    let mut sets: Vec<LogSet> = groups.groups.iter().enumerate().filter_map(alone).collect();
    // Of two groups one is all others.
    sets.sort_by_key(|set| set.words.contains(" but "));
    let mut seen: Vec<Vec<String>> = Vec::new();
    sets.retain(|set| {
        let mut files = set.files.clone();
        files.sort_unstable();
        let is_new = !seen.contains(&files);
        seen.push(files);
        is_new
    });
    let tried = sets.into_par_iter().map(|set| {
        let model = best.model.clone().only_in(k, Arc::new(set));
        Trial::solved(evidence, model, &best.found.values, best.found.starts.clone(), AGAIN)
    });
    let tried: Vec<Trial> = tried.collect();
    let Some(other) = least(evidence, &best, tried) else { return best };
    let is_better = score(evidence, &best, &other) < score(evidence, &best, &best) - CLEARLY;
    if is_better && predicts(evidence, &other, &best) > 0.0 { other } else { best }
}

/// The same with a cause that holds in one group looked for again there: while it had to hold everywhere its search may
/// have ended in the wrong place.
fn placed_anew(evidence: &Evidence, best: Trial, group: &Group) -> Trial {
    let is_here = |only: &Option<Arc<LogSet>>| only.as_ref().is_some_and(|set| **set == group.inside);
    let Some(k) = best.model.only().iter().position(is_here) else { return best };
    let effect = best.effects()[k];
    let without = best.without(evidence, k, AGAIN);
    let found = of_group(evidence, &without, group, &[effect]);
    found.into_iter().fold(best, |best, t| if t.criterion() < best.criterion() { t } else { best })
}

/// Whether logs are explained clearly worse without cause number `k`, everything else as it is.
fn is_missed(evidence: &Evidence, best: &Trial, k: usize, group: &Group) -> bool {
    let bare = best.model.clone().only_in(k, Arc::new(group.outside.clone()));
    let (mut with, mut without) = (0.0, 0.0);
    for (i, e) in evidence.fit.iter().enumerate().filter(|(_, e)| group.inside.holds(e)) {
        with += loss(e, &best.fit[i]);
        without += loss(e, &predicted(&bare, e, &best.found.values, Some(best.found.starts[i])).1);
    }
    !(without < MISSED * with)
}

/// The best with one cause more, which holds in one group only, where that is clearly better than chance.
fn added(growth: &Growth<'_>, best: &Trial, groups: &Groups, chance: f64) -> Option<Trial> {
    let evidence = growth.evidence;
    let others: Vec<EffectId> = growth.effects.iter().copied().filter(|e| !best.effects().contains(e)).collect();
    let tried = groups.groups.iter().flat_map(|group| of_group(evidence, best, group, &others)).collect();
    let more = least(evidence, best, tried)?;
    let gained = score(evidence, &more, best) - score(evidence, &more, &more);
    let less = match groups.by {
        By::Session => LESS_OF_SESSIONS,
        By::Log => LESS_OF_LOGS,
    };
    let closes = more.fit_loss(evidence) < less * best.fit_loss(evidence);
    let stands_out = closes && gained > chance.max(0.0) + CLEARLY && predicts(evidence, &more, best) > PREDICTS;
    (stands_out && elsewhere(evidence, &more, best) > 0.0).then_some(more)
}

/// The best with each of the causes that stand out in one group beside numbers that the others give, fitted to all logs.
fn of_group(evidence: &Evidence, best: &Trial, group: &Group, effects: &[EffectId]) -> Vec<Trial> {
    let (own, others): (Vec<usize>, Vec<usize>) =
        (0..evidence.fit.len()).partition(|k| group.inside.holds(&evidence.fit[*k]));
    let only = |logs: &[usize]| evidence.with_logs(logs.iter().map(|&k| evidence.fit[k].clone()).collect(), Vec::new());
    let starts = |logs: &[usize]| logs.iter().map(|&k| best.found.starts[k]).collect::<Vec<_>>();
    // Numbers that all logs share have bent to what one group hides; those of its causes only it may know.
    let causes: Vec<usize> = (BASELINE..best.model.parameters().len()).collect();
    let model = best.model.clone().holding(&causes, &best.found.values);
    let elsewhere = Trial::solved(&only(&others), model, &best.found.values, starts(&others), AGAIN);
    let values = &elsewhere.found.values;
    // Short parts run from no log, and what bounds a motion bounds that of these logs.
    let whole = only(&own);
    let there = Evidence { reach: reach_of(&whole.fit, &evidence.nominal), ..whole.in_parts() };
    let all: Vec<usize> = (0..best.model.parameters().len()).collect();
    let held = best.model.clone().holding(&all, values);
    let anew: Vec<[f64; 2]> = there.fit.iter().map(|e| e.start_coordinates(&e.start)).collect();
    let mut base = Trial::solved(&there, held, values, anew.clone(), AGAIN);
    // Fitted starts hide what is missing; those that the readings show do not.
    base.found.starts = anew;
    let sights = Sight::from_each(&there, &base, &[], effects);
    let found = explore(&there, &base, &sights);
    let set = Arc::new(group.inside.clone());
    let everywhere = |t: &Trial| {
        let effect = *t.effects().last()?;
        let k = best.effects().len();
        let model = best.model.with(effect, &evidence.reach).only_in(k, Arc::clone(&set));
        let values = [&values[..], &t.found.values[values.len()..]].concat();
        let fitted = Trial::solved(evidence, model, &values, best.found.starts.clone(), AGAIN);
        Some(fitted.settled(evidence, AGAIN))
    };
    found.par_iter().take(TRIED).filter_map(everywhere).collect()
}

/// By how many standard deviations the logs in which a restricted cause of `a` does not hold are predicted better by fits
/// of `a` to the others than by those of `b`: what is explained where it is frees the numbers of its bias.
fn elsewhere(evidence: &Evidence, a: &Trial, b: &Trial) -> f64 {
    let logs = HeldOut::in_turn(evidence);
    let (mut with, without) = (logs.residuals(evidence, a), logs.residuals(evidence, b));
    let own = a.model.only().last().and_then(Option::as_ref);
    for (k, _) in evidence.fit.iter().enumerate().filter(|(_, e)| own.is_some_and(|set| set.holds(e))) {
        // No other log shows it: this one says nothing of how it predicts.
        with[k].clone_from(&without[k]);
    }
    logs.difference(&without, &with).z()
}

fn least(evidence: &Evidence, best: &Trial, tried: Vec<Trial>) -> Option<Trial> {
    let of = |t: &Trial| score(evidence, best, t);
    tried.into_iter().min_by(|a, b| of(a).total_cmp(&of(b)))
}

/// Score of a hypothesis, in the measure of another.
fn score(evidence: &Evidence, by: &Trial, trial: &Trial) -> f64 {
    Measure::by(evidence, by).score(evidence, trial)
}

/// By how many standard deviations parts of the logs are predicted better by `a` than by `b`.
pub(in crate::gap) fn predicts(evidence: &Evidence, a: &Trial, b: &Trial) -> f64 {
    let folds = Folds::of(evidence);
    folds.difference(&folds.residuals(b), &folds.residuals(a)).z()
}
