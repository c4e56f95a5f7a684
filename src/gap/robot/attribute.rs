//! Hypotheses about a robot: as given, with one cause, with two.

use super::bench::Bench;
use super::cause::Cause;
use super::refine::{Hypothesis, Part, refine};
use super::screen::{Candidate, Column, columns, rank};
use rayon::prelude::*;

/// Everything that was tried in full.
pub(super) struct Attribution {
    /// What each cause changes, to first order.
    pub columns: Vec<Column>,
    pub given: Hypothesis,
    /// One cause each, best first.
    pub firsts: Vec<Hypothesis>,
    /// Two causes each, best first; empty where one is not needed.
    pub seconds: Vec<Hypothesis>,
}

/// Candidates that are refitted, and of one cause at most so many.
const TRIED: usize = 8;
const OF_A_CAUSE: usize = 3;
/// Seconds that are refitted; fewer where every trial is a walk.
const TRIED_SECOND: [usize; 2] = [5, 3];
/// What gains less to first order is not worth a refit.
const LEAST_GAIN: f64 = 6.0;
/// From this gain on a first cause is worth a search for a second.
pub(super) const CLEAR_GAIN: f64 = 40.0;

/// Tries all causes that are considered.
pub(super) fn attribute(
    bench: &Bench<'_>,
    considered: &(dyn Fn(Cause) -> bool + Sync),
    progress: &(dyn Fn(&str) + Sync),
) -> Attribution {
    progress("what each cause would change");
    let given = Hypothesis::given(bench);
    let columns = columns(bench, considered, &given.residual);
    let candidates = rank(bench, &columns, &given.residual);
    progress("fitting the likeliest causes");
    let chosen = chosen(&candidates, TRIED, |_| true);
    let firsts = best(chosen.into_par_iter().filter_map(|candidate| refine(bench, vec![part(candidate)])).collect());
    let Some(first) = firsts.first().filter(|first| given.loss - first.loss > CLEAR_GAIN) else {
        return Attribution { columns, given, firsts, seconds: Vec::new() };
    };
    progress("looking for a second cause");
    let rest = rank(bench, &columns, &first.residual);
    let named = &first.parts[0];
    let is_other = |candidate: &Candidate| {
        let shares = candidate.place.joints.iter().any(|joint| named.place.joints.contains(joint));
        candidate.cause != named.cause || (!shares && !candidate.cause.is_of_robot())
    };
    let pairs = self::chosen(&rest, TRIED_SECOND[usize::from(!bench.case.is_clamped())], is_other);
    let pair = |candidate: &Candidate| refine(bench, vec![named.clone(), part(candidate)]);
    let seconds = best(pairs.into_par_iter().filter_map(pair).collect());
    // A search that began elsewhere may have missed what one of the two explains alone.
    let of_best = seconds.first().map_or(Vec::new(), |pair| pair.parts.clone());
    let alone: Vec<Hypothesis> = of_best.into_par_iter().filter_map(|part| refine(bench, vec![part])).collect();
    let is_new = |hypothesis: &Hypothesis| {
        let same = |other: &&Hypothesis| other.parts[0].place == hypothesis.parts[0].place;
        let of_cause = firsts.iter().filter(|other| other.parts[0].cause == hypothesis.parts[0].cause);
        of_cause.filter(same).all(|other| hypothesis.loss < other.loss - CLEAR_GAIN)
    };
    let better: Vec<Hypothesis> = alone.into_iter().filter(is_new).collect();
    let replaced = |old: &Hypothesis| {
        better.iter().any(|new| (new.parts[0].cause, &new.parts[0].place) == (old.parts[0].cause, &old.parts[0].place))
    };
    let kept: Vec<Hypothesis> = firsts.iter().filter(|old| !replaced(old)).cloned().collect();
    let firsts = best(kept.into_iter().chain(better.iter().cloned()).collect());
    Attribution { columns, given, firsts, seconds }
}

fn part(candidate: &Candidate) -> Part {
    Part { cause: candidate.cause, place: candidate.place.clone(), values: candidate.values.clone() }
}

fn best(mut hypotheses: Vec<Hypothesis>) -> Vec<Hypothesis> {
    hypotheses.sort_by(|a, b| a.loss.total_cmp(&b.loss));
    hypotheses
}

/// The best few, each cause on each place once.
fn chosen(candidates: &[Candidate], count: usize, is_right: impl Fn(&Candidate) -> bool) -> Vec<&Candidate> {
    let mut chosen: Vec<&Candidate> = Vec::new();
    for candidate in candidates.iter().filter(|candidate| candidate.gain > LEAST_GAIN && is_right(candidate)) {
        let is_new = !chosen.iter().any(|other| (other.cause, &other.place) == (candidate.cause, &candidate.place));
        let of_cause = chosen.iter().filter(|other| other.cause == candidate.cause).count();
        if is_new && of_cause < OF_A_CAUSE {
            chosen.push(candidate);
        }
        if chosen.len() == count {
            break;
        }
    }
    chosen
}
