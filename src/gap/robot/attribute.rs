//! Hypotheses about a robot: as given, with one cause, with two.

use super::bench::Bench;
use super::cause::Cause;
use super::decide::is_explained;
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
/// Free play is refitted if to first order it promises this share of what the best has gained.
const PLAY_PROMISES: f64 = 0.3;
/// More that are refitted on the joints of the best; fewer where every trial is a walk.
const TRIED_THERE: [usize; 2] = [5, 2];
/// Seconds that are refitted; fewer where every trial is a walk.
const TRIED_SECOND: [usize; 2] = [5, 3];
const TRIED_BESIDE_PLAY: usize = 1;
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
    let mut columns = columns(bench, &|cause| !cause.is_play() && considered(cause), &given.residual);
    let candidates = rank(bench, &columns, &given.residual);
    progress("fitting the likeliest causes");
    let refitted = |chosen: Vec<&Candidate>| -> Vec<Hypothesis> {
        chosen.into_par_iter().filter_map(|candidate| refine(bench, vec![part(candidate)])).collect()
    };
    let chosen = chosen(&candidates, TRIED, |_| true);
    let mut firsts = best(refitted(chosen.clone()));
    if let Some(place) = firsts.first().map(|first| first.parts[0].place.clone()) {
        // What the best place may have besides: to first order a strong friction looks weak.
        let is_tried = |candidate: &Candidate| {
            chosen.iter().any(|other| (other.cause, &other.place) == (candidate.cause, &candidate.place))
        };
        let is_cousin = |candidate: &Candidate| candidate.place == place && !is_tried(candidate);
        let count = TRIED_THERE[usize::from(!bench.case.is_clamped())];
        firsts = best(firsts.into_iter().chain(refitted(self::chosen(&candidates, count, is_cousin))).collect());
    }
    let least = firsts.first().map_or(given.loss, |first| first.loss.min(given.loss));
    if !is_explained(bench, least) {
        // Free play is slow to simulate: only where nothing else will do, and if it promises as much.
        progress("trying free play");
        let play = self::columns(bench, &|cause| cause.is_play() && considered(cause), &given.residual);
        let promises = |candidate: &&Candidate| candidate.gain > PLAY_PROMISES * (given.loss - least);
        let likeliest: Vec<Candidate> =
            rank(bench, &play, &given.residual).iter().take(1).filter(promises).cloned().collect();
        firsts = best(firsts.into_iter().chain(refitted(likeliest.iter().collect())).collect());
        columns.extend(play);
    }
    let Some(first) = firsts.first().filter(|first| given.loss - first.loss > CLEAR_GAIN) else {
        return Attribution { columns, given, firsts, seconds: Vec::new() };
    };
    progress("looking for a second cause");
    let rest = rank(bench, &columns, &first.residual);
    let named = &first.parts[0];
    let is_other = |candidate: &Candidate| {
        if candidate.cause.is_play() {
            return false;
        }
        let shares = candidate.place.joints.iter().any(|joint| named.place.joints.contains(joint));
        candidate.cause != named.cause || (!shares && !candidate.cause.is_of_robot())
    };
    let count = match named.cause.is_play() {
        true => TRIED_BESIDE_PLAY,
        false => TRIED_SECOND[usize::from(!bench.case.is_clamped())],
    };
    let pairs = self::chosen(&rest, count, is_other);
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
