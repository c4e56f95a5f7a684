//! Fits of a hypothesis in which the setpoint is held.
//!
//! Which setpoints get through changes by leaps with the time between them, and a search that moves this time together
//! with everything else stumbles over them. So the time is settled first: everything else is fitted at the time that was
//! proposed, the time is scanned finely about it, and everything else is fitted again; only then is all of it free.

use crate::fit::{Budget, Residuals};
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::model::GapModel;
use crate::gap::hypothesis::trial::Trial;
use crate::identify::{Found, Problem};
use crate::joint::EffectId;
use rayon::prelude::*;

/// Steps either way of the fine scan, and their size as a share of what moves the last hold of the longest log by one.
const FINE: i32 = 20;
const FINE_SHARE: f64 = 0.1;

/// Where the time between two setpoints stands among a model's values; `None` where it holds none, or one that the user
/// gave.
pub(in crate::gap) fn held_setpoint(model: &GapModel) -> Option<usize> {
    let k = model.effects().iter().position(|e| *e == EffectId::SetpointHold)?;
    Some(model.place(k).start).filter(|at| !model.is_held_by_demand(*at))
}

/// A hypothesis that was fitted with the time at place `at` held, the time settled and then free; the budget is that of each
/// of the fits.
pub(in crate::gap) fn settled(evidence: &Evidence, first: Trial, at: usize, budget: Budget) -> Trial {
    let model = first.model.clone();
    let best = scanned(evidence, &model, at, &first.found);
    let second = if best == first.found.values[at] {
        first
    } else {
        let mut values = first.found.values.clone();
        values[at] = best;
        let held = model.clone().holding(&[at], &values);
        let second = Trial::solved(evidence, held, &values, first.found.starts.clone(), budget);
        if second.criterion() < first.criterion() { second } else { first }
    };
    let free = Trial::solved(evidence, model.clone(), &second.found.values, second.found.starts.clone(), budget);
    if free.criterion() <= second.criterion() { free } else { Trial { model, ..second } }
}

/// The time about which everything else fits best as it stands \[s\].
fn scanned(evidence: &Evidence, model: &GapModel, at: usize, found: &Found) -> f64 {
    let problem = Problem::new(model, &evidence.fit);
    let step = FINE_SHARE * found.values[at] / evidence.reach.duration_s;
    let criterion = |hold_s: f64| {
        let mut values = found.values.clone();
        values[at] = hold_s;
        problem.criterion(&problem.coordinates_from(&Found { values, ..found.clone() })).unwrap_or(f64::INFINITY)
    };
    let times = (-FINE..=FINE).into_par_iter().map(|n| found.values[at] * (1.0 + f64::from(n) * step));
    // From the middle outwards, so that the time as it stands wins a tie.
    let mut tried: Vec<(f64, f64)> = times.map(|hold_s| (criterion(hold_s), hold_s)).collect();
    tried.sort_by(|a, b| {
        let aside = |hold_s: f64| (hold_s - found.values[at]).abs();
        a.0.total_cmp(&b.0).then(aside(a.1).total_cmp(&aside(b.1)))
    });
    tried.first().map_or(found.values[at], |best| best.1)
}
