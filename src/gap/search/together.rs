//! Causes that all logs together ask for.
//!
//! A set that lacks a cause predicts logs by chance: held-out ones may then refute causes that are there. Where they have
//! refuted some, and much of them is left, the search begins again with all logs fitted. What it finds is fitted to those
//! logs that are not held out, and taken where the held-out ones are predicted far better with it: to the logs as the study
//! says, or, where the fitted ones do not show it, to all of them.

use super::attribute::Attribution;
use super::refuted::predicts_clearly_worse;
use super::searched::Searched;
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::held_out::FEW_LOGS;
use crate::gap::hypothesis::trial::{AGAIN, Trial};
use crate::identify::Experiment;
use crate::joint::EffectId;
use crate::progress::{Cancelled, Progress, Step};

/// Share by which the squares of held-out logs exceed the noise where much is left of them.
const MUCH: f64 = 2.0;
/// Share of the held-out squares that a set of causes may leave at most to take the place of another.
const FAR_LESS: f64 = 0.5;

/// The attribution that begins with the causes for which all logs together ask, where those predict held-out logs far better,
/// and the logs that it is fitted to. Few logs together ask for what each of them asks for.
pub(in crate::gap) fn all_together(
    evidence: Evidence,
    first: Attribution,
    effects: &[EffectId],
    progress: &dyn Progress,
) -> Result<(Evidence, Attribution), Cancelled> {
    let logs = evidence.fit.len() + evidence.held.len();
    let may_ask = !effects.is_empty() && logs > FEW_LOGS && first.held_out_refuted();
    let asks = may_ask && first.excess_held_out(&evidence) > MUCH;
    let late =
        || evidence.deadline.leaves_out("a search on all logs together, for the held-out ones refute what is found");
    if !asks || late() {
        return Ok((evidence, first));
    }
    progress.go_on(Step::stage("all logs together: held-out ones refute what is found"))?;
    let pooled = evidence.pooled();
    let searched = Searched::of(&pooled, effects, None, progress)?;
    let set = fitted_apart(&evidence, &pooled, &searched);
    let told = first.told();
    let is_far_better = |this: &Trial| {
        this.held_loss(&evidence) < FAR_LESS * told.held_loss(&evidence)
            && predicts_clearly_worse(&evidence, told, this)
    };
    if set.effects().is_empty() || !acts_in(&evidence.fit, &set) || !is_far_better(&set) || late() {
        return Ok((evidence, first));
    }
    let second = Attribution::begun_with(&evidence, effects, &set, progress)?;
    if is_far_better(&second.best) {
        return Ok((evidence, second));
    }
    if late() {
        return Ok((evidence, first));
    }
    let together = Attribution::of_searched(&pooled, effects, searched, progress)?;
    Ok((pooled, together))
}

/// The causes that a search on all logs found, fitted to those that are not held out.
fn fitted_apart(evidence: &Evidence, pooled: &Evidence, searched: &Searched) -> Trial {
    let on_pooled = searched.judged.best.carried(&searched.coarse, pooled, AGAIN);
    let mut set = on_pooled.holding_out_from(evidence.fit.len()).on(evidence, AGAIN);
    set.predict(evidence, None);
    set
}

/// Whether each cause that holds in some logs only holds in any of these.
fn acts_in(logs: &[Experiment], set: &Trial) -> bool {
    set.model.only().iter().flatten().all(|only| logs.iter().any(|e| only.holds(e)))
}
