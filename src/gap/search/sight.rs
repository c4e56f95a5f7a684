//! What each effect would change, seen from a fitted hypothesis, without refitting anything.
//!
//! The residual of every starting point of an effect is projected off all columns that the hypothesis can move (its
//! parameters, every log's start): what is left is, to first order, what a full refit would leave.

use super::hold_scan::hold_scan;
use super::projector::Projector;
use crate::fit::Residuals;
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::model::GapModel;
use crate::gap::hypothesis::trial::Trial;
use crate::identify::{Experiment, Found, Problem};
use crate::joint::EffectId;
use nalgebra::DVector;
use rayon::prelude::*;

/// One hypothesis' view of the effects that may be added to it.
pub(in crate::gap) struct Sight {
    /// Values of the hypothesis.
    from: Vec<f64>,
    /// What it leaves and cannot take up, in few rows.
    pub absent: Vec<f64>,
    /// Every effect at its starting points.
    pub points: Vec<Point>,
}

/// A place from which an effect may be refitted.
pub(in crate::gap) struct Point {
    pub effect: EffectId,
    /// Values of the effect as they are searched.
    pub start: Vec<f64>,
    /// Square sum that a refit would leave, to first order.
    pub promise: f64,
    /// What switching it on changes beyond what the hypothesis can take up, in few rows.
    pub moved: Vec<f64>,
}

/// What is left is folded to at most about so many rows.
const ROWS: usize = 2000;
/// Starting points of each effect that are looked at from a hypothesis with effects; where these part motor side and link
/// each costs many times as much.
const SOME_STARTS: usize = 6;
const FEW_STARTS: usize = 2;
/// Blocks of fewer rows are not folded.
const FEW_ROWS: usize = 32;
/// To first order an effect may be up to so many times the size of its starting point.
pub(in crate::gap) const LARGEST: f64 = 4.0;

impl Sight {
    /// The view from `base`, and from further values of its parameters: what is missing may have bent the fitted ones
    /// far from the truth, and what the engineer believes is then nearer to it.
    pub fn from_each(evidence: &Evidence, base: &Trial, also: &[Vec<f64>], effects: &[EffectId]) -> Vec<Self> {
        let problem = Problem::new(&base.model, &evidence.fit);
        let Ok(blocks) = problem.linearise(&problem.coordinates_from(&base.found)) else { return Vec::new() };
        let projector = Projector::of(&blocks, base.model.free());
        let from = |values: &Vec<f64>| Self::of(evidence, base, values, effects, &projector);
        [&base.found.values].into_iter().chain(also).filter_map(from).collect()
    }

    fn of(
        evidence: &Evidence,
        base: &Trial,
        from: &[f64],
        effects: &[EffectId],
        projector: &Projector,
    ) -> Option<Self> {
        let logs = evidence.fit.len();
        let bare = Problem::new(&base.model, &evidence.fit);
        let at = bare.coordinates_from(&Found { values: from.to_vec(), ..base.found.clone() });
        let mut absent: Vec<DVector<f64>> = (0..logs).map(|k| weighted(&bare, &at, k)).collect::<Option<_>>()?;
        absent.extend(bare.beliefs(&at).map(|beliefs| DVector::from_vec(beliefs.residual)));
        let left = projector.project(&absent)?;
        let left_absent: f64 = left.iter().map(|r| r.norm_squared()).sum();
        let points = effects
            .par_iter()
            .flat_map_iter(|&effect| {
                let model = base.model.with(effect, &evidence.reach);
                let most = starts_at_most(&base.model);
                let starts = model.allowed_starts(match effect {
                    // The best come first.
                    EffectId::SetpointHold => {
                        let scanned = hold_scan(evidence, &base.model, from, &absent, projector);
                        scanned.into_iter().take(most).collect()
                    }
                    _ => {
                        let starts = effect.starts(&evidence.reach);
                        let every = starts.len().div_ceil(most).max(1);
                        starts.into_iter().step_by(every).collect()
                    }
                });
                let point = |start: Vec<f64>| {
                    if evidence.deadline.leaves_out("a look at some sizes of causes") {
                        return None;
                    }
                    let values: Vec<f64> = from.iter().chain(&start).copied().collect();
                    let model = model.clone().at(&values);
                    let problem = Problem::new(&model, &evidence.fit);
                    let x = problem.coordinates_from(&Found { values, ..base.found.clone() });
                    let moved: Vec<DVector<f64>> = (0..logs)
                        .map(|k| {
                            // What only a drive shows leaves a free swing as it is.
                            if effect.is_driven_only() && !evidence.fit[k].is_driven() {
                                return Some(DVector::zeros(absent[k].len()));
                            }
                            Some(weighted(&problem, &x, k)? - &absent[k])
                        })
                        .collect::<Option<_>>()?;
                    let moved = projector.project(&moved)?;
                    let both = |a: &[DVector<f64>], b: &[DVector<f64>]| -> f64 {
                        a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
                    };
                    // Along the line from no effect to this one: the least of the parabola.
                    let (slope, change) = (both(&left, &moved), both(&moved, &moved));
                    let size = (-slope / change).clamp(0.0, LARGEST);
                    let least = left_absent + 2.0 * size * slope + size * size * change;
                    let whole = left_absent + 2.0 * slope + change;
                    // A hold of another time is no hold of another size.
                    let scales = effect != EffectId::SetpointHold && least.is_finite();
                    let promise = if scales { whole.min(least) } else { whole };
                    Some(Point { effect, start, promise, moved: folded(&moved) })
                };
                starts.into_iter().filter_map(point).collect::<Vec<_>>()
            })
            .collect();
        Some(Self { from: from.to_vec(), absent: folded(&left), points })
    }

