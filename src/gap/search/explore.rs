//! Which further effects would explain more: a cheap look at many points, then real fits from the best of them.
//!
//! What is cheap is described in [`sight`](super::sight). Only the best points are refitted, and only the serious ones
//! of these to the end. An effect is never judged on frozen parameters.

use super::hold_fit::{held_setpoint, settled};
use super::kin::{Around, Written, is_kin, written_as};
use super::sight::Sight;
use crate::fit::Budget;
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::model::VISCOUS;
use crate::gap::hypothesis::trial::Trial;
use crate::identify::JointModel;
use crate::joint::{EffectForm, EffectId};
use rayon::prelude::*;

/// Points of each effect that are refitted briefly, and evaluations for each.
const BRIEF_POINTS: usize = 2;
const BRIEF: Budget = Budget { evaluations: 8 };
/// Effects that are refitted at all, by what they promise; and the same for a second effect.
const PROMISING: usize = 9;
const PROMISING_SECONDS: usize = 4;
/// Effects that part motor side and link cost many times as much: they are refitted among so many that promise most.
const AFFORDABLE: usize = 3;
/// Evaluations of the searches that are carried to the end.
const FULL: Budget = Budget { evaluations: 24 };
/// A brief fit is carried on where its criterion is below the best brief one times this, or it is among the best few.
const SERIOUS: f64 = 1.15;
const AT_LEAST: usize = 2;
/// The time of a held setpoint is settled where a brief fit at the time that was proposed is below the best brief one times
/// this.
const WORTH_SETTLING: f64 = 4.0;
/// What is left out where one of these is not fitted.
const LIKELY: &str = "fits of some likely causes";
/// What is compared with a hypothesis is carried on where a brief fit is below its criterion times this.
const COMPARABLE: f64 = 5.0;

/// The best fits of `base` with one of the effects added, one for each effect that promises something; best first.
pub(in crate::gap) fn explore(evidence: &Evidence, base: &Trial, sights: &[Sight]) -> Vec<Trial> {
    explored(evidence, base, sights, |_| false, f64::INFINITY)
}

/// The best fits of `base` with each of the effects added that part motor side and link, whatever they promise: of a joint that
/// rings to first order tells next to nothing.
pub(in crate::gap) fn explore_parting(evidence: &Evidence, base: &Trial, sights: &[Sight]) -> Vec<Trial> {
    let points = sights.iter().flat_map(|sight| sight.best_of_each(BRIEF_POINTS).map(|p| (p.effect, sight.with(&[p]))));
    let parting = points.filter(|(effect, _)| effect.parts_two_bodies());
    refitted(evidence, base, parting.map(|(effect, values)| (vec![effect.into()], values)).collect(), f64::INFINITY)
}

/// The best fits of `base` with one of `others` in the place of effect number `k` of `best`: what is easily taken for it is among
/// them, whatever it promises.
pub(in crate::gap) fn explore_rivals(
    evidence: &Evidence,
    base: &Trial,
    (sights, others): (&[Sight], &[EffectId]),
    (k, best): (usize, &Trial),
) -> Vec<Trial> {
    let member = best.effects()[k];
    let kin = |effect| is_kin(member, effect);
    let found = explored(evidence, base, sights, kin, COMPARABLE * best.criterion());
    // Kin are compared, so none of them may stop half way.
    let to_the_end = |t: Trial| match t.effects().last() {
        Some(effect) if kin(*effect) => t.continued(evidence, FULL),
        _ => t,
    };
    let found = found.into_par_iter().map(to_the_end);
    let written = others.par_iter().flat_map(|other| fitted_as(evidence, base, (k, best), *other));
    one_of_each(found.chain(written).collect())
}

/// `best` with its effect number `k` written as another in each way there is, and fitted on from there: where one does all
/// that another does, no search may end behind it. `base` is without the effect.
fn fitted_as(evidence: &Evidence, base: &Trial, (k, best): (usize, &Trial), other: EffectId) -> Vec<Trial> {
    let mut numbers = best.found.values.clone();
    let own: Vec<f64> = numbers.drain(best.model.place(k)).collect();
    let motor = evidence.fit.iter().find_map(|e| e.motor);
    let around = Around {
        reach: &evidence.reach,
        gravity_m_s2: evidence.fit.first().map_or(f64::NAN, |e| e.gravity_m_s2),
        more_viscous_nm_s_rad: numbers[VISCOUS] - evidence.nominal.viscous_nm_s_rad,
        kd_nm_s_rad: motor.map_or(0.0, |motor| motor.nm_per_answer() * motor.kd_nm_s_rad),
    };
    let fitted = |way: Written| {
        let mut values = numbers.clone();
        // What is held stays.
        let open = way.numbers.iter().filter(|(place, _)| !base.model.parameters()[*place].fixed);
        open.for_each(|(place, more)| values[*place] += more);
        values.extend(way.values);
        let model = base.model.with(way.form, &evidence.reach).in_unit(best.model.unit_rad2_s());
        Trial::solved(evidence, model, &values, best.found.starts.clone(), FULL)
    };
    written_as(best.effects()[k], &own, other, &around).into_par_iter().map(fitted).collect()
}

