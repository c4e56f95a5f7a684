//! The numbers of a study, refitted within their beliefs.

use super::evidence::Evidence;
use super::model::GapModel;
use super::trial::{AGAIN, Trial};
use crate::identify::{JointModel, Problem, candidates, ranked};
use rayon::prelude::*;

/// The numbers refitted within their beliefs, from several starts: as given, from smoothed accelerations and short parts
/// of the logs, and with friction and inertia changed by factors.
pub(in crate::gap) fn calibrate(evidence: &Evidence, baseline: &GapModel, given: &Trial) -> Trial {
    let baseline = &baseline.clone().in_unit(given.unit_rad2_s(evidence));
    let problem = Problem::new(baseline, &evidence.fit);
    let starts = candidates(baseline, &evidence.fit).into_iter().map(|values| problem.coordinates_of(&values));
    let starts: Vec<Vec<f64>> = ranked(&problem, starts).into_iter().take(4).collect();
    let from_given = given.found.values.clone();
    let from_start = baseline.parameters().iter().map(|p| p.start).collect();
    let demanded = Some(from_start).filter(|start| *start != from_given);
    let brief: Vec<Trial> = starts
        .par_iter()
        .map(|x| problem.values(x))
        .chain([from_given])
        .chain(demanded)
        .map(|values| Trial::solved(evidence, baseline.clone(), &values, given.found.starts.clone(), AGAIN))
        .collect();
    let best = brief.into_iter().min_by(|a, b| a.criterion().total_cmp(&b.criterion()));
    let best = best.unwrap_or_else(|| given.clone());
    // Beliefs weigh as much as the residuals that are left say; twice is enough to come to rest.
    best.settled(evidence, AGAIN).settled(evidence, AGAIN)
}