    /// The points of each effect that promise most.
    pub fn best_of_each(&self, most: usize) -> impl Iterator<Item = &Point> {
        let mut order: Vec<&Point> = self.points.iter().collect();
        order.sort_by(|a, b| a.promise.total_cmp(&b.promise));
        let mut taken: Vec<EffectId> = Vec::new();
        order.into_iter().filter(move |point| {
            taken.push(point.effect);
            taken.iter().filter(|e| **e == point.effect).count() <= most
        })
    }

    /// Residuals of a hypothesis in the same few rows.
    pub fn folded_residual(&self, evidence: &Evidence, trial: &Trial) -> Vec<f64> {
        let weigh = |e: &Experiment, r: &Vec<f64>| {
            DVector::from_iterator(r.len(), e.weights_s.iter().zip(r).map(|(w, r)| w.sqrt() * r))
        };
        folded(&evidence.fit.iter().zip(&trial.fit).map(|(e, r)| weigh(e, r)).collect::<Vec<_>>())
    }

    /// Values of the hypothesis with effects added at their points.
    pub fn with(&self, points: &[&Point]) -> Vec<f64> {
        self.from.iter().chain(points.iter().flat_map(|p| &p.start)).copied().collect()
    }
}

/// Starting points of an effect that are looked at, spread over all.
fn starts_at_most(base: &GapModel) -> usize {
    match (base.effects(), base.has_two_bodies()) {
        ([], _) => usize::MAX,
        (_, false) => SOME_STARTS,
        (_, true) => FEW_STARTS,
    }
}

/// Residuals of one log, each times the root of its weight; `None` where the motion runs away.
pub(in crate::gap) fn weighted(problem: &Problem<'_, GapModel>, x: &[f64], k: usize) -> Option<DVector<f64>> {
    let e = &problem.experiments[k];
    let mut r = DVector::zeros(e.compared());
    let motion = problem.motion(x, k, |i, s| {
        if i >= e.uncompared {
            let row = i - e.uncompared;
            r[row] = e.weights_s[row].sqrt() * (s.angle_rad - e.measured_rad[i]);
        }
    });
    motion.ok().map(|()| r)
}

/// Rows of all logs, neighbours added up so that few remain; what is smooth keeps its square sum.
fn folded(logs: &[DVector<f64>]) -> Vec<f64> {
    // Beliefs, which may stand behind the logs or not, have no say in how many samples make a row.
    let rows: usize = logs.iter().map(DVector::len).filter(|rows| *rows >= FEW_ROWS).sum();
    let width = rows.div_ceil(ROWS).max(1);
    let sum = |part: &[f64]| part.iter().sum::<f64>() / (part.len() as f64).sqrt();
    // Few rows are beliefs, each of something else.
    let width_of = |r: &DVector<f64>| if r.len() < FEW_ROWS { 1 } else { width };
    logs.iter().flat_map(|r| r.as_slice().chunks(width_of(r)).map(sum)).collect()
}

#[cfg(test)]
mod tests {
    use super::{ROWS, folded};
    use nalgebra::DVector;

    #[test]
    fn beliefs_behind_the_logs_do_not_change_how_samples_are_added_up() {
        let log = || DVector::from_element(ROWS, 1.0);
        let beliefs = DVector::from_element(5, 0.5);
        let (alone, with) = (folded(&[log()]), folded(&[log(), beliefs]));
        assert_eq!(alone[..], with[..alone.len()]);
    }
}
