//! What is uncertain in the numbers beside noise: what other logs would have said, and effects that nobody named.
//!
//! Numbers are those of one hypothesis. An effect too small to be shown, or one whose formula is not quite the catalogue's, is in
//! the numbers all the same, and no residual tells how far it has moved them. So every effect is put beside the hypothesis
//! in turn, in all its forms, at the size that the residuals suggest for it: to first order that moves the numbers by what they
//! took up in its place. An effect of the hypothesis is refitted in its other forms. Over those of these that explain the logs as
//! well as the best, after the charge for their parameters, the squares of the shifts are averaged (model averaging, Burnham and
//! Anderson 2002).
//!
//! What differs between logs shows in how differently each of them pulls the numbers.

use super::projector::Projector;
use super::sight::{LARGEST, weighted};
use crate::fit::Residuals;
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::score::{EQUAL_DEVIANCE, Measure};
use crate::gap::hypothesis::trial::{AGAIN, Trial};
use crate::identify::{Found, JointModel, Problem};
use crate::joint::{EffectForm, EffectId};
use crate::number::math;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Starting points of each form that are looked at where other joints carry this one: along their motion each costs more.
const SOME_STARTS: usize = 6;
/// Deviance that a parameter is charged (Akaike 1974).
const PER_PARAMETER: f64 = 2.0;
/// Logs of which fewer tell nothing of a spread.
const FEWEST: usize = 3;

/// What residuals suggest of an effect of which a starting point is known.
struct Suggested {
    /// In sizes of the starting point.
    size: f64,
    /// Variance of that.
    spread: f64,
    /// How much better it explains the logs.
    deviance: f64,
}

impl Suggested {
    /// By the least of the parabola along which the effect changes the square sum `energy`, so many residuals of which count;
    /// `None` where it changes nothing, such as a stop that the joint does not reach.
    fn by(slope: f64, change: f64, energy: f64, effective: f64) -> Option<Self> {
        if !(change > 0.0) {
            return None;
        }
        let size = (-slope / change).clamp(0.0, LARGEST);
        let gained = -(2.0 * size * slope + size * size * change) / energy;
        let deviance = -effective * math::ln(1.0 - gained.min(0.999));
        Some(Self { size, spread: energy / effective / change, deviance })
    }
}

/// A hypothesis that was not chosen: how far it moves the chosen one's coordinates, and how much better it explains the logs, in
/// deviance after its charge.
struct Other {
    shift: DVector<f64>,
    better: f64,
}

/// Covariance of the free coordinates of a hypothesis by effects that it does not name; of `effects` those are considered.
/// `None` where nothing can be said.
pub(in crate::gap) fn by_the_unnamed(
    evidence: &Evidence,
    around: &Trial,
    effects: &[EffectId],
) -> Option<DMatrix<f64>> {
    // A law has taken what has no name out of the numbers.
    if around.model.law().is_some() {
        return None;
    }
    let coarse = evidence.coarse();
    let found = around.begun_in(evidence, &coarse);
    let problem = Problem::new(&around.model, &coarse.fit);
    let x = problem.coordinates_from(&found);
    let blocks = problem.linearise(&x).ok()?;
    let projector = Projector::of(&blocks, around.model.free());
    let absent: Vec<DVector<f64>> = blocks.iter().map(|b| DVector::from_column_slice(&b.residual)).collect();
    let left = projector.project(&absent)?;
    let energy: f64 = left.iter().map(|r| r.norm_squared()).sum();
    let effective = Measure::by(evidence, around).effective;
    let moved_by = |(form, start): (EffectForm, Vec<f64>)| {
        let values: Vec<f64> = around.found.values.iter().copied().chain(start).collect();
        let model = around.model.with(form, &evidence.reach).at(&values);
        let with = Problem::new(&model, &coarse.fit);
        let x = with.coordinates_from(&Found { values, ..found.clone() });
        let moved: Option<Vec<DVector<f64>>> =
            (0..coarse.fit.len()).map(|k| Some(weighted(&with, &x, k)? - &absent[k])).collect();
        let moved = moved?;
        let beyond = projector.project(&moved)?;
        let slope: f64 = left.iter().zip(&beyond).map(|(a, b)| a.dot(b)).sum();
        let change: f64 = beyond.iter().map(|r| r.norm_squared()).sum();
        let Suggested { size, spread, deviance } = Suggested::by(slope, change, energy, effective)?;
        let charge = form.searched_count() as f64 * PER_PARAMETER;
        // What the numbers take up as a whole has no size; it is no larger than a search begins with.
        let shift = projector.taken_up(&moved)? * -(size * size + spread.min(1.0)).sqrt();
        let shift = within_belief(&problem, &x, &shift);
        (shift.iter().all(|s| s.is_finite()) && deviance.is_finite())
            .then_some(Other { shift, better: deviance - charge })
    };
    let absent_effects = effects.iter().filter(|e| **e != EffectId::MotorGain && !around.effects().contains(e));
    let some = |form: EffectForm| {
        let starts = form.starts(&evidence.reach);
        let most = if evidence.is_carried() { SOME_STARTS } else { starts.len() };
        let every = starts.len().div_ceil(most.max(1)).max(1);
        (form, starts.into_iter().step_by(every).collect())
    };
    let forms: Vec<(EffectForm, Vec<Vec<f64>>)> = absent_effects.flat_map(|e| e.forms()).map(some).collect();
    let best_of = |(form, starts): (EffectForm, Vec<Vec<f64>>)| {
        let found = starts.into_iter().filter_map(|start| moved_by((form, start)));
        found.max_by(|a, b| a.better.total_cmp(&b.better))
    };
    let mut others: Vec<Other> = forms.into_par_iter().filter_map(best_of).collect();
    others.extend(in_other_forms(evidence, around, &x));
    let most = others.iter().map(|other| other.better).fold(0.0, f64::max);
    others.retain(|other| other.better > most - EQUAL_DEVIANCE);
    // The hypothesis itself, which moves nothing, is one of them where it stands as well.
    let as_well = others.len() + usize::from(most < EQUAL_DEVIANCE);
    let free = around.model.free();
    let mut covariance = DMatrix::zeros(free, free);
    for other in &others {
        covariance.ger(1.0 / as_well as f64, &other.shift, &other.shift, 1.0);
    }
    Some(covariance)
}