/// The best fits of `base` with one effect more, of those that promise most and those that are `wanted` anyway; what stays
/// above the criterion `hope` is not carried on.
fn explored(
    evidence: &Evidence,
    base: &Trial,
    sights: &[Sight],
    wanted: impl Fn(EffectId) -> bool,
    hope: f64,
) -> Vec<Trial> {
    let single = base.effects().is_empty();
    let (each, promising) = if single { (BRIEF_POINTS, PROMISING) } else { (1, PROMISING_SECONDS) };
    let mut points: Vec<(f64, EffectId, Vec<f64>)> = sights
        .iter()
        .flat_map(|sight| sight.best_of_each(each).map(|p| (p.promise, p.effect, sight.with(&[p]))))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut kept: Vec<EffectId> = Vec::new();
    for (_, effect, _) in &points {
        let affordable = kept.len() < AFFORDABLE || !effect.parts_two_bodies();
        if kept.len() < promising && affordable && !kept.contains(effect) {
            kept.push(*effect);
        }
    }
    points.retain(|(_, effect, _)| kept.contains(effect) || wanted(*effect));
    let candidates = points.into_iter().map(|(_, effect, values)| (vec![effect.into()], values)).collect();
    refitted(evidence, base, candidates, hope)
}

/// Effects in their forms, with values of all parameters from which to fit.
pub(in crate::gap) type Added = (Vec<EffectForm>, Vec<f64>);

/// `base` with effects added, fitted from the values given: all of them briefly, the serious ones to the end. The best
/// for each set of effects; best first. What stays above the criterion `hope` is not carried on.
pub(in crate::gap) fn refitted(evidence: &Evidence, base: &Trial, candidates: Vec<Added>, hope: f64) -> Vec<Trial> {
    let brief: Vec<(Trial, Option<usize>)> = candidates
        .into_par_iter()
        .filter(|_| !evidence.deadline.leaves_out(LIKELY))
        .map(|(effects, values)| {
            let model = effects.iter().fold(base.model.clone(), |model, &e| model.with(e, &evidence.reach));
            let at = held_setpoint(&model);
            let held = at.map_or_else(|| model.clone(), |at| model.clone().holding(&[at], &values));
            let fitted = Trial::solved(evidence, held, &values, base.found.starts.clone(), BRIEF);
            (Trial { model, ..fitted }, at)
        })
        .collect();
    let least = brief.iter().map(|(t, _)| t.criterion()).fold(f64::INFINITY, f64::min);
    let brief = brief.into_par_iter().map(|(t, at)| match at {
        Some(at) if t.criterion() < hope.min(WORTH_SETTLING * least) && !evidence.deadline.leaves_out(LIKELY) => {
            settled(evidence, t, at, BRIEF)
        }
        _ => t,
    });
    let best = one_of_each(brief.collect());
    let line = best.first().map_or(f64::INFINITY, |t| SERIOUS * t.criterion());
    let is_serious = |rank: usize, t: &Trial| {
        let likely = t.criterion() < hope && (rank < AT_LEAST || t.criterion() < line);
        likely && !evidence.deadline.leaves_out(LIKELY)
    };
    let done = best
        .into_par_iter()
        .enumerate()
        .map(|(rank, trial)| if is_serious(rank, &trial) { trial.continued(evidence, FULL) } else { trial });
    one_of_each(done.collect())
}

/// The best trial for each set of effects; best first.
pub(in crate::gap) fn one_of_each(trials: Vec<Trial>) -> Vec<Trial> {
    let mut best: Vec<Trial> = Vec::new();
    for trial in trials {
        let same = |t: &&mut Trial| t.effects().iter().all(|e| trial.effects().contains(e));
        match best.iter_mut().find(|t| t.effects().len() == trial.effects().len() && same(t)) {
            Some(known) if known.criterion() <= trial.criterion() => {}
            Some(known) => *known = trial,
            None => best.push(trial),
        }
    }
    best.sort_by(|a, b| a.criterion().total_cmp(&b.criterion()));
    best
}