/// A shift of the free coordinates as far as their bounds and beliefs allow: to first order friction could become negative, and a
/// number that no log would contradict many times itself.
fn within_belief(problem: &Problem<'_, impl JointModel>, x: &[f64], shift: &DVector<f64>) -> DVector<f64> {
    let bounded = problem.free().into_iter().zip(problem.coordinates());
    let shifts = bounded.zip(x).zip(shift).map(|(((p, bound), x), shift)| {
        let [low, high] = p.believable(*x);
        (x + shift).max(bound.lower.max(low)).min(bound.upper.min(high)) - x
    });
    DVector::from_iterator(shift.len(), shifts)
}

/// The hypothesis with each of its effects in each other form.
fn in_other_forms(evidence: &Evidence, around: &Trial, x: &[f64]) -> Vec<Other> {
    let own = around.model.forms();
    let forms = (0..own.len()).flat_map(|k| own[k].id.forms().map(move |form| (k, form)));
    let forms: Vec<(usize, EffectForm)> = forms.filter(|(k, form)| own[*k] != *form).collect();
    let measure = Measure::by(evidence, around);
    let score = |t: &Trial| measure.deviance(evidence, t) + PER_PARAMETER * t.model.parameters().len() as f64;
    let of = |(k, form): (usize, EffectForm)| {
        let other = around.in_form(evidence, k, form, AGAIN);
        // A parameter of the same name means something else in another form.
        let place = around.model.place(k);
        let free = (0..around.model.parameters().len()).filter(|i| !around.model.parameters()[*i].fixed);
        let shift = free.enumerate().map(|(at, i)| {
            let p = &around.model.parameters()[i];
            let there = other.model.parameters().iter().position(|q| q.name == p.name && !place.contains(&i));
            there.map_or(0.0, |there| p.to_coordinate(other.found.values[there]) - x[at])
        });
        let shift = DVector::from_vec(shift.collect());
        let better = score(around) - score(&other);
        (better.is_finite() && shift.iter().all(|s: &f64| s.is_finite())).then_some(Other { shift, better })
    };
    forms.into_par_iter().filter_map(of).collect()
}

/// Covariance of the free coordinates where each log is one draw, however long it is (Liang and Zeger 1986): what a model lacks
/// is the same all along a log. `None` where there are few logs.
pub(in crate::gap) fn between_logs(evidence: &Evidence, around: &Trial) -> Option<DMatrix<f64>> {
    let logs = evidence.fit.len();
    if logs < FEWEST {
        return None;
    }
    let problem = Problem::new(&around.model, &evidence.fit);
    let blocks = problem.linearise(&problem.coordinates_from(&around.found)).ok()?;
    let residuals: Vec<DVector<f64>> = blocks.iter().map(|b| DVector::from_column_slice(&b.residual)).collect();
    let free = around.model.free();
    let shifts = Projector::of(&blocks, free).taken_up_by_each(&residuals)?;
    let mut covariance = DMatrix::zeros(free, free);
    for shift in &shifts[..logs] {
        covariance.ger(logs as f64 / (logs - 1) as f64, shift, shift, 1.0);
    }
    Some(covariance)
}

#[cfg(test)]
mod tests {
    use super::Suggested;

    #[test]
    fn residuals_suggest_no_size_of_what_changes_nothing() {
        assert!(Suggested::by(0.0, 0.0, 1.0, 50.0).is_none());
        assert!(Suggested::by(f64::NAN, f64::NAN, 1.0, 50.0).is_none());
        let none = Suggested::by(0.3, 2.0, 1.0, 50.0).expect("it changes something");
        assert_eq!((none.size, none.deviance), (0.0, 0.0), "the wrong way");
        let some = Suggested::by(-1.0, 2.0, 1.0, 50.0).expect("it changes something");
        approx::assert_relative_eq!(some.size, 0.5);
        approx::assert_relative_eq!(some.deviance, 50.0 * 2f64.ln(), max_relative = 1e-12);
    }
}
